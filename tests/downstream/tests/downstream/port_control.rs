//! Controllers at ports of linkages: led along references, and shaped in energy with a largest effort.

use crate::common::registry;
use hamel::control::{
    ComputedTorque, ControlError, Controller, ErrorDynamics, PortReference, Reference,
};
use hamel::dynamics::Recursive;
use hamel::integrate::{Form, Integration, Method, Options, State, Step, integrate, no_observer};
use hamel::mechanism::Mechanism;
use hamel::time_function::Law;
use hamel_scene::Scene;
use std::ops::ControlFlow;
use std::sync::Arc;

/// A crank-rocker with a pendulum on its coupler; the initial state and the controller are left open.
const LINKAGE: &str = r#"
hamel = 1
name = "linkage"
gravity = [0.0, -9.81, 0.0]

[[body]]
name = "linkage"
parent = "world"
joint = { type = "crank_rocker", ground = 0.9, crank = 0.3, coupler = 1.0, rocker = 0.8 }
initial = { {initial} }
bodies.crank = { mass = 1.3, com = [0.05, 0.0, 0.0], inertia = [[0.02, 0.0, 0.0], [0.0, 0.04, 0.0], [0.0, 0.0, 0.055]] }
bodies.coupler = { mass = 0.8, com = [0.46, 0.1, 0.0], inertia = [[0.01, 0.0, 0.0], [0.0, 0.095, 0.0], [0.0, 0.0, 0.101]] }
bodies.rocker = { mass = 1.1, com = [0.4, 0.0, 0.0], inertia = [[0.01, 0.0, 0.0], [0.0, 0.06, 0.0], [0.0, 0.0, 0.064]] }
ports.rocker.armature = 0.1

[[body]]
name = "bob"
parent = "linkage.coupler"
mass = 0.4
com = [0.0, -0.2, 0.0]
inertia = [[0.01, 0.0, 0.0], [0.0, 0.005, 0.0], [0.0, 0.0, 0.01]]
joint = { type = "revolute" }

[controller]
{controller}
"#;

const ROCKER: usize = 1;

fn parsed(initial: &str, controller: &str) -> Result<Scene, String> {
    let text = LINKAGE
        .replace("{initial}", initial)
        .replace("{controller}", controller);
    let scene = Scene::parse(&text, "linkage.toml", &registry());
    scene.map_err(|errors| errors.to_string())
}

fn scene(initial: &str, controller: &str) -> Scene {
    parsed(initial, controller).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The value of one port, and its rate.
fn port(mechanism: &Mechanism, port: usize, q: &[f64], speeds: &[f64]) -> [f64; 2] {
    let own = mechanism.bodies()[0].configuration(q);
    let values = mechanism.port_values(0, own).expect("on the manifold");
    let rates = mechanism.port_rates(0, q, speeds).expect("sizes fit");
    [values[port], rates[port]]
}

/// Moves a scene under its controller, and tells time, Q, v̄ and τ at every step.
fn watch(scene: &Scene, t_end: f64, mut tell: impl FnMut(f64, &[f64], &[f64], &[f64])) -> State {
    let control = scene.control.as_ref().expect("a controller");
    let made = control.controller(&scene.mechanism, t_end);
    let mut law = made.expect("it was tried");
    let mut other = control
        .controller(&scene.mechanism, t_end)
        .expect("it was tried");
    let options = Options {
        form: Form::Lagrangian,
        method: Method::dormand_prince(1e-11),
        t_end,
        samples: vec![],
    };
    let mut tau = vec![0.0; scene.mechanism.layout().freedoms];
    let solution = integrate(
        &mut Recursive::new(Arc::clone(&scene.mechanism)),
        &scene.start(),
        &options,
        &mut |t, q, v, tau: &mut [f64]| {
            law.efforts(t, q, v, tau)
                .unwrap_or_else(|error| panic!("{error}"));
        },
        &mut |step: &Step<'_>| {
            let (q, v) = (step.configuration, step.speeds);
            other.efforts(step.time, q, v, &mut tau).expect("as before");
            tell(step.time, q, v, &tau);
            ControlFlow::Continue(())
        },
    );
    solution.expect("no failure").state
}

/// The error of a port that begins aside and at rest fades as `e₀ (1 + ω t) e^{−ω t}`: exactly, on a linkage that carries a pendulum and a rotor.
#[test]
fn a_port_is_led_along_its_reference() {
    let controller = r#"
kind = "computed_torque"
frequency = 6.0
[[controller.reference]]
joint = "linkage"
ports.rocker = { start = 1.9, amplitude = 0.15, frequency = 2.0, phase = 0.4 }
"#;
    let scene = scene("phi = [0.9]", controller);
    let mechanism = &scene.mechanism;
    let law = |t: f64| {
        let swing = (2.0 * t + 0.4).sin() - 0.4_f64.sin();
        [1.9 + 0.15 * swing, 0.3 * (2.0 * t + 0.4).cos()]
    };
    let (q, v) = (&scene.configuration, &scene.speeds);
    let [value, rate] = port(mechanism, ROCKER, q, v);
    let begin = [value - law(0.0)[0], rate - law(0.0)[1]];
    let mut seen: usize = 0;
    watch(&scene, 3.0, |t, q, v, _| {
        let [value, rate] = port(mechanism, ROCKER, q, v);
        let fade = (-6.0 * t).exp();
        let second = begin[1] + 6.0 * begin[0];
        let expected = (begin[0] + second * t) * fade;
        let faster = (second - 6.0 * (begin[0] + second * t)) * fade;
        // Some hundred steps with a tolerance of 1e-11 each, pulled together.
        assert!((value - law(t)[0] - expected).abs() < 1e-9, "{t}: {value}");
        assert!((rate - law(t)[1] - faster).abs() < 1e-8, "{t}: {rate}");
        seen += 1;
    });
    assert!(
        begin[0].abs() > 0.05 && seen > 20,
        "{begin:?}, {seen} steps"
    );
}

/// A spring and a damper at the rocker bring the linkage to rest where port and gravity balance, with an effort that is never larger than it may be.
#[test]
fn energy_is_shaped_at_a_port_within_its_limit() {
    let controller = r#"
kind = "energy_shaping"
[[controller.port]]
joint = "linkage"
port = "rocker"
stiffness = 60.0
damping = 12.0
limit = 9.0
[[controller.port]]
joint = "bob"
damping = 0.5
[[controller.goal]]
joint = "linkage"
phi = [1.2]
"#;
    let scene = scene("phi = [0.7], speeds = [2.0]", controller);
    let mechanism = &scene.mechanism;
    let mut most = 0.0_f64;
    let end = watch(&scene, 30.0, |_, q, _, tau| {
        let own = mechanism.bodies()[0].configuration(q);
        let map = mechanism.port_map(0, own).expect("on the manifold");
        let effort = (tau[0] / map[(ROCKER, 0)]).abs();
        // The rounding of a product and a quotient.
        assert!(effort <= 9.0 * (1.0 + 1e-12), "{effort}");
        most = most.max(effort);
    });
    assert!(most > 8.9, "the limit is reached: {most}");
    // The slowest mode fades within a second, thirty times over.
    assert!(
        end.speeds.iter().all(|v| v.abs() < 1e-8),
        "{:?}",
        end.speeds
    );
}

#[test]
fn dead_points_are_told_by_name() {
    // Stretched: by the law of cosines, with sides 0.9, 1.3 and 0.8, the rocker turns back.
    let cos: f64 = (0.9_f64.powi(2) + 1.3_f64.powi(2) - 0.8_f64.powi(2)) / (2.0 * 0.9 * 1.3);
    let sin = (1.0 - cos * cos).sqrt();
    let rocker = [(1.3 * cos - 0.9) / 0.8, 1.3 * sin / 0.8];
    let q = [cos, sin, cos, sin, rocker[0], rocker[1], 0.0];
    let bare = scene("phi = [0.9]", "kind = \"computed_torque\"\nfrequency = 6.0");
    let references = [PortReference {
        body: 0,
        port: ROCKER,
        start: 2.0,
        law: Law::default(),
    }];
    let reference = Reference::new(
        Arc::clone(&bare.mechanism),
        &bare.configuration,
        vec![Law::default(); 2],
        1.0,
    );
    let errors = ErrorDynamics {
        frequency: 6.0,
        damping_ratio: 1.0,
    };
    let law = ComputedTorque::new(reference.expect("at rest"), errors);
    let mut law = law
        .and_then(|law| law.at_ports(&references))
        .expect("a port");
    let failed = law.efforts(0.0, &q, &[1.0, 0.0], &mut [0.0; 2]);
    let failed = failed.expect_err("the rocker does not tell how the crank moves");
    assert!(matches!(failed, ControlError::Joint { .. }), "{failed}");
    assert!(
        failed
            .to_string()
            .contains("joint `linkage` stands where the ports"),
        "{failed}"
    );
}

/// A rocker that is led on beyond where it turns back: steps shrank without an end there, before the name was told.
#[test]
fn a_port_that_is_led_beyond_its_end_is_told_by_name() {
    let controller = r#"
kind = "computed_torque"
frequency = 20.0
[[controller.reference]]
joint = "linkage"
ports.rocker = { rate = 0.5 }
"#;
    let scene = scene("phi = [0.9]", controller);
    let control = scene.control.as_ref().expect("a controller");
    for tolerance in [1e-3, 1e-6, 1e-11] {
        let mut law = control
            .controller(&scene.mechanism, 10.0)
            .expect("it was tried");
        let mut failure = None;
        let options = Options {
            form: Form::Lagrangian,
            method: Method::dormand_prince(tolerance),
            t_end: 10.0,
            samples: vec![],
        };
        let stopped = integrate(
            &mut Recursive::new(Arc::clone(&scene.mechanism)),
            &scene.start(),
            &options,
            &mut |t, q, v, tau: &mut [f64]| {
                if let Err(error) = law.efforts(t, q, v, tau) {
                    failure.get_or_insert(error);
                    tau.fill(f64::NAN);
                }
            },
            &mut no_observer,
        );
        stopped.expect_err("the rocker turns back");
        let failure = failure.expect("a controller that fails").to_string();
        let told = "where the ports of its reference do not tell how it moves";
        assert!(failure.starts_with("joint `linkage`"), "{failure}");
        assert!(failure.contains(told), "{failure}");
    }
}

/// Efforts that are held for a while lead past the end before they are taken anew: the crank then turned ever faster, and nothing said why.
#[test]
fn held_efforts_that_lead_beyond_an_end_are_told_by_name() {
    for (period, amplitude) in [(0.1, 0.9), (0.02, 0.9), (0.02, -0.9), (0.005, 0.9)] {
        let controller = format!(
            "kind = \"computed_torque\"\nfrequency = 10.0\nperiod = {period:?}\n[[controller.reference]]\njoint = \"linkage\"\nports.rocker = {{ amplitude = {amplitude:?}, frequency = 3.0 }}"
        );
        let scene = scene("phi = [0.9]", &controller);
        let control = scene.control.as_ref().expect("a controller");
        let made = control.controller(&scene.mechanism, 10.0);
        let mut law = made.expect("it was tried");
        let mut failure = None;
        let options = Options {
            form: Form::Lagrangian,
            method: Method::dormand_prince(1e-8),
            t_end: 10.0,
            samples: vec![],
        };
        let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
        let start = scene.start();
        let motion = Integration::new(&mut dynamics, &start, &options)
            .inputs(|t, q, v, tau| {
                if let Err(error) = law.efforts(t, q, v, tau) {
                    failure.get_or_insert(error.to_string());
                    tau.fill(f64::NAN);
                }
            })
            .held(period)
            .observer(|step| {
                assert!(step.number < 5000, "each {period} s: {} s", step.time);
                ControlFlow::Continue(())
            });
        motion.run().expect_err("the rocker turns back");
        let failure = failure.expect("a controller that fails");
        let told = "where the ports of its reference do not tell how it moves";
        assert!(failure.contains(told), "{failure}");
        assert!(
            failure.contains("the reference leads there"),
            "each {period} s: {failure}"
        );
    }
}

#[test]
fn mistakes_are_refused_by_name() {
    let torque = "kind = \"computed_torque\"\nfrequency = 6.0\n[[controller.reference]]\njoint = \"linkage\"\n";
    let shaping = "kind = \"energy_shaping\"\n[[controller.port]]\njoint = \"linkage\"\n";
    let cases = [
        (
            format!("{torque}ports.rocke = {{}}"),
            "did you mean `rocker`?",
        ),
        (
            format!("{torque}ports.rocker = {{}}\nports.lift = {{}}"),
            "joint `linkage` must have as many references at ports as it has degrees of freedom",
        ),
        (
            format!("{torque}ports.rocker = {{}}\nspeeds = [1.0]"),
            "exclude each other",
        ),
        (format!("{shaping}port = \"lif\""), "did you mean `lift`?"),
        (
            format!("{shaping}port = \"lift\"\nkind = \"trace\""),
            "has a spring of kind \"trace\" at a port, which is no rotation",
        ),
        (
            format!(
                "{shaping}port = \"lift\"\n[[controller.port]]\njoint = \"linkage\"\nport = \"lift\""
            ),
            "port `lift` of joint `linkage` is named twice",
        ),
    ];
    for (controller, expected) in cases {
        let message = parsed("phi = [0.9]", &controller).expect_err("it is refused");
        assert!(message.contains(expected), "{message}");
    }
}
