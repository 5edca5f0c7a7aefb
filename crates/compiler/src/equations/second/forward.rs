//! Second derivatives of forward dynamics.
//!
//! Forward dynamics is `ID(x, v̄̇) = S̄ᵀτ`. With `M̄ μ = λ` and H of `μᵀ(ID − S̄ᵀτ)`, in which v̄̇ enters linearly,
//!
//! ```text
//! λᵀ∂²v̄̇ = −(H_xx + H_xa v̄̇_x + v̄̇_xᵀ H_ax)        v̄̇_x = −M̄⁻¹ ID_x
//! ```
//!
//! over x = (ϕ, v̄, τ). H_xa has rows of ϕ alone. `G = H_ϕa M̄⁻¹` is solved for once, and multiplied with ID_x, which has the zeros of the tree: v̄̇_x itself, which
//! has none, is not needed.

use super::hessian::Hessian;
use crate::equations::Tree;
use crate::equations::composite::{Factors, Matrix};
use crate::equations::derivatives::Rows;
use crate::graph::{Argument, Sym, put};
use num_traits::Zero;

impl Tree<'_> {
    /// λᵀ∂²v̄̇ of forward dynamics: by rows, over (ϕ, v̄, τ). Where constraints couple joints it has no value.
    pub fn forward_second_derivatives(&self) -> Vec<Sym> {
        if !self.model.coupling.constraints.is_empty() {
            let [_, freedoms, speeds] = self.model.sizes();
            let size = 2 * freedoms + speeds;
            return vec![Sym::Number(f64::NAN); size * size];
        }
        let rates = self.composite_accelerations();
        let matrix = self.mass_matrix();
        let factors = self.held_factors(matrix.clone());
        let weights = self.virtual_speeds().into_iter().enumerate();
        let weights = weights.map(|(speed, own)| self.where_free(speed, own));
        let virtual_speeds = factors.solve(weights.collect(), "virtual_speed");
        let mut hessian = self.contracted(Some(Argument::Efforts));
        let mut needed = self.needed_slopes(&self.given_rates(), Some(Argument::Efforts));
        replace(
            &mut hessian,
            &mut needed,
            |argument, place| match argument {
                Argument::Accelerations => Some(rates[place]),
                Argument::Weights => Some(virtual_speeds[place]),
                _ => None,
            },
        );
        let solved: Vec<Vec<Sym>> = (0..self.model.sizes()[1])
            .map(|local| self.solved_rates(local, &hessian, &factors))
            .collect();
        let products = solved.iter().enumerate().map(|(local, row)| {
            let mut products = self.of_state(row, &needed);
            for (place, speed, rate) in self.followed_variations(&rates) {
                products[place] += hessian.entry(local, hessian.of_rate(speed)) * rate;
            }
            products.extend(self.of_efforts((local, row), &matrix, &hessian));
            products
        });
        let products: Rows = products.collect();
        self.combined(&hessian, &products)
    }

    /// A value of a speed, 0 where that is prescribed.
    fn where_free(&self, speed: usize, value: Sym) -> Sym {
        match self.is_driven(speed) {
            true => Sym::zero(),
            false => value,
        }
    }

    /// A row of G.
    fn solved_rates(&self, local: usize, hessian: &Hessian, factors: &Factors) -> Vec<Sym> {
        let speeds = 0..self.model.sizes()[2];
        let row = speeds.map(|speed| {
            let entry = hessian.entry(local, hessian.of_rate(speed));
            self.where_free(speed, entry)
        });
        factors.solve(row.collect(), "slope")
    }

    /// A row of `H_ϕa v̄̇_x` by ϕ and v̄, from that of G.
    fn of_state(&self, row: &[Sym], needed: &Rows) -> Vec<Sym> {
        let width = needed.first().map_or(0, Vec::len);
        let entry = |x: usize| {
            let terms = row.iter().zip(needed);
            -terms.map(|(&own, needed)| own * needed[x]).sum::<Sym>()
        };
        (0..width).map(entry).collect()
    }

    /// The same by τ: the first efforts of a driven joint are its rates.
    fn of_efforts(
        &self,
        (local, row): (usize, &[Sym]),
        matrix: &Matrix,
        hessian: &Hessian,
    ) -> Vec<Sym> {
        let mut entries = vec![];
        for (index, body) in self.joints() {
            let places = body.share.speeds.clone();
            for (b, basis) in body.basis.iter().enumerate() {
                let driven = self.model.bodies[index].driven;
                entries.push(match places.clone().nth(b) {
                    Some(place) if driven => {
                        let given = hessian.entry(local, hessian.of_rate(place));
                        let terms = row.iter().zip(matrix).enumerate();
                        let answers =
                            terms.map(|(i, (&own, of))| self.where_free(i, own * of[place]));
                        given - answers.sum::<Sym>()
                    }
                    None if driven => Sym::zero(),
                    _ => {
                        let terms = basis.iter().zip(places.clone());
                        terms.map(|(&s, place)| s * row[place]).sum()
                    }
                });
            }
        }
        entries
    }

    /// `−(H_xx + H_xa v̄̇_x + v̄̇_xᵀ H_ax)` by rows, from the products by ϕ and x.
    fn combined(&self, hessian: &Hessian, products: &Rows) -> Vec<Sym> {
        let [_, freedoms, speeds] = self.model.sizes();
        let known = hessian
            .of_state()
            .chain((0..freedoms).map(|b| hessian.of_effort(b)));
        let known: Vec<usize> = known.collect();
        let product = |row: usize, column: usize| {
            let row = products.get(row).map(|row| row[column]);
            row.unwrap_or_else(Sym::zero)
        };
        let entry = |i: usize, j: usize| {
            let both = product(i, j) + product(j, i);
            -(hessian.entry(known[i], known[j]) + both)
        };
        let size = 2 * freedoms + speeds;
        let row = |i: usize| (0..size).map(move |j| (i, j));
        let places = (0..size).flat_map(row);
        places.map(|(i, j)| entry(i.min(j), i.max(j))).collect()
    }
}

/// Puts values in the place of inputs.
fn replace(
    hessian: &mut Hessian,
    needed: &mut Rows,
    other: impl Fn(Argument, usize) -> Option<Sym>,
) {
    let places = hessian.entries_mut().chain(needed.iter_mut().flatten());
    let mut places: Vec<&mut Sym> = places.collect();
    let values: Vec<Sym> = places.iter().map(|place| **place).collect();
    for (place, value) in places.iter_mut().zip(put(&values, other)) {
        **place = value;
    }
}
