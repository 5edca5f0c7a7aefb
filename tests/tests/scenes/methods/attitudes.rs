//! Attitudes where Euler angles are singular.

use super::super::motions::{reference, scenes};
use super::{completed, run};
use hamel::integrate::{Form, Method, Scheme};
use hamel_scene::Scene;

/// The scene of that name with other joints in place of its ball joints.
fn exchanged(name: &str, joint: &str) -> Scene {
    let path = scenes().join(format!("report/{name}.toml"));
    let text = std::fs::read_to_string(path).expect("a scene");
    let text = text.replace("\"ball_child\"", &format!("\"{joint}\""));
    Scene::parse(&text, name, &hamel_joints::registry()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The same top in axes that are exchanged: where a gimbal would lock, and where it would not.
#[test]
fn attitudes_where_euler_angles_fail_cost_nothing() {
    for (scheme, tolerance) in [(Scheme::DormandPrince, 1e-8), (Scheme::Verner9, 1e-11)] {
        let method = Method::controlled(scheme, tolerance);
        let solved = |name: &str, joint: &str| {
            let run = run(
                &exchanged(name, joint),
                &reference(name),
                Form::Lagrangian,
                method,
            );
            println!(
                "{name} {joint} {}: {:?}",
                scheme.name(),
                run.as_ref()
                    .map(|run| run.as_ref().map(|run| (run.error, run.statistics.steps)))
            );
            run
        };
        for joint in ["ball_child", "ball_quaternion_child"] {
            let [through, aside] =
                ["top_lock", "top_lock_turned"].map(|name| completed(solved(name, joint), name));
            // One set of equations in two frames: rounding alone differs, which can move a step at the end.
            let [a, b] = [&through, &aside].map(|run| run.statistics.steps);
            assert!(a.abs_diff(b) <= 2, "{joint}: {a} steps against {b}");
            let factor = through.error / aside.error;
            assert!((0.5..2.0).contains(&factor), "{joint}: {factor}");
        }
        let aside = completed(solved("top_lock_turned", "gimbal"), "gimbal");
        assert!(aside.error < 1e4 * tolerance, "{:e}", aside.error);
        let through = solved("top_lock", "gimbal");
        let locked = match &through {
            Err(error) => error
                .to_string()
                .contains("mass matrix is singular at joint"),
            // It crawls.
            Ok(run) => run
                .as_ref()
                .is_none_or(|run| run.statistics.steps > 10 * aside.statistics.steps),
        };
        assert!(locked, "the gimbal passes its lock in few steps");
    }
}
