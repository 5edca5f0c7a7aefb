//! The functions that can be asked for, each by its own recursion; where there are several, the one with the fewest operations.

use super::alike::Plan;
use super::emit::{Function, argument_size};
use super::equations::{Bias, Paired, Tree};
use super::graph::{Argument, Graph, Sym, Value, record, record_alike};
use super::model::Model;
use super::pairs::Tables;
use super::prune::{Link, Pruning, prune};

/// A function of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// v̄̇ from Q, v̄ and τ: (24), (34).
    ForwardDynamics,
    /// The efforts τ̄ that v̄̇ takes at Q and v̄.
    InverseDynamics,
    /// M̄(Q).
    MassMatrix,
    /// The efforts τ̄ that no acceleration takes at Q and v̄.
    BiasForces,
    /// v̄ and p̄̇ from Q, p̄ and τ: (27), (35).
    MomentumRates,
    /// p̄ from Q and v̄.
    Momenta,
    /// v̄ from Q and p̄.
    Speeds,
    /// H from Q and p̄.
    Hamiltonian,
    /// Kinetic and potential energy from Q and v̄.
    Energies,
    /// Poses of all bodies from Q.
    Poses,
    /// How v̄̇ changes with ϕ, v̄ and τ, from Q, v̄ and τ.
    ForwardDerivatives,
    /// How the efforts τ̄ change with ϕ and v̄, from Q, v̄ and v̄̇.
    InverseDerivatives,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::ForwardDynamics,
        Self::InverseDynamics,
        Self::MassMatrix,
        Self::BiasForces,
        Self::MomentumRates,
        Self::Momenta,
        Self::Speeds,
        Self::Hamiltonian,
        Self::Energies,
        Self::Poses,
        Self::ForwardDerivatives,
        Self::InverseDerivatives,
    ];

    /// Those of a module for which none are named: all but the derivatives, which are longer than all others together.
    pub const BY_DEFAULT: [Self; 10] = [
        Self::ForwardDynamics,
        Self::InverseDynamics,
        Self::MassMatrix,
        Self::BiasForces,
        Self::MomentumRates,
        Self::Momenta,
        Self::Speeds,
        Self::Hamiltonian,
        Self::Energies,
        Self::Poses,
    ];

    /// Its name, in emitted code as well.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ForwardDynamics => "forward_dynamics",
            Self::InverseDynamics => "inverse_dynamics",
            Self::MassMatrix => "mass_matrix",
            Self::BiasForces => "bias_forces",
            Self::MomentumRates => "momentum_rates",
            Self::Momenta => "momenta",
            Self::Speeds => "speeds_from_momenta",
            Self::Hamiltonian => "hamiltonian",
            Self::Energies => "energies",
            Self::Poses => "poses",
            Self::ForwardDerivatives => "forward_dynamics_derivatives",
            Self::InverseDerivatives => "inverse_dynamics_derivatives",
        }
    }

    /// What it computes, in a sentence.
    pub const fn summary(self) -> &'static str {
        match self {
            Self::ForwardDynamics => "Accelerations v̄̇ from Q, v̄ and τ, (24), (34).",
            Self::InverseDynamics => {
                "Efforts τ̄ = S̄ᵀτ that the accelerations take at Q and v̄, (24), (34)."
            }
            Self::MassMatrix => "Mass matrix M̄ by rows.",
            Self::BiasForces => "Efforts τ̄ = S̄ᵀτ that no acceleration takes at Q and v̄.",
            Self::MomentumRates => "v̄ and p̄̇ from Q, p̄ and τ, (27), (35).",
            Self::Momenta => "Momenta p̄ = M̄ v̄.",
            Self::Speeds => "v̄ = M̄⁻¹ p̄.",
            Self::Hamiltonian => "H = ½ p̄ᵀ M̄⁻¹ p̄ + V, J.",
            Self::Energies => "Kinetic and potential energy, J.",
            Self::Poses => {
                "For each body its rotation to world axes by rows, and its origin in the world, m."
            }
            Self::ForwardDerivatives => {
                "For each speed ∂v̄̇/∂ϕ, ∂v̄̇/∂v̄ and ∂v̄̇/∂τ in local coordinates ϕ about Q, then v̄̇; where constraints couple joints ∂v̄/∂ϕ and ∂v̄/∂v̄ \
                 of the speeds that they complete after these."
            }
            Self::InverseDerivatives => {
                "For each speed ∂τ̄/∂ϕ and ∂τ̄/∂v̄ of inverse dynamics in local coordinates ϕ about Q; ∂τ̄/∂v̄̇ is M̄."
            }
        }
    }

    fn arguments(self) -> &'static [Argument] {
        match self {
            Self::ForwardDynamics | Self::ForwardDerivatives => {
                &[Argument::Configuration, Argument::Speeds, Argument::Efforts]
            }
            Self::InverseDynamics | Self::InverseDerivatives => &[
                Argument::Configuration,
                Argument::Speeds,
                Argument::Accelerations,
            ],
            Self::MassMatrix | Self::Poses => &[Argument::Configuration],
            Self::BiasForces | Self::Momenta | Self::Energies => {
                &[Argument::Configuration, Argument::Speeds]
            }
            Self::MomentumRates => &[
                Argument::Configuration,
                Argument::Momenta,
                Argument::Efforts,
            ],
            Self::Speeds | Self::Hamiltonian => &[Argument::Configuration, Argument::Momenta],
        }
    }

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
            Self::Energies => vec![("body by body", |tree| tree.energies())],
            Self::Poses => vec![("body by body", |tree| tree.poses())],
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
        }
    }

    /// The ways to it that leave pairs of joints to loops, the one with the shortest code first.
    fn pairwise(self, model: &Model) -> Vec<PairedWay> {
        match self {
            Self::MassMatrix => vec![("composite bodies, pair by pair", |tree| tree.paired_mass())],
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
            _ => vec![],
        }
    }

    /// Whether the runtime takes it for many states.
    pub const fn is_batched(self) -> bool {
        matches!(self, Self::ForwardDynamics | Self::InverseDynamics)
    }

    /// The columns of its result; none for a vector.
    fn columns(self, model: &Model) -> Option<usize> {
        let [_, freedoms, speeds] = model.sizes();
        match self {
            Self::MassMatrix | Self::MomentumRates => Some(speeds.max(1)),
            Self::Poses => Some(12),
            Self::ForwardDerivatives => {
                let coupled = !model.coupling.constraints.is_empty();
                let own = 2 * freedoms + speeds + 1;
                Some(own + if coupled { freedoms + speeds } else { 0 })
            }
            Self::InverseDerivatives => Some((freedoms + speeds).max(1)),
            _ => None,
        }
    }

    /// Whether its like parts are looked for: rows that are as long as the way to the root are not alike.
    const fn has_like_parts(self) -> bool {
        !matches!(
            self,
            Self::MassMatrix | Self::ForwardDerivatives | Self::InverseDerivatives
        )
    }
}

/// Name of the recursion that eliminates joint by joint.
const ARTICULATED: &str = "articulated bodies";
/// Name of the recursion that finds M̄.
const COMPOSITE: &str = "composite bodies";
/// Name of what constraints that couple joints take.
const COUPLED: &str = "independent speeds of coupled joints";

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
/// Below, straight code is faster: derivatives of forward dynamics of anymal (17 900 operations) took 0.62 times as long as with loops, those of inverse
/// dynamics of g1 (22 900) 0.56 times; and the Rust compiler took both in seconds.
const PAIRED: usize = 30_000;

/// Operations, those of loops once, that a function may have, so that no module keeps the Rust compiler busy without end: straight-line functions
/// of 31 000 operations already took it more than 100 s.
pub const LONGEST: usize = 100_000;

/// A function that would be too long.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TooLong {
    /// The function.
    pub kind: Kind,
    /// At least so many operations would be written.
    pub operations: usize,
}

impl std::fmt::Display for TooLong {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} would have {} operations, more than {LONGEST}: the tree computes it",
            self.kind.name(),
            self.operations
        )
    }
}

/// Whether like bodies are looped over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Loops {
    /// Never.
    Never,
    /// In functions of more than 10 000 operations, if that halves what is written.
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
/// More than [`LONGEST`] operations that would be written.
pub fn compile(model: &Model, kind: Kind, loops: Loops) -> Result<Chosen, TooLong> {
    let refused = |operations| TooLong { kind, operations };
    let least = least(model, kind);
    let is_looped = loops != Loops::Never && !kind.pairwise(model).is_empty();
    if least > LONGEST && !is_looped {
        return Err(refused(least));
    }
    let chosen = compile_with(model, &prune(model, Pruning::ALL), kind, loops);
    match chosen.function.written() {
        operations if operations > LONGEST => Err(refused(operations)),
        _ => Ok(chosen),
    }
}

/// At least so many operations has a function without loops.
fn least(model: &Model, kind: Kind) -> usize {
    let [_, freedoms, speeds] = model.sizes();
    match kind {
        Kind::MassMatrix => ENTRY * pairs(model),
        Kind::InverseDerivatives => MET * pairs(model),
        Kind::ForwardDerivatives => (MET + RESPONSE * (freedoms + speeds)) * pairs(model),
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
    let mut depths: Vec<usize> = vec![];
    for body in &model.bodies {
        depths.push(body.parent.map_or(0, |parent| depths[parent] + 1));
    }
    let joints = model.joints();
    joints
        .map(|(index, body)| body.joint.derived.shape.speeds * depths[index])
        .sum()
}

/// The same with links that are known, and however long.
pub fn compile_with(model: &Model, links: &[Link], kind: Kind, loops: Loops) -> Chosen {
    let pairwise = kind.pairwise(model);
    if loops == Loops::Never || pairwise.is_empty() {
        return body_by_body(model, links, kind, loops);
    }
    let mut tried = vec![];
    if loops == Loops::Long && least(model, kind) <= LONGEST {
        let straight = body_by_body(model, links, kind, Loops::Never);
        if straight.function.operations().flops() < PAIRED {
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
    let numbers = || {
        let tree = Tree::new(model, links.to_vec());
        let (numbers, tables) = way(&tree);
        let numbers: Vec<Value> = numbers.into_iter().map(Sym::value).collect();
        (numbers, tables)
    };
    let paired = |outputs, graph, plan, tables: Tables| Function {
        pairs: Some(tables),
        ..function(model, kind, outputs, graph, plan)
    };
    let ((outputs, tables), graph) = record(numbers);
    let straight = paired(outputs, graph, None, tables);
    let whole = straight.written();
    if loops == Loops::Long && whole < LOOPED {
        return straight;
    }
    let ((outputs, tables), graph) = record_alike(numbers);
    let plan = Plan::new(&graph, &outputs);
    match loops == Loops::Always || 2 * plan.written(&graph) < whole {
        true => paired(outputs, graph, Some(plan), tables),
        false => straight,
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
        pairs: None,
    }
}
