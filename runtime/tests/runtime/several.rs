//! Joints that carry several bodies: a pair of joints in series is the same mechanism as one joint of two bodies.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::readings::{assert_same, readings};
use crate::common::several::{arms, between, drifter, links};
use crate::common::trees::{GRAVITY, body, mass, pose};
use hamel_runtime::dynamics::{
    Dynamics, ForwardDerivatives, Frame, HamiltonianDerivatives, InverseDerivatives,
    InverseMassMatrix, LoadedMass, MassMatrix, Recursive, Reference, Refined, Sensitivity,
};
use hamel_runtime::elements::{
    BodySpring, BodyWrench, Drive, Element, JointDamper, JointSlopes, JointSpring, PointConstraint,
    WrenchAxes,
};
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::mechanism::{BodySpec, Mechanism, NamedFrame};
use hamel_runtime::spatial::Pose;
use hamel_runtime::steps::Variation;
use hamel_runtime::time_function::Law;
use nalgebra::Vector3;
use std::sync::Arc;

/// Rounding times the condition of mass matrices of five joints, below 1e3.
const ROUNDING: f64 = 1e-12;

/// The same mechanism, with the pair as one joint and as two.
struct Pair {
    joined: Mechanism,
    apart: Mechanism,
}

/// Index of the first body of the pair.
const PAIR: usize = 1;

/// A base that the pair hangs on; on each of its bodies hangs something, on the second another pair.
fn pair(
    seed: u64,
    joined: fn() -> Arc<dyn AnyJoint>,
    apart: [fn() -> Arc<dyn AnyJoint>; 2],
) -> Pair {
    let mut random = Random::new(seed);
    let mut bodies: [Vec<BodySpec>; 2] = [Vec::new(), Vec::new()];
    let mut add = |parent: Option<usize>, joint: Arc<dyn AnyJoint>| {
        let index = bodies[0].len();
        let name = format!("body {index}");
        let mut spec = body(&name, parent, joint, pose(&mut random), mass(&mut random));
        spec.child_placement = pose(&mut random);
        bodies.iter_mut().for_each(|own| own.push(spec.clone()));
        if let Some(second) = spec.joint.more().into_iter().next() {
            let first = index;
            let mut spec = BodySpec {
                name: format!("body {}", index + 1),
                joint: second,
                child_placement: pose(&mut random),
                mass: mass(&mut random),
                ..spec
            };
            bodies[0].push(spec.clone());
            let fixed = bodies[1][first].child_placement;
            bodies[1][first].joint = apart[0]();
            spec.joint = apart[1]();
            spec.parent = Some(first);
            spec.placement = fixed.inverse() * between();
            bodies[1].push(spec);
        }
    };
    add(None, joints::ball());
    add(Some(0), joined());
    add(Some(PAIR), joints::planar());
    add(Some(PAIR + 1), joined());
    add(Some(PAIR + 3), joints::revolute());
    add(Some(PAIR + 4), joints::revolute());
    let [joined, apart] = bodies.map(|own| Mechanism::new(GRAVITY, own).expect("valid"));
    assert_eq!(joined.layout(), apart.layout());
    Pair { joined, apart }
}

fn pairs() -> [Pair; 3] {
    [
        pair(3, links, [joints::revolute, joints::revolute]),
        pair(1, arms, [joints::revolute, joints::revolute]),
        pair(2, drifter, [joints::drift, joints::revolute]),
    ]
}

impl Pair {
    fn map(self, change: impl Fn(Mechanism) -> Mechanism) -> Self {
        Self {
            joined: change(self.joined),
            apart: change(self.apart),
        }
    }

    /// Whether `read` says the same of both.
    fn agree(&self, what: &str, read: impl Fn(&Arc<Mechanism>, &State) -> Vec<f64>) {
        for seed in 0..4 {
            let state = State::new(seed, &self.apart);
            let [found, expected] =
                [&self.joined, &self.apart].map(|own| read(&Arc::new(own.clone()), &state));
            assert_same(&found, &expected, ROUNDING, what);
        }
    }
}

struct State {
    q: Vec<f64>,
    speeds: Vec<f64>,
    efforts: Vec<f64>,
    rates: Vec<f64>,
}

impl State {
    fn new(seed: u64, mechanism: &Mechanism) -> Self {
        let mut random = Random::new(70 + seed);
        let layout = mechanism.layout();
        Self {
            q: crate::common::trees::configuration(&mut random, mechanism),
            speeds: random.vec(layout.speeds),
            efforts: random.vec(layout.freedoms),
            rates: random.vec(layout.speeds),
        }
    }
}

fn matrix(sensitivity: &Sensitivity) -> Vec<f64> {
    sensitivity.entries().to_vec()
}

/// All that one evaluation says.
fn all(mechanism: &Arc<Mechanism>, state: &State) -> Vec<f64> {
    let mut forms: Vec<Box<dyn Dynamics>> = vec![
        Box::new(Recursive::new(Arc::clone(mechanism))),
        Box::new(Refined::new(Arc::clone(mechanism))),
        Box::new(Reference::new(Arc::clone(mechanism))),
    ];
    let mut all = Vec::new();
    for form in &mut forms {
        all.extend(readings(
            &mut **form,
            &state.q,
            &state.speeds,
            &state.efforts,
        ));
    }
    all
}

fn derivatives(mechanism: &Arc<Mechanism>, state: &State) -> Vec<f64> {
    let mut recursive = Recursive::new(Arc::clone(mechanism));
    let State {
        q,
        speeds,
        efforts,
        rates,
    } = state;
    let mut inverse = InverseDerivatives::new(mechanism);
    recursive
        .inverse_dynamics_derivatives(q, speeds, rates, &mut inverse)
        .expect("fits");
    let mut all = matrix(inverse.by_local());
    all.extend(matrix(inverse.by_speeds()));
    let mut forward = ForwardDerivatives::new(mechanism);
    recursive
        .forward_dynamics_derivatives(q, speeds, efforts, &mut forward)
        .expect("fits");
    for own in [
        forward.by_local(),
        forward.by_speeds(),
        forward.by_efforts(),
    ] {
        all.extend(matrix(own));
    }
    all.extend(forward.rates());
    let mut hamiltonian = HamiltonianDerivatives::new(mechanism);
    recursive
        .hamiltonian_derivatives(q, speeds, efforts, &mut hamiltonian)
        .expect("fits");
    for own in [
        hamiltonian.speeds_by_local(),
        hamiltonian.speeds_by_momenta(),
        hamiltonian.rates_by_local(),
        hamiltonian.rates_by_momenta(),
        hamiltonian.rates_by_efforts(),
    ] {
        all.extend(matrix(own));
    }
    all
}

#[test]
fn both_forms_agree() {
    for pair in pairs() {
        pair.agree("forms", all);
    }
}

#[test]
fn derivatives_agree() {
    for pair in pairs() {
        pair.agree("derivatives", derivatives);
    }
}

/// Springs and wrenches at every body; dampers, springs and, where it is holonomic, rotors at the joints of the pair.
fn equipped(mechanism: Mechanism, has_rotors: bool) -> Mechanism {
    let mut random = Random::new(5);
    let mut elements: Vec<Arc<dyn Element>> = Vec::new();
    for body in 1..mechanism.bodies().len() {
        elements.push(Arc::new(BodySpring {
            name: format!("rope {body}"),
            bodies: [Some(body - 1), Some(body)],
            points: [random.vector(), random.vector()],
            stiffness: 3.0,
            damping: 0.7,
            length: 0.4,
        }));
        for axes in [WrenchAxes::World, WrenchAxes::Body] {
            elements.push(Arc::new(BodyWrench {
                name: format!("push {body}"),
                body,
                point: random.vector(),
                force: random.vector(),
                moment: random.vector(),
                axes,
            }));
        }
    }
    // One entry for each degree of freedom of the pair, whether it is one joint or two.
    let of_pair = |bodies: [usize; 2]| -> Vec<f64> {
        let bodies = match mechanism.bodies()[bodies[1]].leads() {
            true => &bodies[..],
            false => &bodies[..1],
        };
        let sizes = bodies.iter();
        sizes
            .map(|&body| mechanism.bodies()[body].ranges().freedoms.len() as f64)
            .collect()
    };
    let mut with_rotors = mechanism.clone();
    let mut place = 0.0;
    for first in [PAIR, PAIR + 3] {
        for (body, size) in (first..).zip(of_pair([first, first + 1])) {
            let size = size as usize;
            let entries = |offset: f64| -> Vec<f64> {
                let numbers = (0..size).map(|k| offset + place + 0.3 * k as f64);
                numbers.collect()
            };
            let (damping, stiffness) = (entries(0.2), entries(0.5));
            elements.push(Arc::new(JointDamper {
                name: format!("damper {body}"),
                body,
                coefficients: damping,
            }));
            let diagonal = |n: usize| {
                if n / size == n % size {
                    stiffness[n / size]
                } else {
                    0.0
                }
            };
            elements.push(Arc::new(JointSpring {
                name: format!("spring {body}"),
                body,
                stiffness: (0..size * size).map(diagonal).collect(),
                rest: mechanism.bodies()[body].home(),
            }));
            if has_rotors {
                with_rotors = with_rotors
                    .with_armature(body, &entries(0.1))
                    .expect("fits");
            }
            place += 0.3 * size as f64;
        }
    }
    with_rotors.with_elements(elements).expect("fits")
}

#[test]
fn elements_rotors_and_drives_agree() {
    for (pair, has_rotors) in pairs().into_iter().zip([true, true, false]) {
        let equipped = pair.map(|own| equipped(own, has_rotors));
        equipped.agree("equipped", all);
        equipped.agree("derivatives, equipped", derivatives);
    }
    let laws = |count: usize| -> Vec<_> {
        let law = Law {
            rate: 0.3,
            amplitude: 0.2,
            frequency: 2.0,
            phase: 0.4,
        };
        vec![law.into(); count]
    };
    let drives = |bodies: &[(usize, usize)]| -> Vec<Drive> {
        let drives = bodies.iter().map(|&(body, count)| Drive {
            name: format!("drive {body}"),
            body,
            laws: laws(count),
        });
        drives.collect()
    };
    let Pair { joined, apart } = pair(1, arms, [joints::revolute, joints::revolute]);
    let driven = Pair {
        joined: joined.with_drives(drives(&[(PAIR, 2)])).expect("fits"),
        apart: apart
            .with_drives(drives(&[(PAIR, 1), (PAIR + 1, 1)]))
            .expect("fits"),
    };
    driven.agree("driven", all);
    driven.agree("derivatives, driven", derivatives);
}

#[test]
fn constraints_across_joints_agree() {
    for pair in pairs() {
        let start = State::new(9, &pair.apart).q;
        let coupled = pair.map(|own| {
            let constraint = PointConstraint {
                name: "runner".into(),
                body: PAIR + 1,
                point: Vector3::new(0.2, 0.1, -0.4),
                direction: Vector3::new(0.3, 1.0, 0.2),
            };
            own.with_constraints(vec![constraint], &start)
                .expect("fits")
        });
        let obeying = |mechanism: &Arc<Mechanism>, state: &State| {
            let mut speeds = state.speeds.clone();
            Recursive::new(Arc::clone(mechanism))
                .complete_speeds(&state.q, &mut speeds)
                .expect("determined");
            State {
                q: state.q.clone(),
                speeds,
                efforts: state.efforts.clone(),
                rates: state.rates.clone(),
            }
        };
        coupled.agree("coupled", |own, state| all(own, &obeying(own, state)));
        coupled.agree("derivatives, coupled", |own, state| {
            let mut state = obeying(own, state);
            for &speed in own.dependent_speeds() {
                state.rates[speed] = 0.0;
            }
            let mut momenta = vec![0.0; state.speeds.len()];
            let mut recursive = Recursive::new(Arc::clone(own));
            recursive
                .momenta(&state.q, &state.speeds, &mut momenta)
                .expect("fits");
            let mut derivatives = HamiltonianDerivatives::new(own);
            recursive
                .hamiltonian_derivatives(&state.q, &momenta, &state.efforts, &mut derivatives)
                .expect("fits");
            let mut all = matrix(derivatives.rates_by_local());
            all.extend(matrix(derivatives.speeds_by_local()));
            let mut forward = ForwardDerivatives::new(own);
            recursive
                .forward_dynamics_derivatives(&state.q, &state.speeds, &state.efforts, &mut forward)
                .expect("fits");
            all.extend(matrix(forward.by_local()));
            all.extend(matrix(forward.by_speeds()));
            all.extend(matrix(forward.by_efforts()));
            all
        });
    }
}

#[test]
fn inverse_dynamics_and_mass_matrices_agree() {
    for pair in pairs() {
        pair.agree("inverse dynamics, M and its inverse", |own, state| {
            let mut recursive = Recursive::new(Arc::clone(own));
            let mut all = vec![0.0; state.speeds.len()];
            recursive
                .inverse_dynamics(&state.q, &state.speeds, &state.rates, &mut all)
                .expect("fits");
            let mut efforts = vec![0.0; state.efforts.len()];
            recursive
                .joint_efforts(&state.q, &mut efforts)
                .expect("fits");
            all.extend(efforts);
            let mut mass = MassMatrix::new(own);
            recursive.mass_matrix(&state.q, &mut mass).expect("fits");
            all.extend(mass.matrix().as_slice());
            mass.factorize(own).expect("regular");
            let mut rates = state.rates.clone();
            mass.solve(&mut rates).expect("fits");
            all.extend(rates);
            let mut inverse = InverseMassMatrix::new(own);
            recursive
                .inverse_mass_matrix(&state.q, &mut inverse)
                .expect("regular");
            all.extend(inverse.entries());
            let freedoms = state.efforts.len();
            let (mut potential, mut kinetic) = (vec![0.0; freedoms], vec![0.0; freedoms]);
            recursive
                .energy_gradients(&state.q, &state.speeds, &mut potential, &mut kinetic)
                .expect("fits");
            all.extend(potential);
            all.extend(kinetic);
            let mut map = vec![0.0; 6 * state.speeds.len()];
            recursive.centroidal_map(&state.q, &mut map).expect("fits");
            all.extend(map);
            all
        });
    }
}

#[test]
fn frames_of_every_body_agree() {
    for pair in pairs() {
        let with_frames = pair.map(|own| {
            let frames = (0..own.bodies().len()).map(|body| NamedFrame {
                name: format!("tool {body}"),
                body: Some(body),
                at: Pose::from_translation(Vector3::new(0.1, 0.2, 0.3)),
            });
            let frames = frames.collect();
            own.with_frames(frames).expect("fits")
        });
        with_frames.agree("frames", |own, state| {
            let mut recursive = Recursive::new(Arc::clone(own));
            let mut all = Vec::new();
            for frame in 0..own.frames().len() {
                let mobility = recursive
                    .operational_mobility(&state.q, frame, Frame::WorldAligned)
                    .expect("fits");
                all.extend(mobility.as_slice());
            }
            let (k, s) = (state.efforts.len(), state.speeds.len());
            let readings = recursive.readings(&state.q, &state.speeds).expect("fits");
            for frame in 0..own.frames().len() {
                let at = readings.frame(frame).expect("there");
                let (mut jacobian, mut gradient) = (vec![0.0; 6 * s], vec![0.0; 6 * k]);
                at.jacobian(Frame::Body, &mut jacobian).expect("fits");
                all.extend(&jacobian);
                at.twist_gradient(Frame::World, &mut gradient)
                    .expect("fits");
                all.extend(&gradient);
                all.extend(at.jacobian_rate_product(Frame::Body).as_slice());
                all.extend(at.twist(Frame::Body).as_slice());
            }
            all
        });
    }
}

#[test]
fn loaded_mass_matrices_agree() {
    for pair in pairs() {
        pair.agree("(M + W)⁻¹", |own, state| {
            let mut recursive = Recursive::new(Arc::clone(own));
            let mut variations = vec![Variation::zero(); own.variations()];
            let mut slopes = JointSlopes::new(own);
            recursive.stand_loaded(&state.q, &state.speeds, &mut variations, &mut slopes);
            let mut factors = LoadedMass::new(own);
            recursive
                .factorize_loaded(|_, i, j| if i == j { 3.0 } else { 0.0 }, &mut factors)
                .expect("positive");
            let mut x = state.rates.clone();
            recursive.solve_loaded(&mut factors, &mut x);
            x
        });
    }
}

#[test]
fn bodies_of_a_joint_stand_together() {
    let specs = |change: fn(&mut Vec<BodySpec>)| {
        let mut random = Random::new(3);
        let mut specs = Vec::new();
        let first = body("upper", None, arms(), Pose::identity(), mass(&mut random));
        for joint in first.joint.more() {
            let name = "lower".into();
            specs.push(BodySpec {
                name,
                joint,
                ..first.clone()
            });
        }
        specs.insert(0, first);
        change(&mut specs);
        let errors = Mechanism::new(GRAVITY, specs).expect_err("refused");
        errors.to_string()
    };
    let message = specs(|own| own.truncate(1));
    assert!(message.contains("`upper`: its joint `upper joint` carries body `lower` too, which must follow body `upper`"), "{message}");
    let message = specs(|own| own.reverse());
    assert!(message.contains("`lower`: it is body `lower` of joint `upper joint`, and must follow body `upper` of the same joint"), "{message}");
    let message = specs(|own| own[1].placement = Pose::from_translation(Vector3::x()));
    assert!(message.contains("`lower`: its placement is not that of `upper`, the first body of its joint `upper joint`"), "{message}");
}
