//! A joint's degrees of freedom are taken out of the inertia of what it carries.
//!
//! Where the joint carries one body, that body's frame has the shortest equations: entries along a degree of freedom are known. The bodies of a joint
//! that carries several are added up at the parent's frame first: with A, p and c the articulated inertia of each body, the wrench that it takes and its
//! acceleration at v̄̇ = 0 under a parent that stands still,
//!
//! ```text
//! U = Σ A X̄    D = Σ X̄ᵀ A X̄    u = τ̄ − Σ X̄ᵀ (p + A c)
//! A′ = Σ A − U D⁻¹ Uᵀ    p′ = Σ (p + A c) + U D⁻¹ u    v̄̇ = D⁻¹ (u − Uᵀ a)
//! ```
//!
//! for the parent, whose acceleration is a.

use super::{Tree, number, wrench_to_parent};
use crate::graph::{Sym, section};
use crate::spatial::{Articulated, Step, Twist, Wrench};
use num_traits::Zero;

/// What a joint carries, at one frame.
pub(super) struct Carried {
    /// A.
    pub(super) inertia: Articulated,
    /// The wrench that it takes at v̄̇ = 0.
    pub(super) wrench: Wrench,
    /// U, one column per speed.
    momenta: Vec<Wrench>,
    /// D, without rotors.
    matrix: Vec<Vec<Sym>>,
    /// `X̄ᵀ` times that wrench.
    taken: Vec<Sym>,
}

/// The elimination of one speed.
pub(super) struct Pivot {
    /// `y / d`, of the momentum y of one unit of it.
    scaled: Wrench,
    /// `u / d`, of the effort u that is left for it.
    share: Sym,
    /// What the rates of the joint's later speeds take from it, over d.
    later: Vec<Sym>,
}

impl Carried {
    /// One body, with what hangs on it, in its frame.
    pub(super) fn new(columns: &[Twist], inertia: Articulated, wrench: Wrench) -> Self {
        let momenta: Vec<Wrench> = columns.iter().map(|column| inertia.of(column)).collect();
        let row = |column: &Twist| momenta.iter().map(|of| column.dot(of)).collect();
        Self {
            matrix: columns.iter().map(row).collect(),
            taken: columns.iter().map(|column| column.dot(&wrench)).collect(),
            momenta,
            inertia,
            wrench,
        }
    }

    /// The same at the parent's frame.
    pub(super) fn at_parent(mut self, steps: &[Step]) -> Self {
        self.inertia = self.inertia.to_parent(steps);
        for wrench in self.momenta.iter_mut().chain([&mut self.wrench]) {
            *wrench = wrench_to_parent(steps, wrench);
        }
        self
    }

    /// Both, at one frame.
    pub(super) fn plus(mut self, other: &Self) -> Self {
        self.inertia = self.inertia.plus(&other.inertia);
        self.wrench = self.wrench.plus(&other.wrench);
        for (own, other) in self.momenta.iter_mut().zip(&other.momenta) {
            *own = own.plus(other);
        }
        let others = other.matrix.iter().flatten().chain(&other.taken);
        let own = self.matrix.iter_mut().flatten().chain(&mut self.taken);
        own.zip(others).for_each(|(own, &other)| *own += other);
        self
    }
}

impl Tree<'_> {
    /// Takes the degrees of freedom of the joint that a body stands for out of what it carries, under efforts at it.
    pub(super) fn eliminate(
        &self,
        index: usize,
        carried: &mut Carried,
        given: &[Sym],
    ) -> Vec<Pivot> {
        section(number(index), "articulated inertia");
        let Carried {
            inertia,
            wrench,
            momenta,
            matrix,
            taken,
        } = carried;
        let count = momenta.len();
        let efforts = given
            .iter()
            .zip(taken)
            .map(|(&tau, &mut taken)| tau - taken);
        let mut efforts: Vec<Sym> = efforts.collect();
        for (j, row) in matrix.iter_mut().enumerate() {
            for (k, entry) in row.iter_mut().enumerate() {
                *entry += self.armature(index, j, k);
            }
        }
        let mut pivots = vec![];
        for j in 0..count {
            let inverse = self.inverse_of_inertia(index, j, matrix[j][j]);
            let inverse = inverse.named("inverse_inertia");
            let mut scaled = momenta[j].times(inverse);
            let felt = self.feels(index, j);
            if let Some(entry) = felt {
                *scaled.entry_mut(entry) = Sym::Number(1.0);
            }
            let later: Vec<Sym> = matrix[j][j + 1..]
                .iter()
                .map(|&entry| entry * inverse)
                .collect();
            for k in j + 1..count {
                let factor = later[k - j - 1];
                let less = factor * efforts[j];
                efforts[k] -= less;
                momenta[k] = momenta[k].plus(&momenta[j].times(-factor));
                if let Some(entry) = felt {
                    *momenta[k].entry_mut(entry) = Sym::zero();
                }
                let row: Vec<Sym> = matrix[j][k..].iter().map(|&entry| factor * entry).collect();
                for (entry, less) in matrix[k][k..].iter_mut().zip(row) {
                    *entry -= less;
                }
            }
            *inertia = inertia.without(felt, &momenta[j], &scaled);
            *wrench = wrench.plus(&momenta[j].times(efforts[j] * inverse));
            pivots.push(Pivot {
                share: efforts[j] * inverse,
                scaled,
                later,
            });
        }
        // Along a degree of freedom nothing is left but the effort at it.
        for (j, &given) in given.iter().enumerate() {
            if let Some(entry) = self.feels(index, j) {
                *wrench.entry_mut(entry) = given;
            }
        }
        pivots
    }

    /// The entry of wrenches that is the effort of a joint's speed, where there is one and nothing but what the joint carries has inertia.
    fn feels(&self, index: usize, j: usize) -> Option<usize> {
        match self.has_armature(index) || self.carries_several(index) {
            true => None,
            false => self.bodies[index].columns[j].unit_entry(),
        }
    }

    /// The rates of the joint that a body stands for, which are `sought`, into their places, under the acceleration of what it carries without them; and with
    /// them.
    pub(super) fn resolve(
        &self,
        index: usize,
        pivots: &[Pivot],
        base: &Twist,
        (sought, rates): (&'static str, &mut [Sym]),
    ) -> Twist {
        let body = &self.bodies[index];
        let places = body.share.speeds.clone();
        let mut acceleration = base.clone();
        for (j, place) in places.clone().enumerate().rev() {
            let Pivot {
                scaled,
                share,
                later,
            } = &pivots[j];
            let taken: Sym = later
                .iter()
                .zip(&rates[place + 1..places.end])
                .map(|(&factor, &rate)| factor * rate)
                .sum();
            let column = &body.columns[j];
            let Some(entry) = self.feels(index, j) else {
                let rate = *share - base.dot(scaled) - taken;
                rates[place] = rate.named(sought);
                acceleration = acceleration.plus(&column.times(rate));
                continue;
            };
            // Its factor of the base is 1: the rate is what the whole differs by from the base.
            let mut others = base.clone();
            let along = std::mem::replace(others.entry_mut(entry), Sym::zero());
            let whole = *share - others.dot(scaled) - taken;
            rates[place] = (whole - along).named(sought);
            let sum = acceleration.entry_mut(entry);
            *sum = *sum - along + whole;
        }
        acceleration
    }
}
