//! One step of an explicit Runge–Kutta method for all joints of a model, as one graph.
//!
//! What the step is given stands in [`Argument::Given`]: the state, then the length of the step, then numbers of the model that differ from motion to motion. The state is, joint after joint, where it
//! is, and after all joints v̄ and what its sums are too coarse to hold. Where Φ(Q, ϕ) = Q + ϕ a joint keeps Q and what Q is too coarse to hold; elsewhere, as the integrators of the tree, a base point,
//! ϕ about it, and what ϕ is too coarse to hold. The step leaves base points where they are.

use super::equations::Tree;
use super::functions::ways_to_accelerations;
use super::graph::{Argument, Graph, Operations, Sym, Value, bound, record, record_marked};
use super::joint::Joint;
use super::model::{Model, Share};
use super::prune::Link;
use hamel_codegen::derived::{KernelKind, Method};
use num_traits::Zero;
use rustc_hash::FxHashMap;
use std::ops::Range;

/// The coefficients of an explicit method.
#[derive(Clone, Copy, Debug)]
pub struct Scheme<'a> {
    /// a_ij; row i has i entries.
    pub matrix: &'a [&'a [f64]],
    /// b_i.
    pub weights: &'a [f64],
}

/// Where a joint's position stands in the state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Position {
    /// Where the joint's share lies in Q, v and v̄.
    pub share: Share,
    /// Whether Φ adds: then `base` is Q itself, and there is no `offset`.
    pub adds: bool,
    /// The base point, or Q.
    pub base: Range<usize>,
    /// ϕ about the base point; empty where Φ adds.
    pub offset: Range<usize>,
    /// What ϕ, or Q, is too coarse to hold.
    pub rest: Range<usize>,
}

/// Where the numbers of a step stand among those that it is given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Places {
    /// The joints.
    pub joints: Vec<Position>,
    /// v̄ of all joints.
    pub speeds: Range<usize>,
    /// What v̄ is too coarse to hold.
    pub rests: Range<usize>,
    /// The length of the step.
    pub step: usize,
    /// The first number of the model.
    pub numbers: usize,
}

/// A step as a graph.
#[derive(Clone, Debug)]
pub struct Stepping {
    /// What computes it.
    pub graph: Graph,
    /// What becomes of the state: the place of an entry and its value. Entries that are not named stay.
    pub outputs: Vec<(usize, Value)>,
    /// Where what it is given stands.
    pub places: Places,
}

impl Places {
    /// Those of a model.
    ///
    /// # Errors
    /// What a model has that steps as graphs do not, in words.
    pub fn of(model: &Model) -> Result<Self, String> {
        refuse(model)?;
        let (mut end, mut joints) = (0, vec![]);
        let mut next = |size: usize| {
            let range = end..end + size;
            end = range.end;
            range
        };
        let shares = model.shares();
        for (index, body) in model.joints() {
            let (share, shape) = (shares[index].clone(), body.joint.derived.shape);
            let adds = adds(model, index);
            joints.push(Position {
                share,
                adds,
                base: next(shape.configuration),
                offset: next(if adds { 0 } else { shape.freedoms }),
                rest: next(shape.freedoms),
            });
        }
        let speeds = model.sizes()[2];
        let (speeds, rests) = (next(speeds), next(speeds));
        Ok(Self {
            joints,
            speeds,
            rests,
            step: end,
            numbers: end + 1,
        })
    }
}

/// One step of `model`, pruned to `links`, with `scheme`. Numbers of the model whose bits are in `marks` stand for those that are given, by their places after [`Places::numbers`].
///
/// # Errors
/// What a model has that steps as graphs do not, in words.
pub fn stepping(
    model: &Model,
    links: &[Link],
    scheme: Scheme<'_>,
    marks: &[f64],
) -> Result<Stepping, String> {
    let places = Places::of(model)?;
    let keys = marks.iter().zip(places.numbers..);
    let keys = keys.map(|(mark, place)| (mark.to_bits(), u32::try_from(place).unwrap_or(u32::MAX)));
    let keys: FxHashMap<u64, u32> = keys.collect();
    let way = shortest(model, links, &keys).ok_or("it has no forward dynamics")?;
    let step = Step {
        model,
        links,
        scheme,
        places: &places,
        way,
    };
    let (outputs, graph) = record_marked(keys, || step.end());
    Ok(Stepping {
        graph,
        outputs,
        places,
    })
}

/// What computes accelerations.
type Way = fn(&Tree<'_>) -> Vec<Sym>;

/// The recursion that takes the fewest operations.
fn shortest(model: &Model, links: &[Link], keys: &FxHashMap<u64, u32>) -> Option<Way> {
    let efforts = vec![Sym::zero(); model.sizes()[1]];
    let cost = |way: &Way| {
        let (outputs, graph) = record_marked(keys.clone(), || {
            bound(&[(Argument::Efforts, &efforts)], || {
                let rates = way(&Tree::new(model, links.to_vec()));
                rates.into_iter().map(Sym::value).collect::<Vec<_>>()
            })
        });
        Operations::of(&graph, &outputs).flops()
    };
    ways_to_accelerations(model).into_iter().min_by_key(cost)
}

/// What has no steps as graphs.
fn refuse(model: &Model) -> Result<(), String> {
    if !model.coupling.constraints.is_empty() {
        return Err("constraints couple its joints".into());
    }
    if !model.elements.limits.is_empty() {
        return Err("it has limits of joints".into());
    }
    if !model.elements.port_efforts.is_empty() {
        return Err("it has efforts at ports".into());
    }
    for (index, body) in model.joints() {
        let (name, kind) = (&body.joint_name, &body.joint.derived.spec.name.value);
        if body.driven {
            return Err(format!("the motion of joint `{name}` is prescribed"));
        }
        if body.joint.linkage.is_some() {
            return Err(format!("joint `{name}` is a mechanism of its own"));
        }
        let formula = |kind: KernelKind| {
            let kernel = body.joint.derived.kernel(kind);
            kernel.is_some_and(|kernel| kernel.method == Method::Formula)
        };
        let needed = [
            KernelKind::Retract,
            KernelKind::RetractDifferentialInverse,
            KernelKind::VelocityMapInverse,
        ];
        if !adds(model, index) && !needed.into_iter().all(formula) {
            return Err(format!(
                "Φ of joint `{name}` (`{kind}`) is found by iterations"
            ));
        }
    }
    Ok(())
}

/// Whether Φ(Q, ϕ) = Q + ϕ.
fn adds(model: &Model, index: usize) -> bool {
    let body = &model.bodies[index];
    let shape = body.joint.derived.shape;
    let is_formula = body.joint.derived.kernel(KernelKind::Retract);
    let is_formula = is_formula.is_some_and(|kernel| kernel.method == Method::Formula);
    if body.joint.linkage.is_some() || !is_formula || shape.configuration != shape.freedoms {
        return false;
    }
    let (adds, _) = record(|| {
        let inputs = |argument, size| (0..size).map(|i| Sym::input(argument, i)).collect();
        let q: Vec<Sym> = inputs(Argument::Configuration, shape.configuration);
        let phi: Vec<Sym> = inputs(Argument::Given, shape.freedoms);
        let moved = Joint::new(&body.joint, &body.parameters, &q, &[]).retract(&phi);
        let sums = q.iter().zip(&phi).map(|(&q, &phi)| q + phi);
        moved == sums.collect::<Vec<Sym>>()
    });
    adds
}

/// A step under construction.
struct Step<'a> {
    model: &'a Model,
    links: &'a [Link],
    scheme: Scheme<'a>,
    places: &'a Places,
    way: Way,
}

/// ϕ̇ and v̄̇ at a stage, one after the other.
type Rates = Vec<Sym>;

/// A stage: ϕ, or Q where Φ adds, of all joints, and v̄.
struct Stage {
    positions: Vec<Vec<Sym>>,
    speeds: Vec<Sym>,
}

impl Step<'_> {
    fn end(&self) -> Vec<(usize, Value)> {
        let mut rates: Vec<Rates> = vec![];
        for row in self.scheme.matrix {
            let stage = self.stage(&self.sum(row, &rates));
            rates.push(self.rates(&stage));
        }
        self.sums(&self.sum(self.scheme.weights, &rates))
    }

    /// `Σ h weights · rates`, of all ϕ and then of v̄; none where there are no weights.
    fn sum(&self, weights: &[f64], rates: &[Rates]) -> Vec<Sym> {
        let [_, freedoms, speeds] = self.model.sizes();
        let step = Sym::input(Argument::Given, self.places.step);
        let entry = |place: usize| {
            let terms = weights.iter().zip(rates);
            let terms = terms.filter(|(weight, _)| **weight != 0.0);
            // All entries share the products with the length of the step.
            terms
                .map(|(&weight, rates)| rates[place] * (step * Sym::from(weight)))
                .sum()
        };
        (0..freedoms + speeds).map(entry).collect()
    }

    /// The state and an increment.
    fn stage(&self, increment: &[Sym]) -> Stage {
        let [_, freedoms, _] = self.model.sizes();
        let moved = |start: Range<usize>, rest: Range<usize>, change: &[Sym]| {
            let terms = start.zip(rest).zip(change);
            terms
                .map(|((start, rest), &change)| match change.is_zero() {
                    // The start of a step is the state as it is told.
                    true => given(start),
                    false => given(start) + (change + given(rest)),
                })
                .collect::<Vec<Sym>>()
        };
        let joints = self.places.joints.iter().map(|joint| {
            let change = &increment[joint.share.freedoms.clone()];
            moved(joint.start(), joint.rest.clone(), change)
        });
        Stage {
            positions: joints.collect(),
            speeds: moved(
                self.places.speeds.clone(),
                self.places.rests.clone(),
                &increment[freedoms..],
            ),
        }
    }

    fn rates(&self, stage: &Stage) -> Rates {
        let joints = self.places.joints.iter().zip(&stage.positions);
        let q: Vec<Sym> = joints
            .zip(self.model.joints())
            .flat_map(|((joint, position), (_, body))| match joint.adds {
                true => position.clone(),
                false => {
                    let base: Vec<Sym> = joint.base.clone().map(given).collect();
                    Joint::new(&body.joint, &body.parameters, &base, &[]).retract(position)
                }
            })
            .collect();
        let efforts = vec![Sym::zero(); self.model.sizes()[1]];
        let arguments = [
            (Argument::Configuration, &q[..]),
            (Argument::Speeds, &stage.speeds[..]),
            (Argument::Efforts, &efforts[..]),
        ];
        bound(&arguments, || {
            let tree = Tree::new(self.model, self.links.to_vec());
            let mut rates = self.local_rates(stage, &q);
            rates.extend((self.way)(&tree));
            rates
        })
    }

    /// ϕ̇ of all joints: S̄, S₀⁻¹ at Q, and what Φ makes of it at ϕ.
    fn local_rates(&self, stage: &Stage, q: &[Sym]) -> Rates {
        let mut rates = vec![];
        let joints = self.places.joints.iter().zip(&stage.positions);
        for ((place, position), (_, body)) in joints.zip(self.model.joints()) {
            let q = &q[place.share.configuration.clone()];
            let joint = Joint::new(&body.joint, &body.parameters, q, &[]);
            let speeds = &stage.speeds[place.share.speeds.clone()];
            let basis = joint.speed_basis();
            let velocity = basis
                .iter()
                .map(|row| row.iter().zip(speeds).map(|(&s, &v)| s * v).sum::<Sym>());
            let velocity: Vec<Sym> = velocity.collect();
            let mut rate = vec![Sym::zero(); velocity.len()];
            for (column, &v) in joint.velocity_map_inverse().iter().zip(&velocity) {
                for (sum, &entry) in rate.iter_mut().zip(column) {
                    *sum += entry * v;
                }
            }
            rates.extend(match place.adds {
                true => rate,
                false => {
                    let base: Vec<Sym> = place.base.clone().map(given).collect();
                    let base = Joint::new(&body.joint, &body.parameters, &base, &[]);
                    base.retract_differential_inverse(position, &rate)
                }
            });
        }
        rates
    }

    /// The state at the end, with what its sums are too coarse to hold.
    fn sums(&self, increment: &[Sym]) -> Vec<(usize, Value)> {
        let [_, freedoms, _] = self.model.sizes();
        let mut outputs = vec![];
        let mut add = |start: Range<usize>, rest: Range<usize>, change: &[Sym]| {
            for ((start, rest), &change) in start.zip(rest).zip(change) {
                let (sum, lost) = add_exactly(given(start), change + given(rest));
                outputs.push((start, sum.value()));
                outputs.push((rest, lost.value()));
            }
        };
        for joint in &self.places.joints {
            let change = &increment[joint.share.freedoms.clone()];
            add(joint.start(), joint.rest.clone(), change);
        }
        let Places { speeds, rests, .. } = self.places;
        add(speeds.clone(), rests.clone(), &increment[freedoms..]);
        outputs
    }
}

impl Position {
    /// What moves in a step.
    fn start(&self) -> Range<usize> {
        match self.adds {
            true => self.base.clone(),
            false => self.offset.clone(),
        }
    }
}

fn given(place: usize) -> Sym {
    Sym::input(Argument::Given, place)
}

/// The rounded sum, and what it lacks of the exact one (D. E. Knuth).
fn add_exactly(a: Sym, b: Sym) -> (Sym, Sym) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}
