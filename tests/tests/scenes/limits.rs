//! Compliant limits, against pieces of sines and a first integral.

use super::trials::{FORMS, error, run, scene, slide, times};
use hamel::integrate::{Form, Method, Scheme};
use hamel_scene::Scene;
use std::f64::consts::PI;

/// 2 kg on a spring of 8 N/m: ω₀ = 2/s. Beyond 0 there are 792 N/m more: ω₁ = 20/s. It begins at rest at −1 m.
fn bouncing() -> Scene {
    slide(
        "spring = { stiffness = 8.0 }\nlimit = { upper = 0.0, stiffness = 792.0 }\ninitial.phi = [-1.0]\n",
    )
}

/// Half swings of π/ω₀ within the limit and of π/ω₁ beyond it, with 2 m/s where they meet.
fn bounced(t: f64) -> (Vec<f64>, Vec<f64>) {
    let (slow, fast) = (2.0, 20.0);
    let period = PI / slow + PI / fast;
    // From the last time that it came to be within.
    let past = t + 0.5 * PI / slow;
    let rest = past - (past / period).floor() * period;
    let (x, v) = match rest - PI / slow {
        beyond if beyond < 0.0 => (-(slow * rest).sin(), -slow * (slow * rest).cos()),
        beyond => (
            slow / fast * (fast * beyond).sin(),
            slow * (fast * beyond).cos(),
        ),
    };
    (vec![x], vec![v])
}

/// Step control holds what it is asked for at the kinks: there are 12 of them in 10 s, and errors of steps add up with the growth of the motion's own.
#[test]
fn step_control_holds_the_tolerance_over_kinks() {
    let schemes = [
        Scheme::DormandPrince,
        Scheme::DormandPrince8,
        Scheme::Verner9,
        Scheme::Radau5,
        Scheme::Exponential,
    ];
    // The length of the last steps depends on where the limit is, so that errors do not fall from one tolerance to the next as evenly as they do elsewhere.
    for form in FORMS {
        for scheme in schemes {
            for tolerance in [1e-6, 1e-8, 1e-11] {
                if scheme == Scheme::Exponential && tolerance < 1e-9 {
                    continue;
                }
                let method = Method::controlled(scheme, tolerance);
                let solution = run(&bouncing(), form, method, &times(10.0));
                let found = error(&solution, bounced);
                let steps = solution.statistics.steps;
                println!("{form:?}, {scheme:?}, {tolerance:e}: {found:.1e} in {steps} steps");
                let allowed = 2.0 * tolerance * steps as f64;
                assert!(
                    found < allowed,
                    "{form:?}, {scheme:?}, {tolerance:e}: {found:e}, {steps} steps"
                );
            }
        }
    }
}

/// Fixed steps end at the limit, whatever their length, and keep their order: halving them divides the error by 2^p, of which a tenth is left
/// for what higher orders add.
#[test]
fn fixed_steps_keep_their_order_over_a_limit() {
    for form in FORMS {
        for (scheme, dt) in [
            (Scheme::Rk4, 0.01),
            (Scheme::CommutatorFree4, 0.01),
            (Scheme::Midpoint, 5e-3),
            (Scheme::Gauss2, 0.01),
            (Scheme::Gauss3, 0.04),
        ] {
            let [coarse, fine] = [dt, 0.5 * dt].map(|dt| {
                let solution = run(&bouncing(), form, Method::fixed(scheme, dt), &[4.0]);
                error(&solution, bounced)
            });
            let order = (coarse / fine).log2();
            println!("{scheme:?}, {form:?}: {coarse:.2e}, {fine:.2e}, order {order:.2}");
            let least = f64::from(scheme.order()) - 0.3;
            assert!(
                order > least,
                "{scheme:?}, {form:?}: order {order} from {coarse:e} and {fine:e}"
            );
        }
    }
}

/// Two alike that meet their limits at the same time take the steps of one.
#[test]
fn limits_are_met_together() {
    let one = |name: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nparent = \"world\"\nmass = 2.0\njoint = {{ type = \"prismatic\" }}\n\
             inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]\nspring = {{ stiffness = 8.0 }}\n\
             limit = {{ upper = 0.0, stiffness = 792.0 }}\ninitial.phi = [-1.0]\n"
        )
    };
    let two = scene(&(one("first") + &one("second")));
    for form in FORMS {
        let method = Method::controlled(Scheme::Verner9, 1e-13);
        let solution = run(&two, form, method, &times(5.0));
        let found = error(&solution, |t| {
            let (q, v) = bounced(t);
            ([q.clone(), q].concat(), [v.clone(), v].concat())
        });
        assert!(found < 1e-9, "{form:?}: {found:e}");
        let alone = run(&bouncing(), form, method, &times(5.0));
        let (steps, single) = (solution.statistics.steps, alone.statistics.steps);
        println!("{form:?}: {steps} steps, {single} of one");
        assert!(
            steps <= single + 10,
            "{form:?}: {steps} steps, {single} of one"
        );
    }
}

/// The closed form to 1e-9.
#[test]
fn an_oscillator_bounces_off_its_limit() {
    for form in FORMS {
        for scheme in [Scheme::DormandPrince8, Scheme::Verner9, Scheme::Radau5] {
            let method = Method::controlled(scheme, 1e-13);
            let found = error(&run(&bouncing(), form, method, &times(5.0)), bounced);
            assert!(found < 1e-9, "{form:?}, {scheme:?}: {found:e}");
        }
    }
}

/// A slide comes at v₀ and leaves at −v₁, with the same `v/d − ln(1 + d v)/d²` (from `m v dv = −k x (1 + d v) dx`); what the energy loses is in
/// that.
#[test]
fn damping_takes_what_its_first_integral_says() {
    let (damping, speed) = (0.8, 1.5);
    for (side, sign) in [("upper", 1.0), ("lower", -1.0)] {
        let scene = slide(&format!(
            "limit = {{ {side} = {}, stiffness = 500.0, damping = {damping} }}\ninitial.speeds = [{}]\n",
            0.3 * sign,
            speed * sign
        ));
        let integral = |v: f64| v / damping - (damping * v).ln_1p() / (damping * damping);
        // By halving: the integral rises with the distance of v from 0.
        let (mut low, mut high) = (0.0, speed);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match integral(-middle) < integral(speed) {
                true => low = middle,
                false => high = middle,
            }
        }
        for form in FORMS {
            for scheme in [Scheme::Verner9, Scheme::Radau5] {
                let method = Method::controlled(scheme, 1e-13);
                let solution = run(&scene, form, method, &[1.0]);
                let found = solution.samples[0].speeds[0] * -sign;
                assert!(
                    (found - low).abs() < 1e-9,
                    "{side}, {form:?}, {scheme:?}: {found} for {low}"
                );
            }
        }
    }
}

/// A discrete gradient keeps the energy over a limit that does not damp.
#[test]
fn a_limit_without_damping_keeps_the_energy() {
    let scene = bouncing();
    let method = Method::fixed(Scheme::DiscreteGradient, 2e-3);
    let solution = run(&scene, Form::Hamiltonian, method, &times(5.0));
    for state in &solution.samples {
        let at = scene
            .mechanism
            .kinematics(&state.configuration, &state.speeds);
        let energy = at.expect("sizes fit").energy();
        // 4 J, held against that of the beginning to 16 roundings.
        assert!(
            (energy - 4.0).abs() < 1e-13,
            "{energy} J at {} s",
            state.time
        );
    }
}

#[test]
fn limits_fit_joints_with_one_coordinate() {
    let refused = |kind: &str| {
        let text = format!(
            "hamel = 1\ngravity = [0.0, 0.0, 0.0]\n[[body]]\nname = \"a\"\nparent = \"world\"\nmass = 1.0\n\
             inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]\njoint = {{ type = \"{kind}\" }}\n\
             limit = {{ lower = -1.0, stiffness = 1.0 }}\n"
        );
        Scene::parse(&text, "limit", &hamel_joints::registry()).err()
    };
    assert!(refused("revolute").is_none());
    for kind in ["ball", "planar", "revolute_circle"] {
        let errors = refused(kind)
            .expect("a ball has no single coordinate")
            .to_string();
        assert!(
            errors.contains("joint `a`: a limit needs a single coordinate"),
            "{errors}"
        );
    }
}
