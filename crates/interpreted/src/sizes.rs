//! Types of fixed sizes for joints of any: room for [`MOST_STORED`] scalars of Q, and the numbers of degrees of freedom and speeds that the joint has.

use crate::joint::{Interpreted, MOST_RELATIONS};
use crate::kernels::Kernels;
use hamel_codegen::derived::Derived;
use hamel_runtime::erased::{Shared, erase};
use std::sync::Arc;

/// Most stored scalars of an interpreted joint.
pub const MOST_STORED: usize = 24;

/// Most degrees of freedom of an interpreted joint.
pub const MOST_FREEDOMS: usize = 6;

/// Most declared relations of a joint to which these alone give Φ.
const MOST_DECLARED: usize = 8;

/// A joint has more of something than an interpreted one has room for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "joint `{joint}` has {found} {what}: one that is interpreted has at most {most}; build it into a program (docs/library.md)"
)]
pub struct TooLarge {
    /// Its name.
    pub joint: String,
    /// Of what.
    pub what: &'static str,
    /// How many.
    pub found: usize,
    /// How many are allowed.
    pub most: usize,
}

/// What a type is chosen by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    freedoms: usize,
    speeds: usize,
    implicit: bool,
}

impl Shape {
    /// That of a joint.
    ///
    /// # Errors
    /// The first number that is too large.
    pub(crate) fn of(derived: &Derived) -> Result<Self, TooLarge> {
        let (shape, implicit) = (derived.shape, derived.spec.implicit.is_some());
        let [declared, own] = derived.relation_counts();
        let independent = if implicit { declared } else { 0 };
        let constraints = if implicit { shape.constraints } else { 0 };
        let limits = [
            ("stored scalars", shape.configuration, MOST_STORED),
            ("degrees of freedom", shape.freedoms, MOST_FREEDOMS),
            ("relations", declared + own, MOST_RELATIONS),
            (
                "relations that alone say how it moves",
                independent,
                MOST_DECLARED,
            ),
            (
                "nonholonomic constraints beside relations that alone say how it moves",
                constraints,
                0,
            ),
        ];
        match limits.into_iter().find(|(_, found, most)| found > most) {
            None => Ok(Self {
                freedoms: shape.freedoms,
                speeds: shape.speeds,
                implicit,
            }),
            Some((what, found, most)) => Err(TooLarge {
                joint: derived.spec.name.value.clone(),
                what,
                found,
                most,
            }),
        }
    }
}

/// The joint behind the trait of any joint.
///
/// # Panics
/// Not for shapes that [`Shape::of`] gives.
pub(crate) fn erased(shape: Shape, kernels: &Arc<Kernels>, values: Arc<[f64]>) -> Shared {
    macro_rules! choose {
        ($(($k:literal: $($s:literal)*))*) => {
            match (shape.implicit, shape.freedoms, shape.speeds) {
                $($((false, $k, $s) => erase(
                    Interpreted::<MOST_STORED, $k, $s, { $k - $s }, 0, $k>::new(kernels.clone(), values),
                ),)*
                (true, $k, _) => erase(
                    Interpreted::<MOST_STORED, $k, $k, 0, MOST_DECLARED, { $k + MOST_DECLARED }>::new(kernels.clone(), values),
                ),)*
                (_, freedoms, speeds) => unreachable!("a shape of {freedoms} degrees of freedom and {speeds} speeds"),
            }
        };
    }
    choose! { (1: 1) (2: 1 2) (3: 1 2 3) (4: 1 2 3 4) (5: 1 2 3 4 5) (6: 1 2 3 4 5 6) }
}
