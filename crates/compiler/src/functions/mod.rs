//! The functions that can be asked for, each by its own recursion; where there are several, the one with the fewest operations.

mod kind;
mod not_written;

pub use kind::Kind;
pub use not_written::{NotWritten, TooLong};

use super::alike::Plan;
use super::emit::{Function, argument_size};
use super::equations::{Bias, Paired, Tree};
use super::graph::{Argument, Graph, Sym, Value, record, record_alike};
use super::model::Model;
use super::packs::{self, Packs};
use super::pairs::Tables;
use super::prune::{Link, Pruning, prune};

impl Kind {
    /// The recursions that compute it.
    fn ways(self, model: &Model) -> Vec<Way> {
        match self {
            Self::ForwardDynamics => {
                let mut ways = solving(
                    model,
                    [
                        |tree| tree.articulated_accelerations(Bias::Within),
                        |tree| tree.composite_accelerations(),
                        |tree| tree.coupled_accelerations(),
                    ],
                );
                if model.coupling.constraints.is_empty() {
                    ways.push(("articulated bodies after inverse dynamics", |tree| {
                        tree.articulated_accelerations(Bias::Before)
                    }));
                }
                ways
            }
            Self::InverseDynamics => vec![("Newton–Euler", |tree| {
                tree.needed_efforts(Some(Argument::Accelerations))
            })],
            Self::MassMatrix => vec![(COMPOSITE, |tree| tree.mass_matrix().concat())],
            Self::BiasForces => vec![("Newton–Euler", |tree| tree.needed_efforts(None))],
            Self::MomentumRates => solving(
                model,
                [
                    |tree| tree.port_hamiltonian(Tree::articulated_speeds),
                    |tree| tree.port_hamiltonian(Tree::composite_speeds),
                    |tree| tree.port_hamiltonian(Tree::coupled_speeds),
                ],
            ),
            Self::Momenta => vec![("momenta of what each joint carries", |tree| tree.momenta())],
            Self::Speeds => solving(
                model,
                [
                    |tree| tree.articulated_speeds(),
                    |tree| tree.composite_speeds(),
                    |tree| tree.coupled_speeds(),
                ],
            ),
            Self::Hamiltonian => solving(
                model,
                [
                    |tree| vec![tree.hamiltonian(Tree::articulated_speeds)],
                    |tree| vec![tree.hamiltonian(Tree::composite_speeds)],
                    |tree| vec![tree.hamiltonian(Tree::coupled_speeds)],
                ],
            ),
            Self::Energies => vec![("each body in turn", |tree| tree.energies())],
            Self::Poses => vec![("each body in turn", |tree| tree.poses())],
            Self::ForwardDerivatives => match model.coupling.constraints.is_empty() {
                true => vec![(
                    "of inverse dynamics, by M̄ factorised along the tree",
                    |tree| tree.forward_derivatives(),
                )],
                false => vec![(COUPLED, |tree| tree.coupled_derivatives())],
            },
            Self::InverseDerivatives => vec![("composite bodies in motion", |tree| {
                tree.inverse_derivatives()
            })],
            Self::InverseMassMatrix => {
                vec![("composite bodies, factorised along the tree", |tree| {
                    tree.inverse_mass_matrix()
                })]
            }
            Self::ForwardSecondDerivatives => vec![(
                "of inverse dynamics under M̄⁻¹λ, M̄ factorised along the tree",
                |tree| tree.forward_second_derivatives(),
            )],
            Self::InverseSecondDerivatives => {
                vec![("composite bodies under virtual speeds", |tree| {
                    tree.inverse_second_derivatives()
                })]
            }
        }
    }

    /// The ways to it that leave pairs of joints to loops, the one with the shortest code first.
    fn pairwise(self, model: &Model) -> Vec<PairedWay> {
        match self {
            Self::MassMatrix => vec![("composite bodies, pair by pair", |tree| tree.paired_mass())],
            Self::InverseMassMatrix => {
                vec![("composite bodies, pair by pair", |tree| {
                    tree.paired_inverse_mass()
                })]
            }
            Self::InverseDerivatives => {
                vec![("composite bodies in motion, pair by pair", |tree| {
                    tree.paired_inverse()
                })]
            }
            Self::ForwardDerivatives if model.coupling.constraints.is_empty() => vec![
                ("of inverse dynamics, pair by pair", |tree| {
                    tree.paired_forward()
                }),
                ("of inverse dynamics, solved in loops", |tree| {
                    tree.solved_forward()
                }),
            ],
            Self::InverseSecondDerivatives => {
                vec![(
                    "composite bodies under virtual speeds, pair by pair",
                    |tree| tree.paired_second_inverse(),
                )]
            }
            Self::ForwardSecondDerivatives if can_loop_second(model) => {
                vec![(
                    "of inverse dynamics under M̄⁻¹λ, pair by pair",
                    |tree| tree.paired_second_forward(),
                )]
            }
            _ => vec![],
        }
    }

    /// Operations from which on pairs of joints are left to loops.
    const fn paired(self) -> usize {
        match self {
            Self::InverseMassMatrix => PAIRED_SOON,
            _ => PAIRED,
        }
    }

    /// Whether its like parts are looked for: rows that are as long as the way to the root are not alike.
    const fn has_like_parts(self) -> bool {
        !matches!(
            self,
            Self::MassMatrix
                | Self::InverseMassMatrix
                | Self::ForwardDerivatives
                | Self::InverseDerivatives
                | Self::ForwardSecondDerivatives
                | Self::InverseSecondDerivatives
        )
    }
}

/// Whether second derivatives of forward dynamics may be left to loops: those with prescribed motions or constraints are not.
fn can_loop_second(model: &Model) -> bool {
    model.coupling.constraints.is_empty() && model.bodies.iter().all(|body| !body.driven)
}

/// Name of the recursion that eliminates joint by joint.
const ARTICULATED: &str = "articulated bodies";
/// Name of the recursion that finds M̄.
const COMPOSITE: &str = "composite bodies";
/// Name of what constraints that couple joints take.
const COUPLED: &str = "independent speeds of coupled joints";

/// The recursions that compute v̄̇ from Q, v̄ and τ.
pub(crate) fn ways_to_accelerations(model: &Model) -> Vec<fn(&Tree<'_>) -> Vec<Sym>> {
    let ways = Kind::ForwardDynamics.ways(model).into_iter();
    ways.map(|(_, way)| way).collect()
}

/// The ways to solve with M̄: joint by joint; of M̄ factorised, where it may be the shorter; and where constraints couple joints.
fn solving(model: &Model, [articulated, factorised, coupled]: [Run; 3]) -> Vec<Way> {
    if !model.coupling.constraints.is_empty() {
        return vec![(COUPLED, coupled)];
    }
    let mut ways = vec![(ARTICULATED, articulated)];
    if worth_factorising(model) {
        ways.push(("composite bodies, factorised along the tree", factorised));
    }
    ways
}

/// Operations of articulated bodies for one speed: about the most that was counted.
const MOST: usize = 400;

/// Whether factorising M̄ along the tree can take fewer operations than articulated bodies: a speed with n before it on its way to the
/// root takes n².
fn worth_factorising(model: &Model) -> bool {
    let mut before: Vec<usize> = vec![];
    let mut operations = 0;
    for (index, body) in model.joints() {
        let speeds = body.joint.derived.shape.speeds;
        let depth = body.parent.map_or(0, |parent| before[parent]);
        before.extend(model.carried(index).map(|_| depth + speeds));
        operations += (depth..depth + speeds).map(|n| n * n).sum::<usize>();
    }
    operations < MOST * model.sizes()[2]
}

/// Operations of a function from which on like bodies are looped over, if that halves what is written.
///
/// Below, one body after the other is faster: looped forward dynamics of 3200 operations (anymal) took 1.33 times as long, of 7000 (eight ball joints)
/// 1.28 times and of 8700 (g1) 1.20 times.
const LOOPED: usize = 10_000;

/// Operations of a function from which on pairs of joints are left to loops.
///
/// Below, straight code is faster: derivatives of forward dynamics of anymal (17 900 operations) took 0.74 times as long as with loops, those of inverse
/// dynamics of g1 (22 900) 0.70 times; and the Rust compiler took both in seconds.
const PAIRED: usize = 30_000;

/// The same of M̄⁻¹, most of which is solving.
const PAIRED_SOON: usize = 10_000;

/// Operations that a function in lanes may have: the Rust compiler takes them once for each level of instructions.
const LONGEST_IN_LANES: usize = 50_000;

/// Numbers that a function in lanes may have in memory, of eight states: 0.75 MB of the stack, besides what its loops keep for each other. Threads have 2 MB by default.
const WIDEST_IN_LANES: usize = 12_000;

/// Operations, those of loops once, that a function may have, so that no module keeps the Rust compiler busy without end: straight-line functions
/// of 31 000 operations already took it more than 100 s.
pub const LONGEST: usize = 100_000;

/// Whether like bodies are looped over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Loops {
    /// Never.
    Never,
    /// In functions of more than 10 000 operations, if that halves what is written; like limbs are side by side in what has no such loops.
    #[default]
    Long,
    /// Wherever there are any.
    Always,
}

/// A recursion with its name.
type Way = (&'static str, Run);
/// What computes the results.
type Run = fn(&Tree<'_>) -> Vec<Sym>;
/// The same of numbers of the bodies, from which loops over pairs of joints make the results.
type PairedWay = (&'static str, fn(&Tree<'_>) -> Paired);

/// A function as it was chosen.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// The function.
    pub function: Function,
    /// The recursion.
    pub way: &'static str,
    /// Operations of all recursions that were tried.
    pub tried: Vec<(&'static str, usize)>,
}

/// A function of the model: with the fewest operations where it is short, else with the shortest code.
///
/// # Errors
/// More than [`LONGEST`] operations that would be written; second derivatives of forward dynamics where constraints couple joints.
pub fn compile(model: &Model, kind: Kind, loops: Loops) -> Result<Chosen, NotWritten> {
    let constraint = model.coupling.constraints.first();
    if let (Kind::ForwardSecondDerivatives, Some(constraint)) = (kind, constraint) {
        let constraint = constraint.name.clone();
        return Err(NotWritten::Coupled { kind, constraint });
    }
    let refused = |operations| {
        NotWritten::TooLong(TooLong {
            kind,
            in_lanes: false,
            operations,
            numbers: None,
        })
    };
    let least = least(model, kind);
    let is_looped = loops != Loops::Never && !kind.pairwise(model).is_empty();
    if least > LONGEST && !is_looped {
        return Err(refused(least));
    }
    let links = prune(model, Pruning::ALL);
    let chosen = compile_with(model, &links, kind, loops);
    match chosen.function.written() {
        operations if operations > LONGEST => Err(refused(operations)),
        _ => Ok(chosen),
    }
}

/// The packs of a function as it was chosen, where they save operations.
fn packs(model: &Model, links: &[Link], kind: Kind, chosen: &Chosen) -> Option<Packs> {
    if chosen.function.plan.is_some() || !packs::may_have(model) {
        return None;
    }
    let (outputs, graph) = match &chosen.function.pairs {
        None => {
            let mut ways = kind.ways(model).into_iter();
            let (_, way) = ways.find(|(name, _)| *name == chosen.way)?;
            record_alike(|| run(model, links, way))
        }
        Some(_) => {
            let mut ways = kind.pairwise(model).into_iter();
            let (_, way) = ways.find(|(name, _)| *name == chosen.way)?;
            let ((outputs, _), graph) = record_alike(|| numbers(model, links, way));
            (outputs, graph)
        }
    };
    Packs::new(model, graph, outputs)
}

/// The function for many states side by side, which has no loops over like bodies. Long ones leave `pairs` of joints to loops of the runtime where these may be, as
/// in Rust.
///
/// # Errors
/// More operations than the Rust compiler takes in lanes within a minute, more numbers than the stack should hold.
pub fn compile_in_lanes(model: &Model, kind: Kind, pairs: bool) -> Result<Function, TooLong> {
    let links = prune(model, Pruning::ALL);
    let refused = |operations, numbers| TooLong {
        kind,
        in_lanes: true,
        operations,
        numbers,
    };
    let mut operations = least(model, kind);
    let mut found = None;
    if operations <= LONGEST_IN_LANES {
        let straight = compile_with(model, &links, kind, Loops::Never).function;
        operations = straight.written();
        found = (operations <= LONGEST_IN_LANES).then_some(straight);
    }
    if let (None, true, Some(&way)) = (&found, pairs, kind.pairwise(model).first()) {
        let paired = pair_by_pair(model, &links, (kind, way), Loops::Never);
        if paired.pairs.as_ref().is_some_and(Tables::serves_lanes) {
            operations = paired.written();
            found = (operations <= LONGEST_IN_LANES).then_some(paired);
        }
    }
    let function = found.ok_or_else(|| refused(operations, None))?;
    match numbers_in_lanes(&function) {
        numbers if numbers > WIDEST_IN_LANES => Err(refused(operations, Some(numbers))),
        _ => Ok(function),
    }
}

/// Numbers that a function in lanes has in memory for each state: arguments and results, and for loops over pairs those of the bodies and the factors of M̄.
fn numbers_in_lanes(function: &Function) -> usize {
    let arguments: usize = function.arguments.iter().map(|(_, size)| size).sum();
    let of_pairs = function
        .pairs
        .as_ref()
        .map_or(0, |tables| function.outputs.len() + tables.room_of_lanes());
    arguments + function.results() + of_pairs
}

/// At least so many operations has a function without loops.
fn least(model: &Model, kind: Kind) -> usize {
    let [_, freedoms, speeds] = model.sizes();
    match kind {
        Kind::MassMatrix => ENTRY * pairs(model),
        Kind::InverseMassMatrix => (ENTRY + RESPONSE * speeds / 2) * pairs(model),
        Kind::InverseDerivatives | Kind::InverseSecondDerivatives => MET * pairs(model),
        Kind::ForwardDerivatives | Kind::ForwardSecondDerivatives => {
            (MET + RESPONSE * (freedoms + speeds)) * pairs(model)
        }
        _ => 0,
    }
}

/// Operations of an entry of M̄ beside the diagonal: about the fewest that were counted.
const ENTRY: usize = 15;

/// Operations of the derivatives of inverse dynamics for a speed and a joint that carries it: fewer than were counted.
const MET: usize = 30;

/// Operations of one column of M̄⁻¹ times something for such a pair: the fewest.
const RESPONSE: usize = 2;

/// Pairs of a speed and a joint that carries it.
fn pairs(model: &Model) -> usize {
    let depths = model.depths();
    let joints = model.joints();
    joints
        .map(|(index, body)| body.joint.derived.shape.speeds * depths[index])
        .sum()
}

/// The same with links that are known, and however long.
pub fn compile_with(model: &Model, links: &[Link], kind: Kind, loops: Loops) -> Chosen {
    let mut chosen = choose(model, links, kind, loops);
    if loops == Loops::Long {
        chosen.function.packs = packs(model, links, kind, &chosen);
    }
    chosen
}

/// The same without packs.
fn choose(model: &Model, links: &[Link], kind: Kind, loops: Loops) -> Chosen {
    let pairwise = kind.pairwise(model);
    if loops == Loops::Never || pairwise.is_empty() {
        return body_by_body(model, links, kind, loops);
    }
    let mut tried = vec![];
    if loops != Loops::Always && least(model, kind) <= LONGEST {
        let straight = body_by_body(model, links, kind, Loops::Never);
        if straight.function.operations().flops() < kind.paired() {
            return straight;
        }
        tried.extend(straight.tried);
    }
    let mut ways: Vec<(&'static str, Function)> = vec![];
    for &way in &pairwise {
        // What is solved in loops alone has all pairs written: for as long as that is short.
        if ways.is_empty() || !tried.is_empty() {
            ways.push((way.0, pair_by_pair(model, links, (kind, way), loops)));
        }
    }
    let flops = |function: &Function| function.operations().flops();
    tried.extend(ways.iter().map(|(name, function)| (*name, flops(function))));
    let is_short = |(_, function): &(&str, Function)| function.written() < LOOPED;
    let place = match loops {
        Loops::Always => 0,
        _ => ways.iter().rposition(is_short).unwrap_or(0),
    };
    let (way, function) = ways.swap_remove(place);
    Chosen {
        function,
        way,
        tried,
    }
}

/// A function that leaves pairs of joints to loops.
fn pair_by_pair(
    model: &Model,
    links: &[Link],
    (kind, (_, way)): (Kind, PairedWay),
    loops: Loops,
) -> Function {
    let straight = paired(model, kind, record(|| numbers(model, links, way)));
    let whole = straight.written();
    if loops == Loops::Never || loops == Loops::Long && whole < LOOPED {
        return straight;
    }
    let mut alike = paired(model, kind, record_alike(|| numbers(model, links, way)));
    let plan = Plan::new(&alike.graph, &alike.outputs);
    match loops == Loops::Always || 2 * plan.written(&alike.graph) < whole {
        true => {
            alike.plan = Some(plan);
            alike
        }
        false => straight,
    }
}

/// What a way that leaves pairs of joints to loops finds for the bodies, with its tables.
fn numbers(model: &Model, links: &[Link], way: fn(&Tree<'_>) -> Paired) -> (Vec<Value>, Tables) {
    let (numbers, tables) = way(&Tree::new(model, links.to_vec()));
    (numbers.into_iter().map(Sym::value).collect(), tables)
}

/// The function of such numbers.
fn paired(
    model: &Model,
    kind: Kind,
    ((outputs, tables), graph): ((Vec<Value>, Tables), Graph),
) -> Function {
    Function {
        pairs: Some(tables),
        ..function(model, kind, outputs, graph, None)
    }
}

/// A function without loops over pairs of joints.
fn body_by_body(model: &Model, links: &[Link], kind: Kind, loops: Loops) -> Chosen {
    let ways = kind.ways(model).into_iter();
    let straight = ways.map(|(name, way)| {
        let (outputs, graph) = record(|| run(model, links, way));
        (name, way, function(model, kind, outputs, graph, None))
    });
    let mut straight: Vec<(&'static str, Run, Function)> = straight.collect();
    let flops = |function: &Function| function.operations().flops();
    let tried = straight
        .iter()
        .map(|(name, _, function)| (*name, flops(function)))
        .collect();
    straight.sort_by_cached_key(|(.., function)| flops(function));
    let (name, way, function) = straight.swap_remove(0);
    let looped = looped(model, links, &function, (kind, way), loops);
    Chosen {
        function: looped.unwrap_or(function),
        way: name,
        tried,
    }
}

fn run(model: &Model, links: &[Link], way: Run) -> Vec<Value> {
    let tree = Tree::new(model, links.to_vec());
    way(&tree).into_iter().map(Sym::value).collect()
}

/// The function with loops over like bodies, where these are wanted.
fn looped(
    model: &Model,
    links: &[Link],
    straight: &Function,
    (kind, way): (Kind, Run),
    loops: Loops,
) -> Option<Function> {
    let whole = straight.operations().flops();
    let never = !kind.has_like_parts() || loops == Loops::Never;
    if never || loops == Loops::Long && whole < LOOPED {
        return None;
    }
    let (outputs, graph) = record_alike(|| run(model, links, way));
    let plan = Plan::new(&graph, &outputs);
    let pays = loops == Loops::Always || 2 * plan.written(&graph) < whole;
    pays.then(|| function(model, kind, outputs, graph, Some(plan)))
}

fn function(
    model: &Model,
    kind: Kind,
    outputs: Vec<Value>,
    graph: Graph,
    plan: Option<Plan>,
) -> Function {
    let [configuration, freedoms, speeds] = model.sizes();
    let size = |argument| argument_size(argument, [configuration, freedoms, speeds]);
    let arguments = kind.arguments().iter();
    Function {
        name: kind.name(),
        summary: kind.summary().to_owned(),
        arguments: arguments
            .map(|&argument| (argument, size(argument)))
            .collect(),
        columns: kind.columns(model),
        graph,
        outputs,
        plan,
        packs: None,
        pairs: None,
    }
}
