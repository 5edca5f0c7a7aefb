//! One rigid body on one holonomic joint, without gravity: equations of motion that cost little, for a million steps.
//!
//! In the body's frame `V = X^c v` and `h = G V`; then `M v̇ = τ − X^cᵀ(G c − ad_Vᵀ h)` and `ṗ = τ + X^cᵀ ad_Vᵀ h + Ẋ^cᵀ h`.

use hamel::dynamics::{
    Dynamics, DynamicsError, ForwardDerivatives, HamiltonianDerivatives, Recursive,
};
use hamel::mechanism::{Body, Mechanism};
use hamel::nalgebra::{Cholesky, SMatrix, SVector, Vector6};
use hamel::spatial::bracket_dual_product;
use std::sync::Arc;

/// The equations of motion of a mechanism of one body on a joint of `K` degrees of freedom.
pub struct OneBody<const K: usize> {
    mechanism: Arc<Mechanism>,
}

/// What both forms need at one state.
struct Terms<const K: usize> {
    twist_map: SMatrix<f64, 6, K>,
    factors: Cholesky<f64, hamel::nalgebra::Const<K>>,
    mass: SMatrix<f64, K, K>,
}

impl<const K: usize> OneBody<K> {
    pub fn new(mechanism: Arc<Mechanism>) -> Self {
        assert_eq!(mechanism.bodies().len(), 1);
        assert_eq!(mechanism.layout().speeds, K);
        Self { mechanism }
    }

    fn body(&self) -> &Body {
        &self.mechanism.bodies()[0]
    }

    fn terms(&self, q: &[f64]) -> Terms<K> {
        let mut twist_map = SMatrix::<f64, 6, K>::zeros();
        self.body()
            .joint()
            .twist_map_child(q, twist_map.as_mut_slice());
        let mass = twist_map.tr_mul(&(self.body().joint_inertia().matrix() * twist_map));
        let factors = Cholesky::new(mass).expect("the body has mass in every direction");
        Terms {
            twist_map,
            factors,
            mass,
        }
    }

    /// V and h = G V.
    fn motion(&self, terms: &Terms<K>, v: &SVector<f64, K>) -> (Vector6<f64>, Vector6<f64>) {
        let twist = terms.twist_map * v;
        (twist, self.body().joint_inertia().apply(&twist))
    }
}

fn vector<const K: usize>(slice: &[f64]) -> SVector<f64, K> {
    SVector::from_column_slice(slice)
}

impl<const K: usize> Dynamics for OneBody<K> {
    fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    fn complete_speeds(&mut self, _q: &[f64], _speeds: &mut [f64]) -> Result<(), DynamicsError> {
        Ok(())
    }

    fn forward_dynamics(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let terms = self.terms(q);
        let (twist, momentum) = self.motion(&terms, &vector(speeds));
        let bias = self.body().joint().bias_acceleration(q, speeds);
        let wrench =
            self.body().joint_inertia().apply(&bias) - bracket_dual_product(&twist, &momentum);
        let forces = vector::<K>(efforts) - terms.twist_map.tr_mul(&wrench);
        rates.copy_from_slice(terms.factors.solve(&forces).as_slice());
        Ok(())
    }

    fn momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
    ) -> Result<(), DynamicsError> {
        momenta.copy_from_slice((self.terms(q).mass * vector::<K>(speeds)).as_slice());
        Ok(())
    }

    fn speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        speeds.copy_from_slice(
            self.terms(q)
                .factors
                .solve(&vector::<K>(momenta))
                .as_slice(),
        );
        Ok(())
    }

    fn momentum_rates(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &mut dyn FnMut(&[f64], &mut [f64]),
        speeds: &mut [f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let terms = self.terms(q);
        let v = terms.factors.solve(&vector::<K>(momenta));
        speeds.copy_from_slice(v.as_slice());
        let mut tau = SVector::<f64, K>::zeros();
        efforts(speeds, tau.as_mut_slice());
        let (twist, momentum) = self.motion(&terms, &v);
        let mut bias = SVector::<f64, K>::zeros();
        self.body()
            .joint()
            .bias_momentum(q, speeds, &momentum, bias.as_mut_slice());
        let rate = tau
            + terms
                .twist_map
                .tr_mul(&bracket_dual_product(&twist, &momentum))
            + bias;
        rates.copy_from_slice(rate.as_slice());
        Ok(())
    }

    fn hamiltonian(&mut self, q: &[f64], momenta: &[f64]) -> Result<f64, DynamicsError> {
        let p = vector::<K>(momenta);
        Ok(0.5 * p.dot(&self.terms(q).factors.solve(&p)))
    }

    fn forward_dynamics_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        out: &mut ForwardDerivatives,
    ) -> Result<(), DynamicsError> {
        Recursive::new(Arc::clone(&self.mechanism))
            .forward_dynamics_derivatives(q, speeds, efforts, out)
    }

    fn hamiltonian_derivatives(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) -> Result<(), DynamicsError> {
        Recursive::new(Arc::clone(&self.mechanism))
            .hamiltonian_derivatives(q, momenta, efforts, out)
    }
}
