//! Pairs of directions of one joint.
//!
//! `E_l g_k = p_kᵀ (N W_l + B U_l) + p_lᵀ (N W_k + B U_k) − U_lᵀ B^P U_k + (E_l p_k)ᵀF + (E_l W_k)ᵀh + (E_l U_k)ᵀβ` where `E_l` is the derivative along
//! `Q̇(Q, S₀ e_l)`, in the axes of the child: the joint's own kernels change with Q, and what the parent does turns back, `E_l V_λ = −ad_{Z_l} V_λ`. The Hessian of
//! f(Φ(Q, ϕ)) at ϕ = 0 is `E_l g_k + Σ_m g_m [S₀⁻¹ (∂S_l − E_l S₀)]_mk`.

use super::contracted::{Direction, Moving, Sums};
use super::hessian::Hessian;
use crate::equations::Tree;
use crate::equations::derivatives::unit;
use crate::equations::variation::Variation;
use crate::graph::{Argument, Slopes, Sym};
use crate::spatial::{Twist, Vec3};
use num_traits::Zero;

/// Products of a joint's kernels that its variations are made of, or how they change: for each ϕ_k Z and ∂ of X̄ v̄, X̄ v̄̇, c and X̄ μ.
struct Kernels {
    all: Vec<[Twist; 5]>,
    /// ∂c/∂v̄.
    slopes: Vec<Twist>,
}

/// What the parent does, in the frame of the child: V, V̇ and P.
struct Carrying {
    twist: Twist,
    rate: Twist,
    virtual_twist: Twist,
}

impl Kernels {
    fn new(tree: &Tree<'_>, index: usize) -> Self {
        let body = &tree.bodies[index];
        let joint = tree.joint_at(index, &body.speeds);
        let own = |all: Vec<Sym>| all[body.share.speeds.clone()].to_vec();
        let parts = [
            joint.local_twist_map(),
            joint.twist_gradient(&body.speeds),
            joint.twist_gradient(&own(tree.given_rates())),
            joint.bias_gradient(),
            joint.twist_gradient(&own(tree.virtual_speeds())),
        ];
        let freedom = |k: usize| parts.each_ref().map(|part| part[k].clone());
        Self {
            all: (0..body.share.freedoms.len()).map(freedom).collect(),
            slopes: joint.bias_slope(),
        }
    }

    fn entries(&self) -> Vec<Sym> {
        let twists = self.all.iter().flatten().chain(&self.slopes);
        let entries = twists.flat_map(|twist| twist.angular.iter().chain(&twist.linear));
        entries.copied().collect()
    }

    /// The same with other entries.
    fn with(&self, entries: &[Sym]) -> Self {
        let twist = |entries: &[Sym]| Twist {
            angular: Vec3::from_fn(|i, _| entries[i]),
            linear: Vec3::from_fn(|i, _| entries[3 + i]),
        };
        let mut twists = entries.chunks_exact(6).map(twist);
        let mut next = || twists.next().unwrap_or_else(Twist::zero);
        Self {
            all: self.all.iter().map(|_| [(); 5].map(|()| next())).collect(),
            slopes: self.slopes.iter().map(|_| next()).collect(),
        }
    }
}

impl Carrying {
    /// How it changes along Z.
    fn turned_back(&self, z: &Twist) -> Self {
        Self {
            twist: self.twist.bracket(z),
            rate: self.rate.bracket(z),
            virtual_twist: self.virtual_twist.bracket(z),
        }
    }
}

fn plus<const N: usize>(parts: [Twist; N]) -> Twist {
    parts.iter().fold(Twist::zero(), |sum, part| sum.plus(part))
}

impl Tree<'_> {
    /// All pairs of directions of the joint under one body.
    pub(super) fn add_own_pairs(
        &self,
        index: usize,
        body: &Moving,
        sums: &Sums,
        hessian: &mut Hessian,
    ) {
        let placed = &self.bodies[index];
        let kernels = Kernels::new(self, index);
        let slopes = Slopes::new(kernels.entries());
        let places = &placed.share.configuration;
        let freedoms = placed.share.freedoms.len();
        let (locals, speeds) = body.directions.split_at(freedoms);
        for (l, moved) in self
            .joint_at(index, &[])
            .configuration_slopes()
            .iter()
            .enumerate()
        {
            let changed = slopes.along(|argument, place| match argument {
                Argument::Configuration if places.contains(&place) => moved[place - places.start],
                _ => Sym::zero(),
            });
            let changed = kernels.with(&changed);
            let outer = placed.share.freedoms.start + l;
            for (k, inner) in locals.iter().enumerate().take(l + 1) {
                let bent = self.bent_along(body, (&kernels, &changed), (l, k));
                let entry = products(&locals[l], inner, sums) + bent.met_by(sums);
                hessian.add(outer, placed.share.freedoms.start + k, entry);
            }
        }
        for (l, speed) in placed.share.speeds.clone().enumerate() {
            let changed = slopes
                .along(|argument, place| unit(argument == Argument::Speeds && place == speed));
            let changed = kernels.with(&changed);
            let outer = hessian.of_speed(speed);
            for (k, inner) in locals.iter().enumerate() {
                let bent = self.bent_faster(body, (&kernels, &changed), (index, l, k));
                let entry = products(&speeds[l], inner, sums) + bent.met_by(sums);
                hessian.add(outer, placed.share.freedoms.start + k, entry);
            }
            for (k, inner) in placed.share.speeds.clone().enumerate().take(l + 1) {
                let turned = sums.turned(&speeds[k].variation.drift);
                let rate = placed.columns[l].bracket(&placed.columns[k]);
                let entry =
                    rate.plus(&changed.slopes[k]).dot(&sums.rate) - placed.columns[l].dot(&turned);
                hessian.add(outer, hessian.of_speed(inner), entry);
            }
        }
        self.add_own_rates(index, body, sums, hessian);
    }

    /// Pairs of ϕ and v̄̇ of one body's joint: `X̄ᵀ N p + ∂X̄ᵀ h`.
    fn add_own_rates(&self, index: usize, body: &Moving, sums: &Sums, hessian: &mut Hessian) {
        let share = &self.bodies[index].share;
        let gradient = self.joint_at(index, &[]).effort_gradient(&sums.rate);
        for (j, speed) in share.speeds.clone().enumerate() {
            let momentum = sums.carried.inertia.of(&self.bodies[index].columns[j]);
            for (k, place) in share.freedoms.clone().enumerate() {
                let turned = gradient.get(j).and_then(|row| row.get(k).copied());
                let entry = body.directions[k].virtual_drift.dot(&momentum)
                    + turned.unwrap_or_else(Sym::zero);
                hessian.add(place, hessian.of_rate(speed), entry);
            }
        }
    }

    /// E_l of p, W and U of ϕ_k.
    fn bent_along(
        &self,
        body: &Moving,
        (kernels, changed): (&Kernels, &Kernels),
        (l, k): (usize, usize),
    ) -> Bent {
        let carrying = body.carrying();
        let [z, drift, ..] = &kernels.all[l];
        let moved = carrying.turned_back(z);
        let own = moved.twist.plus(drift);
        let [z, turn, ..] = &kernels.all[k];
        let [z_slope, turn_slope, rate_slope, bias_slope, virtual_slope] = &changed.all[k];
        let variation = &body.directions[k].variation;
        let drift = plus([
            moved.twist.bracket(z),
            carrying.twist.bracket(z_slope),
            turn_slope.clone(),
        ]);
        Bent {
            rate: plus([
                moved.rate.bracket(z),
                carrying.rate.bracket(z_slope),
                moved.twist.bracket(&variation.drift),
                carrying.twist.bracket(&drift),
                own.bracket(turn),
                body.motion.twist.bracket(turn_slope),
                rate_slope.clone(),
                bias_slope.clone(),
            ]),
            virtual_drift: plus([
                moved.virtual_twist.bracket(z),
                carrying.virtual_twist.bracket(z_slope),
                virtual_slope.clone(),
            ]),
            drift,
        }
    }

    /// How W and U of ϕ_k change with the speed l of the joint.
    fn bent_faster(
        &self,
        body: &Moving,
        (kernels, changed): (&Kernels, &Kernels),
        (index, l, k): (usize, usize, usize),
    ) -> Bent {
        let [_, turn, ..] = &kernels.all[k];
        let [_, turn_slope, _, bias_slope, _] = &changed.all[k];
        let both = body.motion.twist.plus(&body.motion.carried);
        Bent {
            rate: plus([
                self.bodies[index].columns[l].bracket(turn),
                both.bracket(turn_slope),
                bias_slope.clone(),
            ]),
            drift: turn_slope.clone(),
            virtual_drift: Twist::zero(),
        }
    }

    /// What the chart of the joint that a body stands for adds, with the gradient by all ϕ.
    pub(super) fn add_chart_terms(&self, index: usize, gradient: &[Sym], hessian: &mut Hessian) {
        let joint = self.joint_at(index, &[]);
        let places = self.bodies[index].share.freedoms.clone();
        let slices = joint.velocity_map_gradient();
        if slices.is_empty() {
            return;
        }
        let inverse = joint.velocity_map_inverse();
        let map = Slopes::new(joint.velocity_map());
        let own = &self.bodies[index].share.configuration;
        let size = places.len();
        for (l, moved) in joint.configuration_slopes().iter().enumerate() {
            let along = map.along(|argument, place| match argument {
                Argument::Configuration if own.contains(&place) => moved[place - own.start],
                _ => Sym::zero(),
            });
            for k in 0..=l {
                // Column k of ∂S_l − E_l S₀, then of S₀⁻¹ times that.
                let change = |i: usize| slices[l][i * size + k] - along[i * size + k];
                let change: Vec<Sym> = (0..size).map(change).collect();
                let entry = (0..size).map(|m| {
                    let terms = (0..size).map(|i| inverse[i][m] * change[i]);
                    terms.sum::<Sym>() * gradient[places.start + m]
                });
                hessian.add(places.start + l, places.start + k, entry.sum());
            }
        }
    }
}

/// How p, W and U of a direction change.
struct Bent {
    drift: Twist,
    rate: Twist,
    virtual_drift: Twist,
}

impl Bent {
    fn met_by(self, sums: &Sums) -> Sym {
        let variation = Variation {
            local: Twist::zero(),
            drift: self.drift,
            rate: self.rate,
        };
        sums.along(&self.virtual_drift, &variation)
    }
}

impl Moving {
    fn carrying(&self) -> Carrying {
        Carrying {
            twist: self.motion.carried.clone(),
            rate: self.motion.carried_rate.clone(),
            virtual_twist: self.carried.clone(),
        }
    }
}

/// `p_kᵀ (N W_l + B U_l) + p_lᵀ (N W_k + B U_k) − U_lᵀ B^P U_k`.
fn products(outer: &Direction, inner: &Direction, sums: &Sums) -> Sym {
    let raised = |own: &Direction| sums.carried.raised(&own.variation);
    let turned = sums.turned(&inner.variation.drift);
    inner.virtual_drift.dot(&raised(outer)) + outer.virtual_drift.dot(&raised(inner))
        - outer.variation.drift.dot(&turned)
}
