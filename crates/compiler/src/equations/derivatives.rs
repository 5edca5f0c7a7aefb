//! Derivatives of inverse dynamics with respect to local coordinates ϕ (at ϕ = 0) and speeds.
//!
//! A unit of ϕ or of a speed of joint k changes the wrench that body i below it takes by `−ad_Zᵀ f_i + N_i W + B_i U` ([`Variation`],
//! [`Coriolis`]). With N, B and F summed over each subtree, for joints j above k
//!
//! ```text
//! ∂τ̄_j/∂x_k = X̄_jᵀ (N_k W + B_k U − ad_Zᵀ F_k)
//! ∂τ̄_k/∂x_k = X̄_kᵀ (N_k W + B_k U) + ∂X̄ᵀ F_k
//! ∂τ̄_k/∂x_j = W_jᵀ (N_k X̄_k) + U_jᵀ (B_kᵀ X̄_k)
//! ```
//!
//! which is O(n · depth), as the tree computes them. What elements and rotors exert is differentiated on the graph ([`Slopes`]).

use super::variation::Variation;
use super::{Tree, number, wrench_to_parent};
use crate::graph::{Argument, Slopes, Sym, section};
use crate::spatial::{Coriolis, Rigid, Step, Vec3, Wrench, dot};
use num_traits::{One, Zero};

/// A row a speed; a column a degree of freedom, then a column a speed.
pub(super) type Rows = Vec<Vec<Sym>>;

/// A body and all that hangs on it.
#[derive(Clone)]
pub(super) struct Carried {
    /// N.
    pub(super) inertia: Rigid,
    /// B.
    pub(super) coriolis: Coriolis,
    /// F.
    pub(super) wrench: Wrench,
}

/// What a joint's own units and speeds show to the joints above it.
pub(super) struct Shown {
    /// `N W + B U − ad_Zᵀ F` of each variation.
    pub(super) raised: Vec<Wrench>,
    /// `N X̄` and the angular part of `Bᵀ X̄` of each speed.
    pub(super) momenta: Vec<(Wrench, Vec3)>,
}

impl Tree<'_> {
    /// `∂τ̄/∂ϕ` and `∂τ̄/∂v̄` of inverse dynamics at v̄̇, the argument: rows of both, one after the other.
    pub fn inverse_derivatives(&self) -> Vec<Sym> {
        let count = self.model.sizes()[2];
        let rates = (0..count).map(|i| Sym::input(Argument::Accelerations, i));
        let rates: Vec<Sym> = rates.collect();
        self.needed_slopes(&rates, None).concat()
    }

    /// The derivatives of what v̄̇ takes beside the efforts of the argument and what acts on the mechanism; with efforts, v̄̇ is solved for, and what bodies follow
    /// by themselves ([`Tree::followed_variations`]) is left out.
    pub(super) fn needed_slopes(&self, rates: &[Sym], efforts: Option<Argument>) -> Rows {
        let mut rows = self.rigid_slopes(rates, efforts.is_some());
        self.add_acting_slopes(rates, efforts, &mut rows);
        rows
    }

    /// What efforts, elements, dampers and rotors add to rows of derivatives.
    pub(super) fn add_acting_slopes(
        &self,
        rates: &[Sym],
        efforts: Option<Argument>,
        rows: &mut Rows,
    ) {
        self.add_rotor_slopes(rates, rows);
        let exerted = Slopes::new(self.exerted(efforts));
        for (place, column) in self.along_state(&exerted).into_iter().enumerate() {
            for (row, entry) in rows.iter_mut().zip(column) {
                row[place] -= entry;
            }
        }
    }

    /// The generalised forces of the efforts of the argument, elements, dampers and rotors.
    pub(super) fn exerted(&self, argument: Option<Argument>) -> Vec<Sym> {
        let mut exerted = self.efforts_of(self.external(), None);
        for (index, body) in self.joints() {
            let efforts = self.efforts(index, argument);
            for (place, effort) in body.share.speeds.clone().zip(efforts) {
                exerted[place] += effort;
            }
        }
        exerted
    }

    /// Columns of derivatives in all ϕ, then in all speeds.
    pub(super) fn along_state(&self, values: &Slopes) -> Vec<Vec<Sym>> {
        let mut columns = vec![];
        for (index, body) in self.joints() {
            section(number(index), "slope");
            let places = &body.share.configuration;
            for moved in self.joint_at(index, &[]).configuration_slopes() {
                columns.push(values.along(|argument, place| match argument {
                    Argument::Configuration if places.contains(&place) => {
                        moved[place - places.start]
                    }
                    _ => Sym::zero(),
                }));
            }
        }
        for (index, body) in self.joints() {
            section(number(index), "slope");
            for speed in body.share.speeds.clone() {
                columns.push(
                    values.along(|argument, place| {
                        unit(argument == Argument::Speeds && place == speed)
                    }),
                );
            }
        }
        columns
    }

    /// The derivatives of what moving the bodies takes.
    fn rigid_slopes(&self, rates: &[Sym], solved: bool) -> Rows {
        let [_, freedoms, speeds] = self.model.sizes();
        let mut rows = vec![vec![Sym::zero(); freedoms + speeds]; speeds];
        self.carry((rates, solved), |index, carried, variations| {
            self.climb(index, carried, variations, &mut rows);
        });
        rows
    }

    /// What each body carries, itself included, from the leaves to the root, and the variations of all joints; `visit` sees what a joint's bodies carry and all
    /// behind them.
    pub(super) fn carry(
        &self,
        (rates, solved): (&[Sym], bool),
        mut visit: impl FnMut(usize, &[Carried], &[Vec<Variation>]),
    ) {
        let motions = self.moved(rates);
        let variations = self.all_variations(&motions, rates, solved);
        let bodies = motions.iter().zip(&self.links);
        let mut carried: Vec<Carried> = bodies
            .enumerate()
            .map(|(index, (motion, link))| {
                section(number(index), "slope");
                let inertia = link.inertia.on_graph();
                Carried {
                    coriolis: Coriolis::of(&inertia, &motion.twist),
                    inertia,
                    wrench: motion.wrench.clone(),
                }
            })
            .collect();
        for index in (0..self.bodies.len()).rev() {
            section(number(index), "slope");
            // All other bodies of the joint come before in this order.
            if self.model.bodies[index].leads() {
                visit(index, &carried, &variations);
                section(number(index), "slope");
            }
            if let Some(parent) = self.bodies[index].parent {
                let own = carried[index].clone();
                carried[parent] = carried[parent].plus(&own.to_parent(&self.bodies[index].steps));
            }
        }
    }

    /// Rows and columns of one joint against itself and those above it.
    fn climb(
        &self,
        index: usize,
        carried: &[Carried],
        variations: &[Vec<Variation>],
        rows: &mut Rows,
    ) {
        let own = self.model.carried(index);
        let shown = own.map(|body| {
            let shown = self.shown(body, &carried[body], &variations[body], rows);
            let parent = self.bodies[body].parent?;
            Some((parent, shown.at_parent(&self.bodies[body].steps)))
        });
        let add =
            |(parent, sum): (usize, Shown), (_, shown): (usize, Shown)| (parent, sum.plus(shown));
        let mut carrier = shown.collect::<Vec<_>>().into_iter().flatten().reduce(add);
        while let Some((above, shown)) = carrier {
            self.meet((index, above), &shown, &variations[above], rows);
            let body = &self.bodies[above];
            carrier = body
                .parent
                .map(|parent| (parent, shown.at_parent(&body.steps)));
        }
    }

    /// Rows and columns of one body's joint against itself, and what the body shows.
    pub(super) fn shown(
        &self,
        index: usize,
        carried: &Carried,
        own: &[Variation],
        rows: &mut Rows,
    ) -> Shown {
        let body = &self.bodies[index];
        let mut raised: Vec<Wrench> = own.iter().map(|own| carried.raised(own)).collect();
        let gradient = self.joint_at(index, &[]).effort_gradient(&carried.wrench);
        for (b, (&place, raised)) in self.places(index).iter().zip(&raised).enumerate() {
            for (j, speed) in body.share.speeds.clone().enumerate() {
                let turned = gradient.get(j).and_then(|row| row.get(b).copied());
                rows[speed][place] +=
                    body.columns[j].dot(raised) + turned.unwrap_or_else(Sym::zero);
            }
        }
        for (raised, own) in raised.iter_mut().zip(own) {
            let along = own.local.bracket_dual(&carried.wrench);
            *raised = raised.plus(&along.times(-Sym::one()));
        }
        let columns = body.columns.iter();
        Shown {
            raised,
            momenta: columns
                .map(|x| (carried.inertia.of(x), carried.coriolis.apply_transposed(x)))
                .collect(),
        }
    }

    /// The columns of a joint's own units: of its local coordinates, then of its speeds.
    pub(super) fn places(&self, index: usize) -> Vec<usize> {
        let share = &self.bodies[index].share;
        let freedoms = self.model.sizes()[1];
        let speeds = share.speeds.clone().map(|speed| freedoms + speed);
        share.freedoms.clone().chain(speeds).collect()
    }

    /// One joint against one above it, in whose frame `shown` is.
    fn meet(
        &self,
        (own, above): (usize, usize),
        shown: &Shown,
        variations: &[Variation],
        rows: &mut Rows,
    ) {
        let (body, carrier) = (&self.bodies[own], &self.bodies[above]);
        for (place, raised) in self.places(own).into_iter().zip(&shown.raised) {
            for (column, speed) in carrier.columns.iter().zip(carrier.share.speeds.clone()) {
                rows[speed][place] = column.dot(raised);
            }
        }
        for (place, variation) in self.places(above).into_iter().zip(variations) {
            for ((momentum, transposed), speed) in
                shown.momenta.iter().zip(body.share.speeds.clone())
            {
                rows[speed][place] =
                    variation.rate.dot(momentum) + dot(&variation.drift.angular, transposed);
            }
        }
    }
}

impl Carried {
    pub(super) fn plus(&self, other: &Self) -> Self {
        Self {
            inertia: self.inertia.plus(&other.inertia),
            coriolis: self.coriolis.plus(&other.coriolis),
            wrench: self.wrench.plus(&other.wrench),
        }
    }

    pub(super) fn to_parent(&self, steps: &[Step]) -> Self {
        Self {
            inertia: self.inertia.to_parent(steps).settled(),
            coriolis: self.coriolis.to_parent(steps).settled(),
            wrench: wrench_to_parent(steps, &self.wrench).settled(),
        }
    }

    /// What one unit more of something changes of the wrench, beside carrying it along.
    pub(super) fn raised(&self, variation: &Variation) -> Wrench {
        let faster = self.coriolis.apply(&variation.drift.angular);
        self.inertia.of(&variation.rate).plus(&faster)
    }
}

impl Shown {
    pub(super) fn plus(mut self, other: Self) -> Self {
        for (raised, other) in self.raised.iter_mut().zip(&other.raised) {
            *raised = raised.plus(other);
        }
        for (own, other) in self.momenta.iter_mut().zip(other.momenta) {
            *own = (own.0.plus(&other.0), own.1 + other.1);
        }
        self
    }

    pub(super) fn at_parent(mut self, steps: &[Step]) -> Self {
        for raised in &mut self.raised {
            *raised = wrench_to_parent(steps, raised);
        }
        for (momentum, transposed) in &mut self.momenta {
            *momentum = wrench_to_parent(steps, momentum);
            *transposed = super::to_parent(steps, transposed);
        }
        self
    }
}

/// 1 where it is so.
pub(super) fn unit(is_so: bool) -> Sym {
    if is_so { Sym::one() } else { Sym::zero() }
}
