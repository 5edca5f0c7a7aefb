//! Motions of joints given by relations alone to where their spec ends them.

use hamel::dynamics::Recursive;
use hamel::integrate::{
    Form, IntegrateError, Method, Options, Scheme, StepFailure, integrate, no_inputs,
};
use hamel_interpreted::JointType;
use hamel_scene::Scene;
use std::ops::ControlFlow;
use std::sync::Arc;

/// How the motion of one body on this joint ends: 1 kg, without gravity, at this speed, until 11 s.
fn ended(spec: &str, joint: &str, speed: f64, method: Method) -> IntegrateError {
    let derived =
        hamel_codegen::derive(spec, "spec.joint").unwrap_or_else(|errors| panic!("{errors}"));
    let mut registry = hamel_joints::registry();
    let kind = JointType::new(&derived).expect("sizes that are interpreted");
    kind.register(&mut registry).expect("a name of its own");
    let text = format!(
        "hamel = 1\ngravity = [0.0, 0.0, 0.0]\n[[body]]\nname = \"link\"\nparent = \"world\"\nmass = 1.0\n\
         inertia_xx_yy_zz_xy_xz_yz = [0.01, 0.01, 0.01, 0.0, 0.0, 0.0]\njoint = {{ {joint} }}\ninitial = {{ speeds = [{speed:?}] }}\n"
    );
    let scene =
        Scene::parse(&text, "scene.toml", &registry).unwrap_or_else(|error| panic!("{error}"));
    let options = Options {
        form: Form::Lagrangian,
        method,
        t_end: 11.0,
        samples: vec![],
    };
    let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
    let ended = integrate(
        &mut dynamics,
        &scene.start(),
        &options,
        &mut no_inputs,
        &mut |_| ControlFlow::Continue(()),
    );
    ended.expect_err("a motion that ends")
}

/// A parallelogram with a third crank: its determinant, a square, has one sign on both sides of where it lies flat.
const THREE_CRANKS: &str = "hamel = 1;
    joint spec(ground: m > 0, crank: m > 0) {
        config   a: S1, b: S1, c: S1, d: S1;
        relation crank * a.c + ground * b.c = ground + crank * c.c;
        relation crank * a.s + ground * b.s = crank * c.s;
        relation crank * a.c + ground / 2 * b.c = ground / 2 + crank * d.c;
        home     = [0, 1], [1, 0], [0, 1], [0, 1];
        basis    turn of so2(a);
        except   b.s * c.c - b.c * c.s = 0;
        except   d.s = 0;
        H        = rot_z(a);
    }";

/// 3.65 s at 1.7 rad/s are nearly a full turn, at whose end the linkage stands as at its start.
#[test]
fn no_step_of_a_full_turn_leads_over_an_end() {
    let joint = "type = \"spec\", ground = 0.5, crank = 0.2";
    for scheme in [Scheme::CommutatorFree4, Scheme::Rk4, Scheme::Midpoint] {
        for step in [3.4, 3.6, 3.65, 3.7, 3.8, 7.4] {
            let error = ended(THREE_CRANKS, joint, 1.7, Method::fixed(scheme, step));
            let time = match &error {
                IntegrateError::Excluded(end) => end.time,
                IntegrateError::Step { time, .. } => *time,
                _ => panic!("{scheme:?}, {step}: {error}"),
            };
            // It lies flat after a quarter of a turn, at 0.924 s.
            assert!(time < 0.93, "{scheme:?}, {step}: {error}");
        }
    }
}

/// Far from where the spec ends it, a motion that explodes is not said to have come there.
#[test]
fn an_explosion_is_no_end() {
    let spec = "hamel = 1;
        joint spec {
            config   x: R1, y: R1;
            relation x * y = 0;
            except   x * x + y * y = 0;
            home     = 1, 0;
            H        = trans([x, y, 0]);
        }";
    let method = Method::fixed(Scheme::DormandPrince, 0.9);
    let error = ended(spec, "type = \"spec\"", 1.7, method);
    assert!(!matches!(error, IntegrateError::Excluded(_)), "{error}");
    if let IntegrateError::Step { cause, .. } = &error {
        assert!(!matches!(**cause, StepFailure::Excluded { .. }), "{error}");
    }
}
