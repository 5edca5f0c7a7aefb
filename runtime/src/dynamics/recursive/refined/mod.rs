//! The recursive form with residuals in 106 bits: exact where doubles cancel, and slower, up to a hundred times an evaluation.
//!
//! A light body that carries a heavy one, or a long chain, has a mass matrix of a large condition c, and the recursion in doubles finds
//! accelerations to c roundings. Here they are improved by iterative refinement (J. H. Wilkinson, *Rounding Errors in Algebraic Processes*, 1963, §3.6): inverse dynamics in double-double numbers gives the residual of the efforts; the factors that are there give the correction. Each round gains as many digits as the
//! first result had, so that the last one is what exact arithmetic would round to.
//!
//! What elements exert is taken from doubles, as the elements give it.

mod residual;

use super::Recursive;
use crate::dynamics::{Dynamics, DynamicsError, ForwardDerivatives, HamiltonianDerivatives};
use crate::mechanism::Mechanism;
use crate::scalar::Extended;
use crate::spatial::shift_wrench;
use crate::time_function::Moment;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector6;
use residual::Residual;

/// Rounds at most: where each gains two digits they are enough, and where it gains less the mass matrix counts as singular.
const MOST_ROUNDS: usize = 10;

/// A correction below this part of what it corrects no longer changes its double.
const NEGLIGIBLE: f64 = 0.125 * f64::EPSILON;

/// Corrections that come to more than this part of the last are rounding's.
const SHRINKS: f64 = 0.5;

/// [`Recursive`] with accelerations, and speeds of given momenta, to the last digit whatever the condition of the mass matrix; one for each thread.
///
/// For light bodies that carry heavy ones, where [`Recursive`] loses as many digits as the ratio of their masses has zeros. The motion of a
/// mechanism in the Lagrangian form then keeps them as well; momenta in doubles do not hold what their speeds are asked to
/// (`Form::Hamiltonian` of `hamel-integrate`). A mechanism whose joints constraints couple is left to [`Recursive`] as it is.
///
/// After construction nothing allocates.
#[derive(Clone, Debug)]
pub struct Refined {
    tree: Recursive,
    residual: Residual,
    /// The rates found so far, one entry per speed.
    found: Vec<Extended>,
    /// What they leave, and what that calls for.
    left: Vec<f64>,
    correction: Vec<f64>,
}

impl Refined {
    /// The refined form of `mechanism`.
    pub fn new(mechanism: Arc<Mechanism>) -> Self {
        let speeds = mechanism.layout().speeds;
        let tree = Recursive::new(mechanism);
        Self {
            residual: Residual::new(&tree),
            tree,
            found: vec![Extended::from(0.0); speeds],
            left: vec![0.0; speeds],
            correction: vec![0.0; speeds],
        }
    }

    /// Whether constraints couple joints, so that there is more to solve than the tree.
    fn is_coupled(&self) -> bool {
        self.tree.coupling.is_some()
    }

    /// Mends `rates`, of which `left` tells what is left of the right-hand side; the factors are those of the tree.
    fn refine(
        &mut self,
        rates: &mut [f64],
        mut left: impl FnMut(&mut Residual, &[Extended], &mut [f64]),
    ) {
        for (found, &rate) in self.found.iter_mut().zip(&*rates) {
            *found = Extended::from(rate);
        }
        let mut last = f64::INFINITY;
        for _ in 0..MOST_ROUNDS {
            left(&mut self.residual, &self.found, &mut self.left);
            self.tree.hold_driven(&mut self.left);
            self.tree.solve_again(&self.left, &mut self.correction);
            let pairs = self.correction.iter().zip(&self.found);
            let part = |change: f64, rate: f64| match change == 0.0 {
                true => 0.0,
                false => (change / rate).abs(),
            };
            let largest = pairs.fold(0.0, |most: f64, (change, rate)| {
                most.max(part(*change, rate.high()))
            });
            let size: f64 = self.correction.iter().map(|x| x.abs()).sum();
            if size.is_nan() || size >= SHRINKS * last {
                break;
            }
            for (found, &change) in self.found.iter_mut().zip(&self.correction) {
                *found += Extended::from(change);
            }
            if largest < NEGLIGIBLE {
                break;
            }
            last = size;
        }
        for (rate, found) in rates.iter_mut().zip(&self.found) {
            *rate = found.high();
        }
    }

    /// v̄ of p̄ by iterative refinement, with the twists of the tree to match.
    fn refined_speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.tree.speeds(q, momenta, speeds)?;
        if self.is_coupled() {
            return Ok(());
        }
        self.residual.place(q);
        self.refine(speeds, |residual, found, left| {
            residual.of_speeds(momenta, found, left);
        });
        self.tree.set_twists(speeds);
        Ok(())
    }
}

impl Recursive {
    /// Rates of generalised `forces` alone, by the factors of the last elimination; the wrenches of the nodes are lost.
    fn solve_again(&mut self, forces: &[f64], rates: &mut [f64]) {
        for node in &mut self.nodes {
            node.wrench = Vector6::zeros();
        }
        for index in (0..self.links.len()).rev() {
            let mut wrench = self.nodes[index].wrench;
            if let Some(group) = self.links[index].group {
                self.load_node(index, group, forces);
                continue;
            }
            let link = &self.links[index];
            let speeds = link.speeds.clone();
            let parent = link.parent;
            match link.slender {
                _ if link.driven => {}
                Some(number) => {
                    wrench = self.reduce_slender(index, number, &wrench, &forces[speeds]);
                }
                None => link.joint.reduce(
                    &mut wrench,
                    &self.columns[link.columns.clone()],
                    &self.pivots[speeds.clone()],
                    &forces[speeds.clone()],
                    &mut self.loads[speeds],
                ),
            }
            if let Some(parent) = parent {
                let offset = self.nodes[index].motion.placement.offset;
                self.nodes[parent].wrench += shift_wrench(&wrench, &offset);
            }
        }
        self.resolve(rates);
    }

    /// Nothing is left to do where motions are prescribed.
    fn hold_driven(&self, left: &mut [f64]) {
        for link in self.links.iter().filter(|link| link.driven) {
            left[link.speeds.clone()].fill(0.0);
        }
    }
}

impl Dynamics for Refined {
    fn mechanism(&self) -> &Arc<Mechanism> {
        self.tree.mechanism()
    }

    fn of(&self, mechanism: Arc<Mechanism>) -> Box<dyn Dynamics> {
        Box::new(Self::new(mechanism))
    }

    fn set_moment(&mut self, moment: Moment) {
        self.tree.set_moment(moment);
    }

    fn complete_speeds(&mut self, q: &[f64], speeds: &mut [f64]) -> Result<(), DynamicsError> {
        self.tree.complete_speeds(q, speeds)
    }

    fn forward_dynamics(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.tree.forward_dynamics(q, speeds, efforts, rates)?;
        if self.is_coupled() {
            return Ok(());
        }
        self.residual.place(q);
        self.residual.load(&self.tree, speeds, efforts);
        self.refine(rates, |residual, found, left| {
            residual.of_accelerations(found, left);
        });
        Ok(())
    }

    fn momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.tree.momenta(q, speeds, momenta)
    }

    fn speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.refined_speeds(q, momenta, speeds)
    }

    fn momentum_rates(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &mut dyn FnMut(&[f64], &mut [f64]),
        speeds: &mut [f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        if self.is_coupled() {
            return self.tree.momentum_rates(q, momenta, efforts, speeds, rates);
        }
        self.tree.check_room("rates", rates)?;
        self.refined_speeds(q, momenta, speeds)?;
        self.tree.rates_of_momenta(q, speeds, efforts, rates)
    }

    fn hamiltonian(&mut self, q: &[f64], momenta: &[f64]) -> Result<f64, DynamicsError> {
        self.tree.hamiltonian(q, momenta)
    }

    fn forward_dynamics_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        out: &mut ForwardDerivatives,
    ) -> Result<(), DynamicsError> {
        self.tree
            .forward_dynamics_derivatives(q, speeds, efforts, out)
    }

    fn hamiltonian_derivatives(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) -> Result<(), DynamicsError> {
        self.tree.hamiltonian_derivatives(q, momenta, efforts, out)
    }
}
