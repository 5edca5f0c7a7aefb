//! The recursions that compute each function.

use super::Kind;
use super::choice::{PAIRED, PAIRED_SOON};
use crate::equations::{Bias, Paired, Tree};
use crate::graph::{Argument, Sym};
use crate::model::Model;

/// A recursion with its name.
pub(super) type Way = (&'static str, Run);
/// What computes the results.
pub(super) type Run = fn(&Tree<'_>) -> Vec<Sym>;
/// The same of numbers of the bodies, from which loops over pairs of joints make the results.
pub(super) type PairedWay = (&'static str, fn(&Tree<'_>) -> Paired);

impl Kind {
    /// The recursions that compute it.
    pub(super) fn ways(self, model: &Model) -> Vec<Way> {
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
    pub(super) fn pairwise(self, model: &Model) -> Vec<PairedWay> {
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
    pub(super) const fn paired(self) -> usize {
        match self {
            Self::InverseMassMatrix => PAIRED_SOON,
            _ => PAIRED,
        }
    }

    /// Whether its like parts are looked for: rows that are as long as the way to the root are not alike.
    pub(super) const fn has_like_parts(self) -> bool {
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
