//! Derivatives of forward dynamics: `−M̄⁻¹` times what ϕ and v̄ change of the efforts that v̄̇ takes, with M̄ factorised along the tree.

use super::composite::{Factors, Matrix, hold};
use super::derivatives::unit;
use super::{Tree, number};
use crate::graph::{Argument, Slopes, Sym, section};
use num_traits::Zero;

impl Tree<'_> {
    /// By rows, one per speed: `∂v̄̇/∂ϕ`, `∂v̄̇/∂v̄`, `∂v̄̇/∂τ` and v̄̇.
    pub fn forward_derivatives(&self) -> Vec<Sym> {
        let rates = self.composite_accelerations();
        let needed = self.needed_slopes(&rates, Some(Argument::Efforts));
        let matrix = self.mass_matrix();
        let factors = self.held_factors(matrix.clone());
        let [_, freedoms, speeds] = self.model.sizes();
        let given = (0..freedoms + speeds).map(|place| {
            let row = |speed: usize| match self.is_driven(speed) {
                true => Sym::zero(),
                false => -needed[speed][place],
            };
            factors.solve((0..speeds).map(row).collect(), "slope")
        });
        let mut columns: Vec<Vec<Sym>> = given.collect();
        for (place, speed, rate) in self.followed_variations(&rates) {
            columns[place][speed] += rate;
        }
        columns.extend(self.effort_columns(&matrix, &factors));
        columns.push(rates);
        by_rows(&columns, speeds)
    }

    /// The same where constraints couple joints, and then `∂v̄/∂ϕ` and `∂v̄/∂v̄` of the speeds that they complete: dependent speeds follow the others.
    pub fn coupled_derivatives(&self) -> Vec<Sym> {
        let speeds = self.completed_speeds();
        let moving = Tree::at(self.model, self.links.clone(), &speeds);
        let rates = moving.coupled_accelerations();
        let slopes = Slopes::new(rates.clone());
        let mut columns = self.along_state(&slopes);
        columns.extend(self.along_efforts(&slopes));
        columns.push(rates);
        let count = speeds.len();
        columns.extend(self.along_state(&Slopes::new(speeds)));
        by_rows(&columns, count)
    }

    /// M̄⁻¹ by rows; those of driven joints are 0.
    pub fn inverse_mass_matrix(&self) -> Vec<Sym> {
        let mut inverse = self.held_factors(self.mass_matrix()).inverse();
        for place in (0..inverse.len()).filter(|&place| self.is_driven(place)) {
            inverse[place].fill(Sym::zero());
        }
        inverse.concat()
    }

    /// The factors of M̄ where driven joints do not give way.
    pub(super) fn held_factors(&self, mut matrix: Matrix) -> Factors {
        for place in (0..matrix.len()).filter(|&place| self.is_driven(place)) {
            hold(&mut matrix, place);
        }
        self.factorised(matrix)
    }

    /// `∂v̄̇/∂τ = M̄⁻¹ S̄ᵀ`, a column a degree of freedom; the first efforts of a driven joint are its rates.
    fn effort_columns(&self, matrix: &Matrix, factors: &Factors) -> Vec<Vec<Sym>> {
        let inverse = factors.inverse();
        let size = inverse.len();
        let mut columns = vec![];
        for (index, body) in self.joints() {
            section(number(index), "response");
            let places = body.share.speeds.clone();
            for (b, basis) in body.basis.iter().enumerate() {
                let driven = self.model.bodies[index].driven;
                columns.push(match places.clone().nth(b) {
                    Some(place) if driven => self.followed(matrix, factors, place),
                    None if driven => vec![Sym::zero(); size],
                    _ => {
                        let entry = |row: usize| {
                            let own = basis.iter().zip(places.clone());
                            own.map(|(&s, place)| s * inverse[row][place]).sum()
                        };
                        (0..size).map(entry).collect()
                    }
                });
            }
        }
        columns
    }

    /// What the other speeds' rates answer to one unit of a driven one's.
    fn followed(&self, matrix: &Matrix, factors: &Factors, driven: usize) -> Vec<Sym> {
        let pushed = matrix
            .iter()
            .enumerate()
            .map(|(speed, row)| match self.is_driven(speed) {
                true => unit(speed == driven),
                false => -row[driven],
            });
        factors.solve(pushed.collect(), "slope")
    }

    /// Columns of derivatives in all efforts.
    fn along_efforts(&self, values: &Slopes) -> Vec<Vec<Sym>> {
        let each = self.joints().flat_map(|(index, body)| {
            let own = body.share.freedoms.clone();
            own.map(move |freedom| (index, freedom))
        });
        let column = |(index, freedom): (usize, usize)| {
            section(number(index), "slope");
            values.along(|argument, place| unit((argument, place) == (Argument::Efforts, freedom)))
        };
        each.map(column).collect()
    }

    /// Whether a speed's rate is prescribed.
    pub(super) fn is_driven(&self, speed: usize) -> bool {
        let mut bodies = self.bodies.iter().zip(&self.model.bodies);
        bodies.any(|(placed, body)| body.driven && placed.share.speeds.contains(&speed))
    }
}

/// The entries of columns, row by row.
fn by_rows(columns: &[Vec<Sym>], rows: usize) -> Vec<Sym> {
    let row = |row: usize| columns.iter().map(move |column| column[row]);
    (0..rows).flat_map(row).collect()
}
