//! A mechanism at a random state, and the formulas in question, right and wrong.

use chacha20::ChaCha8Rng;
use hamel::dynamics::reference::Expansion;
use hamel::dynamics::{Recursive, Reference};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::{Cholesky, DMatrix, DVector};
use hamel_tests::random::{configuration, numbers};
use rand::SeedableRng;
use std::sync::Arc;

/// A mechanism at a random state.
pub struct Point {
    pub mechanism: Arc<Mechanism>,
    pub expansion: Expansion,
    q: Vec<f64>,
    speeds: DVector<f64>,
    rates: DVector<f64>,
}

impl Point {
    pub fn new(mechanism: &Arc<Mechanism>, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let q = configuration(&mut random, mechanism);
        let size = mechanism.layout().speeds;
        Self {
            expansion: Reference::new(Arc::clone(mechanism))
                .expansion(&q)
                .expect("sizes fit"),
            speeds: DVector::from_vec(numbers(&mut random, size)) * 2.0,
            rates: DVector::from_vec(numbers(&mut random, size)),
            mechanism: Arc::clone(mechanism),
            q,
        }
    }

    pub fn v(&self) -> DVector<f64> {
        &self.expansion.speed_basis * &self.speeds
    }

    /// S̄ᵀτ by Newton–Euler.
    fn efforts(&self, rates: &DVector<f64>) -> DVector<f64> {
        let mut efforts = DVector::zeros(rates.len());
        Recursive::new(Arc::clone(&self.mechanism))
            .inverse_dynamics(
                &self.q,
                self.speeds.as_slice(),
                rates.as_slice(),
                efforts.as_mut_slice(),
            )
            .expect("sizes fit");
        efforts
    }

    /// How far `M̄ v̄̇ + S̄ᵀ(M S̄̇ + Ĉ S̄) v̄ + S̄ᵀN̂` is from Newton–Euler with this Ĉ, relative to the largest term.
    pub fn lagrangian_error(&self, coriolis: &DMatrix<f64>) -> f64 {
        let Expansion {
            mass_matrix,
            speed_basis,
            ..
        } = &self.expansion;
        let change =
            mass_matrix * self.expansion.speed_basis_rate(&self.speeds) + coriolis * speed_basis;
        let terms = [
            self.expansion.reduced_mass_matrix() * &self.rates,
            speed_basis.tr_mul(&(change * &self.speeds)),
            self.expansion.reduced_potential_forces(),
        ];
        let found: DVector<f64> = terms.iter().sum();
        let largest = terms.iter().map(|term| term.amax()).fold(0.0, f64::max);
        (found - self.efforts(&self.rates)).amax() / largest
    }

    /// (26), its last sum replaced by `Σ_j last(i, j)`.
    fn coriolis(&self, last: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        let (expansion, v) = (&self.expansion, self.v());
        let size = v.len();
        let slopes = DMatrix::from_fn(size, size, |k, j| {
            (&expansion.mass_matrix_gradient[k] * &v)[j]
        });
        let first =
            expansion.mass_matrix_rate(&v) - expansion.velocity_map_inverse.tr_mul(&slopes) * 0.5;
        first + DMatrix::from_fn(size, size, last)
    }

    /// The last sum of (26) as (17) requires it: `Σ S⁻¹_mi (∂S_km/∂ϕ_s − ∂S_ks/∂ϕ_m) S⁻¹_sj p_k`.
    pub fn corrected(&self) -> DMatrix<f64> {
        let (p, inverse) = (
            &self.expansion.mass_matrix * self.v(),
            &self.expansion.velocity_map_inverse,
        );
        self.coriolis(|i, j| {
            self.sum(|k, m, s| inverse[(m, i)] * self.curl(k, m, s) * inverse[(s, j)] * p[k])
        })
    }

    /// The last sum of (26) as it is printed: `Σ S⁻¹_mi (∂S_jm/∂ϕ_s − ∂S_js/∂ϕ_m) S⁻¹_sk p_k`.
    pub fn printed(&self) -> DMatrix<f64> {
        let (p, inverse) = (
            &self.expansion.mass_matrix * self.v(),
            &self.expansion.velocity_map_inverse,
        );
        self.coriolis(|i, j| {
            self.sum(|k, m, s| inverse[(m, i)] * self.curl(j, m, s) * inverse[(s, k)] * p[k])
        })
    }

    /// `∂S_am/∂ϕ_s − ∂S_as/∂ϕ_m`.
    fn curl(&self, a: usize, m: usize, s: usize) -> f64 {
        let gradient = &self.expansion.velocity_map_gradient;
        gradient[s][(a, m)] - gradient[m][(a, s)]
    }

    fn sum(&self, term: impl Fn(usize, usize, usize) -> f64) -> f64 {
        let size = self.expansion.mass_matrix.nrows();
        let term = &term;
        let all = (0..size).flat_map(|k| (0..size).map(move |m| (k, m)));
        all.map(|(k, m)| (0..size).map(|s| term(k, m, s)).sum::<f64>())
            .sum()
    }

    /// The same point with `S(Q, ϕ) ≡ I` for planar joints and carts, as Example 6 has it.
    pub fn with_constant_planar_maps(&self) -> Self {
        let mut expansion = self.expansion.clone();
        for body in self.mechanism.bodies() {
            if ["planar", "cart"].contains(&body.joint().name()) {
                for k in body.ranges().freedoms.clone() {
                    expansion.velocity_map_gradient[k].fill(0.0);
                }
            }
        }
        Self {
            mechanism: Arc::clone(&self.mechanism),
            expansion,
            q: self.q.clone(),
            speeds: self.speeds.clone(),
            rates: self.rates.clone(),
        }
    }

    /// p̄̇ of (35) without applied efforts, with J̄22 of (36) taken at the momentum `p`.
    fn momentum_rate(&self, p: &DVector<f64>) -> DVector<f64> {
        let Expansion {
            speed_basis,
            velocity_map_inverse,
            speed_basis_gradient,
            ..
        } = &self.expansion;
        let columns: Vec<DVector<f64>> = speed_basis_gradient
            .iter()
            .map(|slice| slice.tr_mul(p))
            .collect();
        let turn = DMatrix::from_columns(&columns) * velocity_map_inverse * speed_basis;
        let j22 =
            speed_basis.tr_mul(&(self.expansion.j22(p) * speed_basis)) + &turn - turn.transpose();
        let gradient = self.expansion.reduced_hamiltonian_gradient(&self.speeds);
        j22 * &self.speeds - speed_basis.tr_mul(&velocity_map_inverse.tr_mul(&gradient))
    }

    /// What efforts Newton–Euler needs for the motion with this p̄̇, relative to the largest term; none are applied.
    pub fn hamiltonian_error(&self, p: &DVector<f64>) -> f64 {
        let Expansion {
            mass_matrix,
            speed_basis,
            ..
        } = &self.expansion;
        let half = self
            .expansion
            .speed_basis_rate(&self.speeds)
            .tr_mul(&(mass_matrix * speed_basis));
        let whole = speed_basis.tr_mul(&(self.expansion.mass_matrix_rate(&self.v()) * speed_basis));
        let change = (whole + &half + half.transpose()) * &self.speeds;
        let rate = self.momentum_rate(p);
        let mass = self.expansion.reduced_mass_matrix();
        let factors = Cholesky::new(mass).expect("every body has mass");
        let efforts = self.efforts(&factors.solve(&(&rate - &change)));
        efforts.amax() / rate.amax().max(change.amax())
    }
}
