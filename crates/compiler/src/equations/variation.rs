//! What one unit of each local coordinate and of each speed of a joint changes of the motion of all that it carries.

use super::{Tree, carried, number};
use crate::graph::{Sym, section};
use crate::spatial::{Twist, Wrench};
use num_traits::Zero;

/// Every body that the joint carries then has `δV = ad_Z V + U` and `δV̇ = ad_Z V̇ + ad_U V + W`: it is moved along by Z, and U and W are
/// the same for all of them; in the frame of the joint's body.
pub(super) struct Variation {
    /// Z, the twist of ϕ̇; 0 for a speed.
    pub(super) local: Twist,
    /// U: `ad_{V_λ} Z + ∂X̄ v̄`, or a column of X̄.
    pub(super) drift: Twist,
    /// W: `ad_{V̇_λ} Z + ad_{V_λ} U + ad_V ∂X̄ v̄ + ∂(X̄ v̄̇ + c)`, or `ad_{V + V_λ} X̄ + ∂c/∂v̄`.
    pub(super) rate: Twist,
}

/// How a body moves, in its frame.
pub(super) struct Motion {
    /// V.
    pub(super) twist: Twist,
    /// V̇, with the acceleration of the world that stands for gravity.
    pub(super) rate: Twist,
    /// V of the parent.
    pub(super) carried: Twist,
    /// V̇ of the parent.
    pub(super) carried_rate: Twist,
    /// What it takes to move it so.
    pub(super) wrench: Wrench,
}

impl Tree<'_> {
    /// The motions of all bodies at v̄̇.
    pub(super) fn moved(&self, rates: &[Sym]) -> Vec<Motion> {
        let (spins, linear) = self.accelerations(Some(rates), &self.ground());
        let ground = Twist {
            linear: self.ground(),
            ..Twist::zero()
        };
        let mut motions: Vec<Motion> = vec![];
        for (index, body) in self.bodies.iter().enumerate() {
            section(number(index), "motion");
            let parent = body.parent.map(|parent| &motions[parent]);
            let from = parent.map_or((Twist::zero(), ground.clone()), |parent| {
                (parent.twist.clone(), parent.rate.clone())
            });
            let base = carried(&body.steps, &from.0);
            let twist = base.plus(&body.velocity).settled();
            let inertia = self.links[index].inertia.on_graph();
            motions.push(Motion {
                rate: spins[index].rate(&linear[index], &twist.linear).settled(),
                twist,
                carried: base.settled(),
                carried_rate: carried(&body.steps, &from.1).settled(),
                wrench: spins[index].wrench(&inertia, &linear[index]),
            });
        }
        motions
    }

    /// The variations of a body's joint: those of its local coordinates, then those of its speeds.
    pub(super) fn variations(
        &self,
        index: usize,
        motion: &Motion,
        rates: &[Sym],
    ) -> Vec<Variation> {
        let body = &self.bodies[index];
        let joint = self.joint_at(index, &body.speeds);
        let Motion {
            twist,
            carried,
            carried_rate,
            ..
        } = motion;
        let of_twist = joint.twist_gradient(&body.speeds);
        let of_rate = joint.twist_gradient(&rates[body.share.speeds.clone()]);
        let of_bias = joint.bias_gradient();
        let local = |(b, z): (usize, Twist)| {
            let drift = carried.bracket(&z).plus(&of_twist[b]);
            let rate = carried_rate.bracket(&z).plus(&carried.bracket(&drift));
            let own = twist.bracket(&of_twist[b]);
            Variation {
                rate: rate.plus(&own).plus(&of_rate[b]).plus(&of_bias[b]),
                local: z,
                drift,
            }
        };
        let both = twist.plus(carried);
        let speed = |(column, slope): (&Twist, Twist)| Variation {
            local: Twist::zero(),
            drift: column.clone(),
            rate: both.bracket(column).plus(&slope),
        };
        let locals = joint.local_twist_map().into_iter().enumerate().map(local);
        let locals: Vec<Variation> = locals.collect();
        let speeds = body.columns.iter().zip(joint.bias_slope());
        locals.into_iter().chain(speeds.map(speed)).collect()
    }

    /// The variations of all joints. Those that a body which moves freely follows by itself, with all that it carries, are 0 where they are `solved` for.
    pub(super) fn all_variations(
        &self,
        motions: &[Motion],
        rates: &[Sym],
        solved: bool,
    ) -> Vec<Vec<Variation>> {
        let all = motions.iter().enumerate().map(|(index, motion)| {
            section(number(index), "variation");
            let mut own = self.variations(index, motion, rates);
            let free = solved && self.moves_freely(index);
            for unit in own.iter_mut().filter(|unit| free && unit.is_followed()) {
                unit.rate = Twist::zero();
            }
            own
        });
        all.collect()
    }

    /// What v̄̇ of bodies that move freely answers to such variations: the opposite of W, while all that they carry goes along. Column, speed, value.
    pub(super) fn followed_variations(&self, rates: &[Sym]) -> Vec<(usize, usize, Sym)> {
        let motions = self.moved(rates);
        let mut found = vec![];
        for index in (0..self.bodies.len()).filter(|&index| self.moves_freely(index)) {
            section(number(index), "variation");
            let body = &self.bodies[index];
            let units = self.variations(index, &motions[index], rates).into_iter();
            for (place, mut unit) in self.places(index).into_iter().zip(units) {
                if !unit.is_followed() {
                    continue;
                }
                for (column, speed) in body.columns.iter().zip(body.share.speeds.clone()) {
                    let along = column.unit_entry().map(|entry| *unit.rate.entry_mut(entry));
                    let along = along.filter(|along| !Zero::is_zero(along));
                    found.extend(along.map(|along| (place, speed, -along)));
                }
            }
        }
        found
    }

    /// Whether a body can be accelerated in all directions, one a speed, from the world, and nothing but bodies has inertia there.
    fn moves_freely(&self, index: usize) -> bool {
        let body = &self.bodies[index];
        let entries = body.columns.iter().filter_map(Twist::unit_entry);
        let directions: std::collections::BTreeSet<usize> = entries.collect();
        body.parent.is_none()
            && directions.len() == 6
            && body.columns.len() == 6
            && !self.carries_several(index)
            && !self.model.bodies[index].driven
            && !self.has_armature(index)
    }
}

impl Variation {
    /// Whether accelerations alone differ: U adds nothing to wrenches.
    fn is_followed(&self) -> bool {
        self.drift.angular.iter().all(Zero::is_zero)
    }
}
