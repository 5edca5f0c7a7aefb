//! Derivatives of the port-Hamiltonian form where constraints couple joints, Theorem 3 in full.
//!
//! p̄ and p̄̇ are what the constraints leave of the tree's: with multipliers that bring the entries of the dependent speeds to 0,
//!
//! ```text
//! p̄ = M v̄ − A μ      p̄̇ = G − A ν      Aᵀ v̄ = 0
//! ```
//!
//! where G, the rates of the tree, holds `−Ȧμ`: the wrenches F of the constraints are constant in their bodies, so that `−μF` is a momentum on the body
//! beside its own, which `μ ad_Vᵀ F` holds in place. At fixed v̄, μ and ν all of this changes with ϕ as it does in the tree, when the composite momenta h
//! hold `−μF`, and the composite wrenches f hold `μ ad_Vᵀ F − νF`. Only U, which moves V and so turns `μ ad_Vᵀ F`, adds `ad_Uᵀ m` to δf, with `m = Σ μF`
//! of the bodies that the joint carries: it meets `h + m`, the momenta of the tree alone, wherever it met h. With `r = ∂(M v̄ − Aμ)/∂ϕ`,
//!
//! ```text
//! M δv̄ − A δμ = δp̄ − r      Aᵀ δv̄ = −Fᵀ U
//! δp̄̇ = S̄ᵀ (∂(G − Aν)/∂ϕ + ∂G/∂v̄ δv̄ − Ȧ δμ)
//! ```
//!
//! as S̄ᵀA = 0 leaves δν out. The first line is that of forward dynamics ([`super::coupled`]); δμ follows from its dependent rows. Momenta of prescribed
//! speeds are these speeds.

use super::Sensitivity;
use super::hamiltonian::HamiltonianDerivatives;
use crate::dynamics::DynamicsError;
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::coupling::Coupling;
use crate::mechanism::Mechanism;
use crate::spatial::{bracket_dual_product, shift_wrench};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector6;

/// Workspace, and what changes on the way.
#[derive(Clone, Debug)]
pub(super) struct CoupledMomenta {
    /// `Fᵀ U`: a row a constraint, a column a degree of freedom.
    slipping: Sensitivity,
    /// `Ȧᵀ`: a row a constraint, a column a speed.
    turning: Sensitivity,
    /// The rows of M of the dependent speeds.
    mass: Sensitivity,
    /// μ, later δμ.
    multipliers: Vec<f64>,
    /// ν, later the dependent entries of δv̄ that `−Fᵀ U` asks for.
    dependent: Vec<f64>,
    /// r − δp̄ of one column, one entry per speed.
    asked: Vec<f64>,
    /// δv̄.
    faster: Vec<f64>,
    /// δp̄̇.
    rates: Vec<f64>,
    /// Entries of independent speeds.
    reduced: Vec<f64>,
}

impl CoupledMomenta {
    /// `None` for a mechanism without constraints.
    pub(super) fn new(mechanism: &Mechanism) -> Option<Self> {
        let (count, layout) = (mechanism.constraints().len(), mechanism.layout());
        let (speeds, freedoms) = (layout.speeds, layout.freedoms);
        (count > 0).then(|| Self {
            slipping: Sensitivity::new(count, freedoms),
            turning: Sensitivity::new(count, speeds),
            mass: Sensitivity::new(count, speeds),
            multipliers: vec![0.0; count],
            dependent: vec![0.0; count],
            asked: vec![0.0; speeds],
            faster: vec![0.0; speeds],
            rates: vec![0.0; speeds],
            reduced: vec![0.0; speeds - count],
        })
    }

    /// The number of constraints that it has room for.
    pub(super) const fn room(&self) -> usize {
        self.slipping.rows()
    }

    /// δv̄ and δp̄̇ for r − δp̄ in `asked`, what the constraints ask in `dependent`, and the tree's own δp̄̇ in `rates`; `prescribed` is a driven speed
    /// whose entry of δv̄ is 1.
    fn answer(
        &mut self,
        coupling: &mut Coupling,
        rates_by_speeds: &Sensitivity,
        prescribed: Option<usize>,
    ) {
        coupling.solve_dependent(&mut self.dependent);
        coupling.answer(&self.asked, &self.dependent, prescribed, &mut self.reduced);
        coupling.expand(|j| self.reduced[j], &mut self.faster);
        for (&speed, value) in coupling.dependent.iter().zip(&self.dependent) {
            self.faster[speed] += value;
        }
        for (row, value) in self.multipliers.iter_mut().enumerate() {
            let moved = product(self.mass.row(row), &self.faster);
            *value = self.asked[coupling.dependent[row]] + moved;
        }
        coupling.solve_multipliers(&mut self.multipliers);
        for (row, rate) in self.rates.iter_mut().enumerate() {
            *rate += product(rates_by_speeds.row(row), &self.faster);
        }
        for (row, multiplier) in self.multipliers.iter().enumerate() {
            for (rate, turning) in self.rates.iter_mut().zip(self.turning.row(row)) {
                *rate -= turning * multiplier;
            }
        }
        self.reduce(coupling);
    }

    /// `S̄ᵀ` of `rates`, in place, with 0 for the dependent ones.
    fn reduce(&mut self, coupling: &Coupling) {
        coupling.reduce(&self.rates, &mut self.reduced);
        coupling.scatter(&self.reduced, &mut self.rates);
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Recursive {
    /// The derivatives at (q, p̄, τ) after v̄ has been found.
    pub(super) fn differentiate_coupled_momenta(
        &mut self,
        q: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) -> Result<(), DynamicsError> {
        let mut work = out.coupled.take().ok_or(DynamicsError::ForeignResults)?;
        self.with_coupling(|dynamics, coupling| {
            dynamics.carry_multipliers(q, efforts, coupling, &mut work, out);
            out.coupled = Some(work);
            dynamics.vary_momenta(q, out);
            out.rates_by_efforts.clear();
            dynamics.differentiate_tree_rates(q, efforts, out);
            dynamics.ask_momenta(coupling, out);
            dynamics.answer_momenta(coupling, out);
            dynamics.obey_drives(out);
        });
        Ok(())
    }

    /// μ and ν, and the composite momenta and wrenches that hold them; m into `out`.
    fn carry_multipliers(
        &mut self,
        q: &[f64],
        efforts: &[f64],
        coupling: &mut Coupling,
        work: &mut CoupledMomenta,
        out: &mut HamiltonianDerivatives,
    ) {
        for (row, &speed) in coupling.dependent.iter().enumerate() {
            work.faster.fill(0.0);
            work.faster[speed] = 1.0;
            self.tree_momenta(&work.faster, work.mass.row_mut(row));
        }
        self.advance(q, &out.speeds, None);
        if self.acted_on {
            self.act_and_vary((q, &out.speeds), None, &mut out.acting);
        }
        self.act(q, &out.speeds, Some(efforts));
        self.coupled_rates(q, &out.speeds, &mut work.rates, coupling);
        let (multipliers, rates) = coupling.momentum_multipliers();
        work.multipliers.copy_from_slice(multipliers);
        for (value, &speed) in work.dependent.iter_mut().zip(&coupling.dependent) {
            *value = rates[speed];
        }
        coupling.solve_multipliers(&mut work.dependent);
        out.carried.fill(Vector6::zeros());
        let weights = work.multipliers.iter().zip(&work.dependent);
        for ((body, mut wrench), (mu, nu)) in coupling.wrenches().zip(weights) {
            let mut next = Some(body);
            while let Some(body) = next {
                let node = &mut self.nodes[body];
                node.motion.rate -= wrench * *nu;
                out.carried[body] += wrench * *mu;
                wrench = shift_wrench(&wrench, &node.motion.placement.offset);
                next = self.links[body].parent;
            }
        }
    }

    /// `Fᵀ U` and `Ȧᵀ`, from the constrained bodies to the root.
    fn ask_momenta(&self, coupling: &Coupling, out: &mut HamiltonianDerivatives) {
        let (moving, variations) = (&out.moving, &out.variations);
        let Some(work) = &mut out.coupled else {
            return;
        };
        work.slipping.clear();
        work.turning.clear();
        for (row, (body, mut wrench)) in coupling.wrenches().enumerate() {
            let mut turned = -bracket_dual_product(&self.nodes[body].motion.twist, &wrench);
            let mut next = Some(body);
            while let Some(body) = next {
                let link = &self.links[body];
                let own = &variations[link.variations.clone()];
                for (slot, variation) in link.freedoms.clone().zip(own) {
                    let slipped = wrench.dot(&variation.drift);
                    work.slipping.set(row, slot, slipped);
                }
                for (speed, own) in link.speeds.clone().zip(link.columns.clone()) {
                    let entry = moving[own][0].dot(&wrench) + self.columns[own].dot(&turned);
                    work.turning.set(row, speed, entry);
                }
                let offset = &self.nodes[body].motion.placement.offset;
                wrench = shift_wrench(&wrench, offset);
                turned = shift_wrench(&turned, offset);
                next = link.parent;
            }
        }
    }

    /// One unit of each ϕ, each momentum that stands for itself, and each effort.
    fn answer_momenta(&self, coupling: &mut Coupling, out: &mut HamiltonianDerivatives) {
        let Some(work) = &mut out.coupled else {
            return;
        };
        for slot in 0..out.rates_by_local.columns() {
            for (row, value) in work.dependent.iter_mut().enumerate() {
                *value = -work.slipping.entry(row, slot);
            }
            if let Some(needed) = &out.needed {
                needed.copy_column(slot, &mut work.asked);
            }
            out.rates_by_local.copy_column(slot, &mut work.rates);
            work.answer(coupling, &out.rates_by_speeds, None);
            out.speeds_by_local.set_column(slot, &work.faster);
            out.rates_by_local.set_column(slot, &work.rates);
        }
        out.speeds_by_momenta.clear();
        out.rates_by_momenta.clear();
        for link in self.links.iter().filter(|link| link.leads) {
            for speed in link.speeds.clone() {
                if coupling.dependent.contains(&speed) {
                    continue;
                }
                work.dependent.fill(0.0);
                work.asked.fill(0.0);
                work.rates.fill(0.0);
                if !link.driven {
                    work.asked[speed] = -1.0;
                }
                let prescribed = link.driven.then_some(speed);
                work.answer(coupling, &out.rates_by_speeds, prescribed);
                out.speeds_by_momenta.set_column(speed, &work.faster);
                out.rates_by_momenta.set_column(speed, &work.rates);
            }
        }
        for slot in 0..out.rates_by_efforts.columns() {
            out.rates_by_efforts.copy_column(slot, &mut work.rates);
            work.reduce(coupling);
            out.rates_by_efforts.set_column(slot, &work.rates);
        }
    }
}
