//! What inputs can hold is judged alike whatever the units of states are, and however stiff, light or fast the rest is.

#[path = "../../../runtime/tests/common/mod.rs"]
mod common;

use common::random::Random;
use hamel_control::ControlError;
use hamel_control::riccati::{Optimum, Weighting, continuous};
use nalgebra::{DMatrix, DVector, dmatrix};

/// `M q̈ + D q̇ + K q = u` of some degrees of freedom, with inputs on some of them.
struct Linear {
    mass: DMatrix<f64>,
    damping: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    inputs: &'static [usize],
}

impl Linear {
    /// A and B of (q, q̇).
    fn matrices(&self) -> (DMatrix<f64>, DMatrix<f64>) {
        let n = self.mass.nrows();
        let inverse = self.mass.clone().try_inverse().expect("it is regular");
        let mut a = DMatrix::zeros(2 * n, 2 * n);
        a.view_mut((0, n), (n, n)).fill_with_identity();
        a.view_mut((n, 0), (n, n))
            .copy_from(&(-&inverse * &self.stiffness));
        a.view_mut((n, n), (n, n))
            .copy_from(&(-&inverse * &self.damping));
        let mut b = DMatrix::zeros(2 * n, self.inputs.len());
        for (column, &freedom) in self.inputs.iter().enumerate() {
            b.view_mut((n, column), (n, 1))
                .copy_from(&inverse.column(freedom));
        }
        (a, b)
    }

    /// The optimum in states that are measured in random units.
    fn optimum(&self, random: &mut Random) -> Result<Optimum, ControlError> {
        let (a, b) = self.matrices();
        let units = DVector::from_fn(a.nrows(), |_, _| 10.0_f64.powf(4.0 * random.next()));
        let (to, from) = (
            DMatrix::from_diagonal(&units.map(f64::recip)),
            DMatrix::from_diagonal(&units),
        );
        let weighting = Weighting {
            state: &(&from * &from),
            input: &DMatrix::identity(b.ncols(), b.ncols()),
        };
        continuous(&(&to * a * &from), &(&to * b), weighting)
    }
}

fn diagonal<const N: usize>(entries: [f64; N]) -> DMatrix<f64> {
    DMatrix::from_diagonal(&DVector::from_column_slice(&entries))
}

const TRIES: usize = 50;

/// The second joint has no input and fades at 0.03 1/s, beside oscillations of 1e6 rad/s and more.
#[test]
fn what_fades_is_accepted_beside_any_stiffness() {
    let mut random = Random::new(31);
    for stiffness in [1.0, 1e6, 1e12] {
        for mass in [diagonal([1.0, 1.0]), dmatrix![2.0, 1.0; 1.0, 1.0]] {
            for _ in 0..TRIES {
                let linear = Linear {
                    mass: mass.clone(),
                    damping: diagonal([0.0, 0.06]),
                    stiffness: diagonal([stiffness, 1.0]),
                    inputs: &[0],
                };
                let found = linear.optimum(&mut random);
                assert!(found.is_ok(), "{stiffness:e}: {found:?}");
            }
        }
    }
}

/// The second joint has no input and creeps back to its rest, beside one that an input moves and nothing holds: that one's zeros are not of the creeping one.
#[test]
fn what_creeps_is_accepted_beside_what_is_free() {
    let mut random = Random::new(35);
    for damping in [3.0, 10.0, 1e3] {
        for _ in 0..TRIES {
            let linear = Linear {
                mass: diagonal([1.0, 1.0]),
                damping: diagonal([0.0, damping]),
                stiffness: diagonal([0.0, 1.0]),
                inputs: &[0],
            };
            let found = linear.optimum(&mut random);
            assert!(found.is_ok(), "{damping}: {found:?}");
        }
    }
}

/// A pendulum upright, and on it another one of a part of its mass: any of the joints with an input reaches both motions.
#[test]
fn light_joints_reach_heavy_ones() {
    let mut random = Random::new(32);
    for light in [1.0, 1e-3, 1e-6, 1e-9] {
        for inputs in [&[0][..], &[1], &[0, 1]] {
            for _ in 0..TRIES {
                let linear = Linear {
                    mass: dmatrix![1.0 + light, light; light, light],
                    damping: DMatrix::zeros(2, 2),
                    stiffness: diagonal([-10.0, -7.0 * light]),
                    inputs,
                };
                let found = linear.optimum(&mut random);
                assert!(
                    !matches!(
                        found,
                        Err(ControlError::BeyondReach(_) | ControlError::Unseen(_))
                    ),
                    "{light:e}, {inputs:?}: {found:?}"
                );
            }
        }
    }
}

/// A pendulum upright that no input reaches: by itself, or as one of two that are alike on a cart.
#[test]
fn what_falls_beyond_reach_is_refused_beside_any_stiffness() {
    let mut random = Random::new(33);
    for stiffness in [1.0, 1e6, 1e12] {
        for light in [1.0, 1e-9] {
            let alone = Linear {
                mass: diagonal([light, 1.0]),
                damping: DMatrix::zeros(2, 2),
                stiffness: diagonal([stiffness, -10.0]),
                inputs: &[0],
            };
            let alike = Linear {
                mass: dmatrix![3.0, light, light; light, light, 0.0; light, 0.0, light],
                damping: DMatrix::zeros(3, 3),
                stiffness: diagonal([stiffness, -10.0 * light, -10.0 * light]),
                inputs: &[0],
            };
            for linear in [alone, alike] {
                for _ in 0..TRIES {
                    let found = linear.optimum(&mut random);
                    assert!(
                        matches!(found, Err(ControlError::BeyondReach(_))),
                        "{stiffness:e}, {light:e}, {}: {found:?}",
                        linear.mass
                    );
                }
            }
        }
    }
}

/// The same that swings, without damping: it does not fade.
#[test]
fn what_swings_beyond_reach_is_refused() {
    let mut random = Random::new(34);
    for stiffness in [1.0, 1e6, 1e12] {
        for _ in 0..TRIES {
            let linear = Linear {
                mass: diagonal([1.0, 2.0]),
                damping: DMatrix::zeros(2, 2),
                stiffness: diagonal([stiffness, 10.0]),
                inputs: &[0],
            };
            let found = linear.optimum(&mut random);
            assert!(
                matches!(found, Err(ControlError::BeyondReach(_))),
                "{stiffness:e}: {found:?}"
            );
        }
    }
}
