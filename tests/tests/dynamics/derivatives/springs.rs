//! Springs between points that meet, or nearly do.

use hamel::dynamics::{
    Dynamics, DynamicsError, ForwardDerivatives, ForwardSecondDerivatives,
    InverseSecondDerivatives, Recursive,
};
use hamel_scene::Scene;
use std::sync::Arc;

/// A point mass of 2 kg at the end of a spring of 3 N/m.
fn pulled(more: &str) -> Recursive {
    let text = format!(
        "hamel = 1\ngravity = [0.0, 0.0, 0.0]\n[[body]]\nname = \"load\"\nparent = \"world\"\nmass = 2.0\n\
         inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]\njoint = {{ type = \"translation\" }}\n\
         [[spring]]\nfrom = {{ body = \"world\" }}\nto = {{ body = \"load\" }}\nstiffness = 3.0\n{more}\n"
    );
    let scene = Scene::from_toml(&text, "scene.toml").unwrap_or_else(|errors| panic!("{errors}"));
    let scene = scene
        .build(&hamel_joints::registry())
        .unwrap_or_else(|errors| panic!("{errors}"));
    Recursive::new(Arc::clone(&scene.mechanism))
}

/// `F = −k x` has the slope −k in all directions, where the ends meet too.
#[test]
fn a_spring_of_no_length_pulls_the_same_way_in_all_directions() {
    let mut dynamics = pulled("");
    let mut first = ForwardDerivatives::new(dynamics.mechanism());
    let mut second = ForwardSecondDerivatives::new(dynamics.mechanism());
    let mut inverse = InverseSecondDerivatives::new(dynamics.mechanism());
    let (still, weights) = ([0.0; 3], [0.3, -0.7, 1.1]);
    for distance in [0.0, 1e-200, 1e-155, 1e-50, 1e-12, 1e-6, 1.0] {
        let q = [0.6 * distance, -0.8 * distance, 0.0];
        let found = dynamics.forward_dynamics_derivatives(&q, &still, &still, &mut first);
        found.expect("derivatives");
        for i in 0..3 {
            for j in 0..3 {
                let expected = if i == j { -1.5 } else { 0.0 };
                let found = first.by_local().entry(i, j);
                assert!(
                    (found - expected).abs() <= 4.0 * f64::EPSILON,
                    "{distance}: {found}"
                );
            }
        }
        let found =
            dynamics.forward_dynamics_second_derivatives(&q, &still, &still, &weights, &mut second);
        found.expect("second derivatives");
        let found = dynamics.inverse_dynamics_second_derivatives(
            &q,
            &still,
            &still,
            &weights,
            &mut inverse,
        );
        found.expect("second derivatives");
        for entry in second
            .hessian()
            .entries()
            .iter()
            .chain(inverse.hessian().entries())
        {
            assert!(entry.abs() <= 1e-15, "{distance}: {entry}");
        }
    }
}

/// Along which line the force would act is not known there.
#[test]
fn a_spring_without_a_direction_is_refused_by_name() {
    for more in ["length = 0.5", "damping = 2.0"] {
        let mut dynamics = pulled(more);
        let mut first = ForwardDerivatives::new(dynamics.mechanism());
        let still = [0.0; 3];
        let refused = dynamics.forward_dynamics_derivatives(&still, &still, &still, &mut first);
        let error = refused.expect_err("there is no derivative");
        assert!(
            matches!(error, DynamicsError::NoDerivative { .. }),
            "{error}"
        );
        assert_eq!(
            error.to_string(),
            "element `spring 1` has no derivative at this state: its points coincide, so that its force has no direction"
        );
        let near = [1e-9, 0.0, 0.0];
        let found = dynamics.forward_dynamics_derivatives(&near, &still, &still, &mut first);
        found.expect("derivatives");
    }
}
