//! What moves under virtual speeds, and the sums over what each joint carries.

use super::hessian::Hessian;
use crate::equations::derivatives::Carried;
use crate::equations::variation::{Motion, Variation};
use crate::equations::{Tree, carried, number, to_parent, wrench_to_parent};
use crate::graph::{Argument, Sym, section};
use crate::spatial::{Coriolis, Twist, Vec3, Wrench, dot};

/// One direction of a joint: a coordinate ϕ, then a speed.
pub(super) struct Direction {
    /// Z, U and W.
    pub(super) variation: Variation,
    /// p; 0 for a speed.
    pub(super) virtual_drift: Twist,
}

/// A body under virtual speeds.
pub(super) struct Moving {
    /// How it moves.
    pub(super) motion: Motion,
    /// P of its parent, in its frame.
    pub(super) carried: Twist,
    /// P.
    pub(super) twist: Twist,
    /// ϕ of its joint, then v̄.
    pub(super) directions: Vec<Direction>,
}

/// Sums over a body and all that hangs on it.
#[derive(Clone)]
pub(super) struct Sums {
    /// N, B and F.
    pub(super) carried: Carried,
    /// h.
    pub(super) rate: Wrench,
    /// The moment β.
    pub(super) twist: Vec3,
    /// B^P.
    pub(super) coriolis: Coriolis,
}

impl Tree<'_> {
    /// The rates v̄̇ as they are given.
    pub(super) fn given_rates(&self) -> Vec<Sym> {
        self.inputs(Argument::Accelerations)
    }

    /// The virtual speeds μ as they are given.
    pub(super) fn virtual_speeds(&self) -> Vec<Sym> {
        self.inputs(Argument::Weights)
    }

    /// Entries of an argument, one a speed.
    fn inputs(&self, argument: Argument) -> Vec<Sym> {
        let count = self.model.sizes()[2];
        (0..count).map(|i| Sym::input(argument, i)).collect()
    }

    /// λᵀ∂²τ̄ of inverse dynamics at v̄̇, the argument: by rows, over (ϕ, v̄, v̄̇).
    pub fn inverse_second_derivatives(&self) -> Vec<Sym> {
        let hessian = self.contracted(None);
        let size = hessian.of_effort(0);
        let row = |i: usize| (0..size).map(move |j| (i, j));
        let places = (0..size).flat_map(row);
        places.map(|(i, j)| hessian.entry(i, j)).collect()
    }

    /// The Hessian of `μᵀ(τ̄ − S̄ᵀτ)`, of all that acts, over (ϕ, v̄, v̄̇) and, where there are any, the efforts τ of the argument.
    pub(super) fn contracted(&self, efforts: Option<Argument>) -> Hessian {
        self.contracted_but(efforts, |index, bodies, sums, hessian| {
            self.add_pairs_above(index, bodies, sums, hessian);
        })
    }

    /// The same without pairs of directions of different joints, which are left to `visit` for each joint.
    pub(super) fn contracted_but(
        &self,
        efforts: Option<Argument>,
        mut visit: impl FnMut(usize, &[Moving], &[Sums], &mut Hessian),
    ) -> Hessian {
        let mut hessian = Hessian::new(self);
        let mut gradient = self.add_acting(efforts, &mut hessian);
        let bodies = self.virtually_moved();
        let mut sums = self.own_sums(&bodies);
        for index in (0..self.bodies.len()).rev() {
            section(number(index), "curvature");
            if let Some(parent) = self.bodies[index].parent {
                let own = self.at_parent(index, &sums[index]);
                sums[parent] = sums[parent].plus(&own);
            }
        }
        for index in (0..self.bodies.len()).rev() {
            section(number(index), "curvature");
            self.add_own_pairs(index, &bodies[index], &sums[index], &mut hessian);
            self.add_gradient(index, &bodies[index], &sums[index], &mut gradient);
            // All other bodies of the joint come before in this order.
            if self.model.bodies[index].leads() {
                visit(index, &bodies, &sums, &mut hessian);
                self.add_chart_terms(index, &gradient, &mut hessian);
            }
        }
        hessian
    }

    /// All bodies at v̄̇ and under μ, as they are given.
    fn virtually_moved(&self) -> Vec<Moving> {
        let (rates, weights) = (self.given_rates(), self.virtual_speeds());
        let motions = self.moved(&rates);
        let mut moving: Vec<Moving> = vec![];
        for (index, motion) in motions.into_iter().enumerate() {
            section(number(index), "virtual motion");
            let body = &self.bodies[index];
            let from = body
                .parent
                .map_or_else(Twist::zero, |parent| moving[parent].twist.clone());
            let base = carried(&body.steps, &from).settled();
            let own = &weights[body.share.speeds.clone()];
            let twist = base.plus(&self.along(index, own)).settled();
            let variations = self.variations(index, &motion, &rates).into_iter();
            let slopes = self.joint_at(index, &body.speeds).twist_gradient(own);
            let directions = variations.enumerate().map(|(k, variation)| Direction {
                virtual_drift: match slopes.get(k) {
                    Some(slope) => base.bracket(&variation.local).plus(slope),
                    None => Twist::zero(),
                },
                variation,
            });
            moving.push(Moving {
                directions: directions.collect(),
                carried: base,
                twist,
                motion,
            });
        }
        moving
    }

    /// Of each body alone.
    fn own_sums(&self, bodies: &[Moving]) -> Vec<Sums> {
        let all = bodies.iter().zip(&self.links).enumerate();
        let own = all.map(|(index, (moving, link))| {
            section(number(index), "curvature");
            let inertia = link.inertia.on_graph();
            let coriolis = Coriolis::of(&inertia, &moving.motion.twist);
            Sums {
                rate: inertia.of(&moving.twist),
                twist: coriolis.apply_transposed(&moving.twist),
                coriolis: Coriolis::of(&inertia, &moving.twist),
                carried: Carried {
                    inertia,
                    coriolis,
                    wrench: moving.motion.wrench.clone(),
                },
            }
        });
        own.collect()
    }

    fn at_parent(&self, index: usize, sums: &Sums) -> Sums {
        let steps = &self.bodies[index].steps;
        Sums {
            carried: sums.carried.to_parent(steps),
            rate: wrench_to_parent(steps, &sums.rate).settled(),
            twist: to_parent(steps, &sums.twist).map(Sym::settled),
            coriolis: sums.coriolis.to_parent(steps).settled(),
        }
    }

    /// g by ϕ of one body's joint.
    fn add_gradient(&self, index: usize, body: &Moving, sums: &Sums, gradient: &mut [Sym]) {
        let places = self.bodies[index].share.freedoms.clone();
        for (place, direction) in places.zip(&body.directions) {
            gradient[place] += sums.along(&direction.virtual_drift, &direction.variation);
        }
    }
}

impl Sums {
    fn plus(&self, other: &Self) -> Self {
        Self {
            carried: self.carried.plus(&other.carried),
            rate: self.rate.plus(&other.rate),
            twist: self.twist + other.twist,
            coriolis: self.coriolis.plus(&other.coriolis),
        }
    }

    /// `pᵀF + Wᵀh + Uᵀβ`.
    pub(super) fn along(&self, virtual_drift: &Twist, variation: &Variation) -> Sym {
        virtual_drift.dot(&self.carried.wrench)
            + variation.rate.dot(&self.rate)
            + dot(&variation.drift.angular, &self.twist)
    }

    /// `B^P U`.
    pub(super) fn turned(&self, drift: &Twist) -> Wrench {
        self.coriolis.apply(&drift.angular)
    }
}
