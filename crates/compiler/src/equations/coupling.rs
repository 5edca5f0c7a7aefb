//! Constraints that couple joints, Theorem 3: `A(Q)ᵀ v̄ = 0` on the speeds of the tree.
//!
//! Some speeds depend on the others: `v̄_d = B v̄ᵢ` with `A_dᵀ B = −Aᵢᵀ`, so that S̄ = [1; B]. Entries of dependent ones are 0 in momenta and rates.

use super::solve::{definite, square};
use super::{Tree, number, wrench_to_parent};
use crate::graph::{Argument, Sym, about, section};
use crate::prune::clean;
use crate::spatial::{Vec3, Wrench, cross, dot};
use num_traits::Zero;

/// The constraints at one configuration.
pub(super) struct Coupling {
    /// Aᵀ, one row a constraint, one column per speed.
    rows: Vec<Vec<Sym>>,
    /// B, one row a dependent, one column an independent speed.
    basis: Vec<Vec<Sym>>,
    dependent: Vec<usize>,
    independent: Vec<usize>,
}

impl Coupling {
    /// Columns of Aᵀ.
    fn columns(rows: &[Vec<Sym>], speeds: &[usize]) -> Vec<Vec<Sym>> {
        let row = |row: &Vec<Sym>| speeds.iter().map(|&speed| row[speed]).collect();
        rows.iter().map(row).collect()
    }

    /// S̄ x.
    fn expand(&self, x: &[Sym]) -> Vec<Sym> {
        let mut whole = self.scatter(x);
        for (row, &speed) in self.basis.iter().zip(&self.dependent) {
            whole[speed] = row.iter().zip(x).map(|(&b, &x)| b * x).sum();
        }
        whole
    }

    /// S̄ᵀ f.
    fn reduce(&self, f: &[Sym]) -> Vec<Sym> {
        let own = self.independent.iter().enumerate();
        own.map(|(j, &speed)| {
            let carried = self.basis.iter().zip(&self.dependent);
            f[speed] + carried.map(|(row, &d)| row[j] * f[d]).sum::<Sym>()
        })
        .collect()
    }

    /// Entries of independent speeds in their places.
    fn scatter(&self, x: &[Sym]) -> Vec<Sym> {
        let mut whole = vec![Sym::zero(); self.dependent.len() + self.independent.len()];
        for (&speed, &x) in self.independent.iter().zip(x) {
            whole[speed] = x;
        }
        whole
    }

    /// Those of independent speeds.
    fn gather(&self, whole: &[Sym]) -> Vec<Sym> {
        self.independent.iter().map(|&speed| whole[speed]).collect()
    }
}

impl Tree<'_> {
    /// Aᵀ, one row a constraint.
    pub fn constraint_rows(&self) -> Vec<Vec<Sym>> {
        let constraints = 0..self.model.coupling.constraints.len();
        let name = |constraint: usize| {
            let own = &self.model.coupling.constraints[constraint];
            format!("constraint `{}`", own.name)
        };
        let row = |constraint: usize| {
            let (body, mut wrench) = self.constraint(constraint);
            let mut row = vec![Sym::zero(); self.model.sizes()[2]];
            for index in self.path(None, body) {
                section(number(index), "constraint");
                let own = &self.bodies[index];
                for (column, place) in own.columns.iter().zip(own.share.speeds.clone()) {
                    row[place] = column.dot(&wrench);
                }
                wrench = wrench_to_parent(&own.steps, &wrench);
            }
            row
        };
        constraints
            .map(|constraint| about(&name(constraint), || row(constraint)))
            .collect()
    }

    /// The body of a constraint, and `(r × d; d)` in its frame: its product with a twist is the forbidden velocity.
    fn constraint(&self, index: usize) -> (usize, Wrench) {
        let constraint = &self.model.coupling.constraints[index];
        let body = constraint.body;
        let arm = self.point(body, &constraint.point);
        let along = self.links[body].body.rotation * constraint.direction.normalize();
        let force = clean(along).map(Sym::from);
        let moment = cross(&arm, &force);
        (body, Wrench { moment, force })
    }

    /// The constraints; `None` where there are none.
    pub(super) fn coupling(&self) -> Option<Coupling> {
        let dependent = self.model.coupling.dependent.clone();
        if dependent.is_empty() {
            return None;
        }
        let rows = self.constraint_rows();
        let speeds = 0..self.model.sizes()[2];
        let independent: Vec<usize> = speeds.filter(|i| !dependent.contains(i)).collect();
        let own = Coupling::columns(&rows, &dependent);
        let mut others = Coupling::columns(&rows, &independent);
        for entry in others.iter_mut().flatten() {
            *entry = -*entry;
        }
        Some(Coupling {
            basis: square(&own, &others),
            rows,
            dependent,
            independent,
        })
    }

    /// v̄ with the dependent speeds that the others make, in place of the argument's.
    pub(super) fn completed_speeds(&self) -> Vec<Sym> {
        let own = |speed| Sym::input(Argument::Speeds, speed);
        match self.coupling() {
            None => (0..self.model.sizes()[2]).map(own).collect(),
            Some(coupling) => {
                let independent = coupling.independent.iter();
                coupling.expand(&independent.map(|&speed| own(speed)).collect::<Vec<_>>())
            }
        }
    }

    /// Whether the joint of each independent speed is driven.
    fn driven(&self, coupling: &Coupling) -> Vec<bool> {
        let independent = coupling.independent.iter();
        independent.map(|&speed| self.is_driven(speed)).collect()
    }

    /// `S̄ᵀ M S̄`.
    fn reduced_mass(&self, coupling: &Coupling) -> Vec<Vec<Sym>> {
        let matrix = self.mass_matrix();
        let units = 0..coupling.independent.len();
        let column = |j: usize| {
            let unit =
                (0..coupling.independent.len()).map(|k| Sym::from(f64::from(u8::from(j == k))));
            let whole = coupling.expand(&unit.collect::<Vec<_>>());
            let product = |row: &Vec<Sym>| row.iter().zip(&whole).map(|(&m, &x)| m * x).sum();
            let product: Vec<Sym> = matrix.iter().map(product).collect();
            coupling.reduce(&product)
        };
        units.map(column).collect()
    }

    /// `(S̄ᵀMS̄)⁻¹ x`; entries of driven joints are `given`, one an independent speed.
    fn solve_reduced(&self, coupling: &Coupling, mut x: Vec<Sym>, given: &[Sym]) -> Vec<Sym> {
        let mut matrix = self.reduced_mass(coupling);
        for (j, _) in self
            .driven(coupling)
            .iter()
            .enumerate()
            .filter(|(_, driven)| **driven)
        {
            for k in 0..x.len() {
                let less = matrix[k][j] * given[j];
                x[k] -= less;
                matrix[k][j] = Sym::zero();
                matrix[j][k] = Sym::zero();
            }
            matrix[j][j] = Sym::Number(1.0);
            x[j] = given[j];
        }
        definite(matrix, x)
    }

    /// v̄̇ under τ.
    pub fn coupled_accelerations(&self) -> Vec<Sym> {
        let Some(coupling) = &self.coupling() else {
            return vec![];
        };
        let count = self.model.sizes()[2];
        let mut known = vec![Sym::zero(); count];
        for (index, body) in self.joints() {
            if let Some(given) = self.prescribed(index, Argument::Efforts) {
                known[body.share.speeds.clone()].copy_from_slice(&given);
            }
        }
        let asked: Vec<Vec<Sym>> = self
            .velocity_products()
            .iter()
            .zip(&coupling.rows)
            .map(|(&product, row)| {
                let carried = row.iter().zip(&known).map(|(&a, &rate)| a * rate);
                vec![-product - carried.sum::<Sym>()]
            })
            .collect();
        let own = Coupling::columns(&coupling.rows, &coupling.dependent);
        let dependent = square(&own, &asked);
        for (&speed, rate) in coupling.dependent.iter().zip(&dependent) {
            known[speed] = rate[0];
        }
        let mut needed = self.inverse_dynamics(Some(&known));
        for (index, body) in self.joints() {
            section(number(index), "effort");
            let efforts = self.efforts(index, Some(Argument::Efforts));
            for (place, effort) in body.share.speeds.clone().zip(efforts) {
                needed[place] = effort - needed[place];
            }
        }
        let still = vec![Sym::zero(); coupling.independent.len()];
        let solved = self.solve_reduced(coupling, coupling.reduce(&needed), &still);
        let known = coupling.gather(&known).into_iter().zip(solved);
        let rates: Vec<Sym> = known
            .map(|(known, more)| (known + more).named("acceleration"))
            .collect();
        coupling.scatter(&rates)
    }

    /// `Ȧᵀ v̄` of each constraint: `d · a_P + (ω × d) · v_P` at v̄̇ = 0.
    fn velocity_products(&self) -> Vec<Sym> {
        let (spins, linear) = self.accelerations(None, &Vec3::zeros());
        let (twists, _) = self.motions();
        let product = |index: usize| {
            let (body, Wrench { force: along, .. }) = self.constraint(index);
            section(number(body), "constraint");
            let arm = self.point(body, &self.model.coupling.constraints[index].point);
            let omega = &twists[body].angular;
            let velocity = twists[body].linear + cross(omega, &arm);
            dot(&along, &(linear[body] + spins[body].at(&arm)))
                + dot(&cross(omega, &along), &velocity)
        };
        (0..self.model.coupling.constraints.len())
            .map(product)
            .collect()
    }

    /// p̄ of independent speeds from the momenta of the tree.
    pub(super) fn coupled_momenta(&self, coupling: &Coupling, momenta: &[Sym]) -> Vec<Sym> {
        coupling.scatter(&coupling.reduce(momenta))
    }

    /// All speeds with S̄ᵀMS̄ v̄ᵢ = p̄, the argument.
    pub fn coupled_speeds(&self) -> Vec<Sym> {
        let Some(coupling) = &self.coupling() else {
            return vec![];
        };
        let momenta = |&speed: &usize| Sym::input(Argument::Momenta, speed);
        let momenta: Vec<Sym> = coupling.independent.iter().map(momenta).collect();
        coupling.expand(&self.solve_reduced(coupling, momenta.clone(), &momenta))
    }

    /// What the change of S̄ adds to momentum and wrench of each body: `S̄̇ᵀp = −S̄ᵀȦμ` with `A_d μ = p_d`, and Ȧμ obeys the recursion of
    /// the momenta, with `−Σ μ F` in place of G V.
    pub(super) fn coupling_wrenches(
        &self,
        coupling: &Coupling,
        momenta: &[Sym],
    ) -> Vec<(usize, Wrench)> {
        let own = Coupling::columns(&coupling.rows, &coupling.dependent);
        let transposed: Vec<Vec<Sym>> = (0..own.len())
            .map(|j| own.iter().map(|row| row[j]).collect())
            .collect();
        let right: Vec<Vec<Sym>> = coupling
            .dependent
            .iter()
            .map(|&speed| vec![momenta[speed]])
            .collect();
        let multipliers = square(&transposed, &right);
        let each = multipliers.iter().enumerate();
        each.map(|(index, multiplier)| {
            let (body, wrench) = self.constraint(index);
            (body, wrench.times(multiplier[0]))
        })
        .collect()
    }
}
