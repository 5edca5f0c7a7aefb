//! A joint of any type and any parameters, as the search sees it: numbers in, numbers out.

use super::traced::{Traced, notes_of};
use crate::accuracy::{
    Arguments, Case, Output, arguments, formulas, home, moved, outputs, solutions,
};
use hamel::joint::Joint;
use hamel::nalgebra::SVector;
use hamel::scalar::Scalar;

/// Notes that are taken of a kernel which iterates: those of its later steps say nothing of the kernel's value.
const OF_SOLUTION: usize = 16;

/// The compiled kernels of one joint.
pub(super) trait Kernels {
    /// Every kernel in doubles.
    fn doubles(&self, case: &Case) -> Vec<Output<f64>>;
    /// The arguments of all functions in all kernels.
    fn notes(&self, case: &Case) -> Vec<f64>;
    /// Φ(Q, ϕ).
    fn retract(&self, q: &[f64], phi: &[f64]) -> Vec<f64>;
    /// The nearest configuration on the manifold.
    fn project(&self, q: &[f64]) -> Vec<f64>;
    /// The home configuration.
    fn home(&self) -> Vec<f64>;
}

/// Builds the joint with these values of its parameters.
pub(super) type Build<'a> = &'a dyn Fn(&[f64]) -> Box<dyn Kernels>;

/// A joint with its sizes.
pub(super) struct Sized<J, const N: usize, const K: usize, const S: usize, const C: usize>(pub J);

impl<J: Joint<N, K, S, C>, const N: usize, const K: usize, const S: usize, const C: usize>
    Sized<J, N, K, S, C>
{
    fn arguments<T: Scalar>(&self, case: &Case) -> Arguments<T, N, K, S> {
        arguments(&self.0, std::slice::from_ref(case), |x| T::from_f64(x[0]))
    }
}

fn vector<const M: usize>(values: &[f64]) -> SVector<f64, M> {
    SVector::from_fn(|i, _| values[i])
}

impl<J: Joint<N, K, S, C>, const N: usize, const K: usize, const S: usize, const C: usize> Kernels
    for Sized<J, N, K, S, C>
{
    fn doubles(&self, case: &Case) -> Vec<Output<f64>> {
        outputs(&self.0, &self.arguments(case))
    }

    fn notes(&self, case: &Case) -> Vec<f64> {
        let at = self.arguments::<Traced>(case);
        let mut notes = notes_of(usize::MAX, || formulas(&self.0, &at));
        let of_retract = match J::RELATIONS {
            [] => {
                notes.extend(notes_of(usize::MAX, || {
                    home::<Traced, _, N, K, S, C>(&self.0)
                }));
                usize::MAX
            }
            // To solve relations for home would take most of the time. It is compared at every set of parameters; features of it between these are not looked for.
            _ => OF_SOLUTION,
        };
        notes.extend(notes_of(of_retract, || moved(&self.0, &at)));
        for solution in solutions(&self.0, &at) {
            notes.extend(notes_of(OF_SOLUTION, solution));
        }
        notes
    }

    fn retract(&self, q: &[f64], phi: &[f64]) -> Vec<f64> {
        let moved = self.0.retract(&vector::<N>(q), &vector::<K>(phi));
        moved.as_slice().to_vec()
    }

    fn project(&self, q: &[f64]) -> Vec<f64> {
        self.0.project(&vector::<N>(q)).as_slice().to_vec()
    }

    fn home(&self) -> Vec<f64> {
        self.0.home::<f64>().as_slice().to_vec()
    }
}
