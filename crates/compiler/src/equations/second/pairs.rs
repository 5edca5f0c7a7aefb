//! Pairs of directions of different joints, one above the other.

use super::contracted::{Direction, Moving, Sums};
use super::hessian::Hessian;
use crate::equations::{Tree, number, to_parent, wrench_to_parent};
use crate::graph::{Sym, section};
use crate::spatial::{Step, Twist, Vec3, Wrench, cross, dot};
use num_traits::One;

/// What the directions of a joint meet those above with: p with `by_virtual_drift`, W with `by_rate`, and U with the moment `by_drift`.
pub(super) struct Raised {
    /// Of ϕ, then of v̄.
    by_virtual_drift: Vec<Wrench>,
    /// Of ϕ.
    pub(super) by_rate: Vec<Wrench>,
    /// Of ϕ, then of v̄.
    pub(super) by_drift: Vec<Vec3>,
    /// Of v̄̇, met by p.
    momenta: Vec<Wrench>,
}

impl Raised {
    pub(super) fn of(directions: &[Direction], columns: &[Twist], sums: &Sums) -> Self {
        let opposite = -Sym::one();
        let along = |own: &Direction, wrench: &Wrench| {
            let dual = own.variation.local.bracket_dual(wrench);
            dual.times(opposite)
        };
        let carried = &sums.carried;
        let by_virtual_drift = directions.iter().map(|own| {
            let raised = carried.raised(&own.variation);
            raised.plus(&along(own, &carried.wrench))
        });
        let locals = directions.len() - columns.len();
        let by_rate = directions[..locals].iter().map(|own| {
            let momentum = carried.inertia.of(&own.virtual_drift);
            momentum.plus(&along(own, &sums.rate))
        });
        let by_drift = directions.iter().map(|own| {
            let turned = carried.coriolis.apply_transposed(&own.virtual_drift);
            let moved = cross(&own.variation.local.angular, &sums.twist);
            turned + moved - sums.coriolis.apply_transposed(&own.variation.drift)
        });
        Self {
            by_virtual_drift: by_virtual_drift.collect(),
            by_rate: by_rate.collect(),
            by_drift: by_drift.collect(),
            momenta: columns.iter().map(|x| carried.inertia.of(x)).collect(),
        }
    }

    pub(super) fn at_parent(self, steps: &[Step]) -> Self {
        let wrenches = |all: Vec<Wrench>| -> Vec<Wrench> {
            let moved = all.iter().map(|own| wrench_to_parent(steps, own));
            moved.collect()
        };
        let moments = self.by_drift.iter().map(|own| to_parent(steps, own));
        Self {
            by_drift: moments.collect(),
            by_virtual_drift: wrenches(self.by_virtual_drift),
            by_rate: wrenches(self.by_rate),
            momenta: wrenches(self.momenta),
        }
    }

    pub(super) fn plus(self, other: &Self) -> Self {
        let wrenches = |all: &[Wrench], others: &[Wrench]| -> Vec<Wrench> {
            let pairs = all.iter().zip(others);
            pairs.map(|(a, b)| a.plus(b)).collect()
        };
        let moments = self.by_drift.iter().zip(&other.by_drift);
        Self {
            by_drift: moments.map(|(a, b)| a + b).collect(),
            by_virtual_drift: wrenches(&self.by_virtual_drift, &other.by_virtual_drift),
            by_rate: wrenches(&self.by_rate, &other.by_rate),
            momenta: wrenches(&self.momenta, &other.momenta),
        }
    }
}

impl Tree<'_> {
    /// The directions of the joint that a body stands for with those of all joints above.
    pub(super) fn add_pairs_above(
        &self,
        index: usize,
        bodies: &[Moving],
        sums: &[Sums],
        hessian: &mut Hessian,
    ) {
        let own = self.model.carried(index);
        let raised = own.filter_map(|body| {
            let placed = &self.bodies[body];
            let raised = Raised::of(&bodies[body].directions, &placed.columns, &sums[body]);
            Some((placed.parent?, raised.at_parent(&placed.steps)))
        });
        let all: Vec<(usize, Raised)> = raised.collect();
        let add = |(parent, sum): (usize, Raised), (_, other): (usize, Raised)| {
            (parent, sum.plus(&other))
        };
        let mut carrier = all.into_iter().reduce(add);
        while let Some((above, raised)) = carrier {
            section(number(index), "curvature");
            self.meet_above((index, above), &raised, &bodies[above], hessian);
            let body = &self.bodies[above];
            carrier = body
                .parent
                .map(|parent| (parent, raised.at_parent(&body.steps)));
        }
    }

    /// One joint with one above it, in whose frame `raised` is.
    fn meet_above(
        &self,
        (own, above): (usize, usize),
        raised: &Raised,
        carrier: &Moving,
        hessian: &mut Hessian,
    ) {
        let freedoms = self.bodies[above].share.freedoms.len();
        let places = self.places(own);
        for (l, (outer, direction)) in self
            .places(above)
            .into_iter()
            .zip(&carrier.directions)
            .enumerate()
        {
            let Direction {
                variation,
                virtual_drift,
            } = direction;
            for (k, &inner) in places.iter().enumerate() {
                let mut entry = dot(&variation.drift.angular, &raised.by_drift[k])
                    + virtual_drift.dot(&raised.by_virtual_drift[k]);
                if let Some(wrench) = raised.by_rate.get(k) {
                    entry += variation.rate.dot(wrench);
                    if let Some(speed) = l.checked_sub(freedoms) {
                        let rate = self.bodies[above].share.speeds.start + speed;
                        let met = self.bodies[above].columns[speed].dot(wrench);
                        hessian.add(hessian.of_rate(rate), inner, met);
                    }
                }
                hessian.add(outer, inner, entry);
            }
            for (speed, momentum) in self.bodies[own].share.speeds.clone().zip(&raised.momenta) {
                let entry = virtual_drift.dot(momentum);
                hessian.add(outer, hessian.of_rate(speed), entry);
            }
        }
    }
}
