//! Scalars, finite maps, batches and parameters.

use crate::common::joints;
use crate::support::wrong;
use hamel_compiled::{Batch, Equations, InLanes, Lanes};
use hamel_runtime::finite;
use hamel_runtime::registry::{ParameterInfo, check_parameters};
use hamel_runtime::scalar::{Dual, Scalar};
use nalgebra::SVector;

const ODD: [f64; 9] = [
    0.0,
    -0.0,
    5e-324,
    1e-300,
    -1e300,
    f64::MAX,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

#[test]
fn series_of_any_order_have_a_value() {
    for argument in ODD {
        for order in [0, 1, 2, 3, 7, 24, 170, 171, 1000, usize::MAX] {
            _ = argument.stumpff(order);
            _ = argument.dexp_inverse(order);
        }
    }
    for order in [171, 1000, usize::MAX] {
        assert_eq!(3.0.stumpff(order), 0.0);
    }
}

#[test]
fn projections_of_any_codimension_end() {
    for codimension in [0, 1, 2, usize::MAX] {
        for start in ODD {
            let q = SVector::<f64, 1>::new(start);
            let relation = |q: &SVector<Dual<f64>, 1>| q.map(|x| x - Dual::constant(1.0));
            let found = finite::project(&q, codimension, relation);
            assert!(
                found[0].is_nan() || (found[0] - 1.0).abs() < 1e-7,
                "{found}"
            );
        }
    }
}

fn halves(_: &[f64], speeds: &[f64], _: &[f64], rates: &mut [f64]) {
    for (rate, speed) in rates.iter_mut().zip(speeds) {
        *rate = 0.5 * speed;
    }
}

const fn equations(configuration: usize, freedoms: usize, speeds: usize) -> Equations {
    Equations {
        scene: "any",
        configuration,
        freedoms,
        speeds,
        forward_dynamics: Some(halves),
        inverse_dynamics: Some(halves),
        momenta: None,
        speeds_from_momenta: None,
        momentum_rates: None,
        hamiltonian: None,
        forward_dynamics_derivatives: None,
        inverse_dynamics_derivatives: None,
        forward_dynamics_second_derivatives: None,
        inverse_dynamics_second_derivatives: None,
        forward_slopes: 0,
        mass_matrix: None,
        inverse_mass_matrix: None,
        in_lanes: InLanes::NONE,
    }
}

/// Sizes as no module has them, and rows of other lengths.
#[test]
fn batches_of_any_sizes_are_computed_or_refused() {
    static ANY: [Equations; 5] = [
        equations(2, 1, 1),
        equations(0, 0, 0),
        equations(usize::MAX, 1, 1),
        equations(1, usize::MAX, 2),
        equations(1, 1, usize::MAX),
    ];
    for equations in &ANY {
        let batch = Batch::new(equations);
        for q in [0, 1, 2, 3, 16] {
            for v in [0, 1, 2, 8] {
                for u in [0, 1, 8] {
                    for rates in [0, 1, 8] {
                        let (q, v, u) = (vec![1.0; q], vec![1.0; v], vec![1.0; u]);
                        let mut rates = vec![0.0; rates];
                        _ = batch.forward_dynamics(&q, &v, &u, &mut rates);
                        _ = batch.inverse_dynamics(&q, &v, &u, &mut rates);
                    }
                }
            }
        }
    }
}

#[test]
fn lanes_of_any_width_are_made() {
    let states = [1.0; 21];
    for width in [0, 1, 2, 7, 20, 21, 22, usize::MAX] {
        let lanes = Lanes::side_by_side(&states, width);
        let back = Lanes::apart(&lanes, width);
        assert!(back.iter().all(|entry| *entry == 1.0), "{width}");
    }
    assert!(Lanes::side_by_side(&[], 3).is_empty());
}

#[test]
fn parameters_of_any_number_are_checked() {
    let none: [ParameterInfo; 0] = [];
    for bad in wrong(0) {
        assert!(check_parameters("joint", &none, &bad).is_err());
    }
    assert!(check_parameters("joint", &none, &[]).is_ok());
    _ = joints::revolute();
}
