//! What a joint tells of itself: the constants of [`Joint`] in one value, for joints that know them when they are made.

use super::{Joint, Pin, Structures, VelocityFrame};

/// The constants of a [`Joint`] by which mechanisms know it; each is that of the same name there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facts {
    /// Name of the spec.
    pub name: &'static str,
    /// Names of the stored scalars of Q: N of them.
    pub coordinates: &'static [&'static str],
    /// Names of the degrees of freedom: K of them.
    pub freedoms: &'static [&'static str],
    /// Names of the speeds: S of them.
    pub speeds: &'static [&'static str],
    /// The frame in which v is read.
    pub velocity_frame: VelocityFrame,
    /// Which kernels are trivial. Where those of the type say less, a kernel is evaluated that need not be.
    pub structures: Structures,
    /// Basis of the inertias that do not affect the joint.
    pub unidentifiable: &'static [[f64; 10]],
    /// The functions whose zeros the joint must stay away from.
    pub singularities: &'static [&'static str],
    /// The declared relations.
    pub relations: &'static [&'static str],
    /// Their units.
    pub relation_units: &'static [&'static str],
    /// The pins.
    pub pins: &'static [Pin],
}

impl Facts {
    /// Those of a type.
    pub const fn of<J, const N: usize, const K: usize, const S: usize, const C: usize>() -> Self
    where
        J: Joint<N, K, S, C>,
    {
        Self {
            name: J::NAME,
            coordinates: const { &J::COORDINATES },
            freedoms: const { &J::FREEDOMS },
            speeds: const { &J::SPEEDS },
            velocity_frame: J::VELOCITY_FRAME,
            structures: J::STRUCTURES,
            unidentifiable: J::UNIDENTIFIABLE,
            singularities: J::SINGULARITIES,
            relations: J::RELATIONS,
            relation_units: J::RELATION_UNITS,
            pins: J::PINS,
        }
    }
}
