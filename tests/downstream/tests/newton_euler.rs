//! Joints with several loops and degrees of freedom, against Newton's and Euler's equations of their bodies with multipliers.
//!
//! The oracle knows where the bodies are and which points and axes hold them together; it shares nothing with the joints' kernels.

use hamel::dynamics::{Dynamics, Recursive, Reference};
use hamel::erased::AnyJoint;
use hamel::integrate::{Form, Method, Options, State, integrate, no_inputs, no_observer};
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::registry::JointRegistry;
use hamel::spatial::{MassProperties, Pose};
use hamel_tests::compiled::{self, Point};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use std::path::Path;
use std::sync::Arc;

/// Where a body's frame is, in the frame of the joint.
type Placed = (Matrix3<f64>, Vector3<f64>);

/// What holds bodies together. A body is a number; none is the ground, whose frame is that of the joint.
#[derive(Clone, Copy)]
enum Held {
    /// A point of each, in its frame, is the same point.
    Pin(Option<usize>, [f64; 3], Option<usize>, [f64; 3]),
    /// Two points keep their distance.
    Rod(Option<usize>, [f64; 3], Option<usize>, [f64; 3]),
    /// An axis of each, in its frame, is at right angles to the other.
    Square(Option<usize>, [f64; 3], Option<usize>, [f64; 3]),
}

/// One of the linkages, with its oracle.
struct Linkage {
    joint: &'static str,
    parameters: &'static [f64],
    /// Poses of the bodies at Q.
    placed: fn(&[f64]) -> Vec<Placed>,
    held: Vec<Held>,
    /// Body and axis of its frame about which it turns at the rate that is a speed.
    driven: Vec<(usize, [f64; 3])>,
    speeds: &'static [f64],
    /// It pulls towards home, about which the linkage then swings.
    gravity: [f64; 3],
}

/// Mass, centre of mass in the body's frame, inertia about it in its axes.
fn inertia(body: usize) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let n = body as f64;
    let centre = Vector3::new(0.05 + 0.01 * n, 0.02, -0.01 * n);
    let moments = Matrix3::new(
        2e-3,
        1e-4,
        0.0,
        1e-4,
        3e-3,
        -2e-4,
        0.0,
        -2e-4,
        2.5e-3 + 1e-4 * n,
    );
    (0.4 + 0.3 * n, centre, moments)
}

fn about(axis: usize, [c, s]: [f64; 2]) -> Matrix3<f64> {
    match axis {
        0 => Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c),
        1 => Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c),
        _ => Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0),
    }
}

fn pair(q: &[f64], n: usize) -> [f64; 2] {
    [q[2 * n], q[2 * n + 1]]
}

/// A pin that a body turns about: the points at both ends of a piece of the axis.
fn hinge(
    first: Option<usize>,
    at: [f64; 3],
    second: Option<usize>,
    other: [f64; 3],
    axis: usize,
) -> [Held; 2] {
    let beside = |mut point: [f64; 3]| {
        point[axis] += 0.3;
        point
    };
    [
        Held::Pin(first, at, second, other),
        Held::Pin(first, beside(at), second, beside(other)),
    ]
}

const FIVE_BAR: [f64; 5] = [0.3, 0.2, 0.3, 0.22, 0.28];

fn five_bar() -> Linkage {
    let [ground, left, left_rod, right, right_rod] = FIVE_BAR;
    let zero = [0.0; 3];
    let held = [
        hinge(None, zero, Some(0), zero, 2),
        hinge(Some(0), [left, 0.0, 0.0], Some(1), zero, 2),
        hinge(None, [ground, 0.0, 0.0], Some(2), zero, 2),
        hinge(Some(2), [right, 0.0, 0.0], Some(3), zero, 2),
        hinge(
            Some(1),
            [left_rod, 0.0, 0.0],
            Some(3),
            [right_rod, 0.0, 0.0],
            2,
        ),
    ];
    Linkage {
        joint: "five_bar",
        parameters: &FIVE_BAR,
        placed: |q| {
            let turned: Vec<Matrix3<f64>> = (0..4).map(|n| about(2, pair(q, n))).collect();
            let [ground, left, _, right, _] = FIVE_BAR;
            let pin = Vector3::new(ground, 0.0, 0.0);
            let at = [
                Vector3::zeros(),
                turned[0] * Vector3::x() * left,
                pin,
                pin + turned[2] * Vector3::x() * right,
            ];
            turned.into_iter().zip(at).collect()
        },
        held: held.concat(),
        driven: vec![(0, [0.0, 0.0, 1.0]), (2, [0.0, 0.0, 1.0])],
        speeds: &[0.6, -0.4],
        gravity: [0.2, 5.0, 0.5],
    }
}

const ANKLE: [f64; 5] = [0.25, 0.04, 0.05, 0.06, 0.26];

fn parallel_ankle() -> Linkage {
    let [height, half, crank, heel, _] = ANKLE;
    let zero = [0.0; 3];
    let mut held = vec![];
    for (n, side) in [(0, half), (1, -half)] {
        held.extend(hinge(None, [0.0, side, height], Some(n), zero, 1));
        held.push(Held::Rod(
            Some(n),
            [-crank, 0.0, 0.0],
            Some(2),
            [-heel, side, 0.0],
        ));
    }
    held.push(Held::Pin(None, zero, Some(2), zero));
    held.push(Held::Square(
        None,
        [0.0, 1.0, 0.0],
        Some(2),
        [1.0, 0.0, 0.0],
    ));
    Linkage {
        joint: "parallel_ankle",
        parameters: &ANKLE,
        placed: |q| {
            let [height, half, ..] = ANKLE;
            let foot = about(1, pair(q, 2)) * about(0, pair(q, 3));
            vec![
                (about(1, pair(q, 0)), Vector3::new(0.0, half, height)),
                (about(1, pair(q, 1)), Vector3::new(0.0, -half, height)),
                (foot, Vector3::zeros()),
            ]
        },
        held,
        driven: vec![(0, [0.0, 1.0, 0.0]), (1, [0.0, 1.0, 0.0])],
        speeds: &[0.5, -0.3],
        gravity: [6.0, 0.5, 0.4],
    }
}

const WISHBONE: [f64; 6] = [0.35, 0.28, 0.25, 0.26, 0.34, 0.1];

fn wishbone() -> Linkage {
    let [lower, upper, height, upright, _, behind] = WISHBONE;
    let zero = [0.0; 3];
    let arms = [
        hinge(None, zero, Some(0), zero, 0),
        hinge(None, [0.0, 0.0, height], Some(1), zero, 0),
    ];
    let mut held = arms.concat();
    held.push(Held::Pin(Some(0), [0.0, lower, 0.0], Some(2), zero));
    held.push(Held::Pin(
        Some(1),
        [0.0, upper, 0.0],
        Some(2),
        [0.0, 0.0, upright],
    ));
    let end = [-behind, 0.0, 0.0];
    held.push(Held::Rod(None, end, Some(2), end));
    Linkage {
        joint: "wishbone",
        parameters: &WISHBONE,
        placed: |q| {
            let [lower, _, height, ..] = WISHBONE;
            let arm = about(0, pair(q, 0));
            let entries: Vec<f64> = q[4..13].to_vec();
            vec![
                (arm, Vector3::zeros()),
                (about(0, pair(q, 1)), Vector3::new(0.0, 0.0, height)),
                (
                    Matrix3::from_row_slice(&entries),
                    arm * Vector3::y() * lower,
                ),
            ]
        },
        held,
        driven: vec![(0, [1.0, 0.0, 0.0])],
        speeds: &[0.4],
        gravity: [0.3, 6.0, 0.5],
    }
}

fn mechanism(linkage: &Linkage) -> Arc<Mechanism> {
    let mut registry = JointRegistry::new();
    registry
        .extend(hamel_downstream::joints::ENTRIES.iter().copied())
        .expect("distinct names");
    let entry = registry.get(linkage.joint).expect("registered");
    let first = (entry.build)(linkage.parameters).expect("it closes");
    let names = AnyJoint::<f64>::bodies(&*first);
    let joints = std::iter::once(first.clone()).chain(first.more());
    let bodies = names.iter().zip(joints).enumerate();
    let bodies = bodies.map(|(n, (name, joint))| {
        let (mass, centre, moments) = inertia(n);
        BodySpec {
            name: (*name).into(),
            joint_name: "linkage".into(),
            parent: None,
            joint,
            placement: Pose::identity(),
            child_placement: Pose::identity(),
            mass: MassProperties::new(mass, centre, moments).expect("valid"),
        }
    });
    let mechanism = Mechanism::new(Vector3::from(linkage.gravity), bodies.collect());
    Arc::new(mechanism.unwrap_or_else(|errors| panic!("{errors:?}")))
}

/// The bodies at one configuration.
struct Bodies {
    placed: Vec<Placed>,
}

/// Six numbers of a body each: angular velocity, and velocity of the centre of mass.
fn six(motion: &DVector<f64>, body: usize) -> (Vector3<f64>, Vector3<f64>) {
    let part = |n: usize| Vector3::new(motion[n], motion[n + 1], motion[n + 2]);
    (part(6 * body), part(6 * body + 3))
}

impl Bodies {
    fn centre(&self, body: usize) -> Vector3<f64> {
        let (rotation, at) = self.placed[body];
        at + rotation * inertia(body).1
    }

    fn point(&self, body: Option<usize>, point: [f64; 3]) -> Vector3<f64> {
        let point = Vector3::from(point);
        body.map_or(point, |n| self.placed[n].1 + self.placed[n].0 * point)
    }

    fn axis(&self, body: Option<usize>, axis: [f64; 3]) -> Vector3<f64> {
        let axis = Vector3::from(axis);
        body.map_or(axis, |n| self.placed[n].0 * axis)
    }

    /// Rows by which the velocity of a point in a direction follows from all motions.
    fn row(&self, body: Option<usize>, at: Vector3<f64>, along: Vector3<f64>) -> DVector<f64> {
        let mut row = DVector::zeros(6 * self.placed.len());
        if let Some(n) = body {
            let lever = at - self.centre(n);
            row.fixed_rows_mut::<3>(6 * n)
                .copy_from(&lever.cross(&along));
            row.fixed_rows_mut::<3>(6 * n + 3).copy_from(&along);
        }
        row
    }

    fn turn(&self, body: Option<usize>, along: Vector3<f64>) -> DVector<f64> {
        let mut row = DVector::zeros(6 * self.placed.len());
        if let Some(n) = body {
            row.fixed_rows_mut::<3>(6 * n).copy_from(&along);
        }
        row
    }

    fn speed(&self, body: Option<usize>, at: Vector3<f64>, motion: &DVector<f64>) -> Vector3<f64> {
        body.map_or(Vector3::zeros(), |n| {
            let (omega, v) = six(motion, n);
            v + omega.cross(&(at - self.centre(n)))
        })
    }

    /// The acceleration of a point without those of its body.
    fn inward(&self, body: Option<usize>, at: Vector3<f64>, motion: &DVector<f64>) -> Vector3<f64> {
        body.map_or(Vector3::zeros(), |n| {
            let (omega, _) = six(motion, n);
            omega.cross(&omega.cross(&(at - self.centre(n))))
        })
    }

    /// Rows G with `G motion = 0`, and `−Ġ motion` at a motion: what `G acceleration` is.
    fn rows(&self, held: &[Held], motion: &DVector<f64>) -> (Vec<DVector<f64>>, Vec<f64>) {
        let (mut rows, mut right) = (vec![], vec![]);
        for held in held {
            match *held {
                Held::Pin(a, of_a, b, of_b) => {
                    let (at, other) = (self.point(a, of_a), self.point(b, of_b));
                    let bias = self.inward(b, other, motion) - self.inward(a, at, motion);
                    for n in 0..3 {
                        let along = Vector3::ith(n, 1.0);
                        rows.push(self.row(a, at, along) - self.row(b, other, along));
                        right.push(bias[n]);
                    }
                }
                Held::Rod(a, of_a, b, of_b) => {
                    let (at, other) = (self.point(a, of_a), self.point(b, of_b));
                    let along = at - other;
                    let bias = self.inward(b, other, motion) - self.inward(a, at, motion);
                    let apart = self.speed(a, at, motion) - self.speed(b, other, motion);
                    rows.push(self.row(a, at, along) - self.row(b, other, along));
                    right.push(along.dot(&bias) - apart.norm_squared());
                }
                Held::Square(a, of_a, b, of_b) => {
                    let (u, w) = (self.axis(a, of_a), self.axis(b, of_b));
                    let omega = |n: Option<usize>| n.map_or(Vector3::zeros(), |n| six(motion, n).0);
                    let (of_u, of_w) = (omega(a), omega(b));
                    let [turned, tipped] = [of_u.cross(&u), of_w.cross(&w)];
                    let bias = of_u.cross(&turned).dot(&w)
                        + 2.0 * turned.dot(&tipped)
                        + of_w.cross(&tipped).dot(&u);
                    rows.push(self.turn(a, u.cross(&w)) - self.turn(b, u.cross(&w)));
                    right.push(-bias);
                }
            }
        }
        (rows, right)
    }
}

/// Singular values below this part of the largest one are those of pins that hold the same direction twice.
const REDUNDANT: f64 = 1e-9;

fn solved(rows: &[DVector<f64>], right: &[f64]) -> DVector<f64> {
    let rows: Vec<_> = rows.iter().map(DVector::transpose).collect();
    let matrix = DMatrix::from_rows(&rows);
    let svd = matrix.svd(true, true);
    let cut = REDUNDANT * svd.singular_values.max();
    let right = DVector::from_column_slice(right);
    svd.solve(&right, cut).expect("both sides are there")
}

/// The accelerations of the speeds, by Newton's and Euler's equations with multipliers.
fn with_multipliers(linkage: &Linkage, q: &[f64], speeds: &[f64]) -> Vec<f64> {
    let bodies = Bodies {
        placed: (linkage.placed)(q),
    };
    let size = 6 * bodies.placed.len();
    let driven: Vec<DVector<f64>> = linkage
        .driven
        .iter()
        .map(|&(n, axis)| bodies.turn(Some(n), bodies.axis(Some(n), axis)))
        .collect();
    let (rows, _) = bodies.rows(&linkage.held, &DVector::zeros(size));
    let zeros = vec![0.0; rows.len()];
    let motion = solved(
        &[rows.clone(), driven.clone()].concat(),
        &[&zeros[..], speeds].concat(),
    );
    let (rows, bias) = bodies.rows(&linkage.held, &motion);
    // [M Gᵀ; G 0] [acceleration; −λ] = [forces; bias].
    let whole = size + rows.len();
    let mut equations = vec![DVector::zeros(whole); whole];
    let mut right = vec![0.0; whole];
    for n in 0..bodies.placed.len() {
        let (mass, _, moments) = inertia(n);
        let rotation = bodies.placed[n].0;
        let moments = rotation * moments * rotation.transpose();
        let (omega, _) = six(&motion, n);
        let torque = -omega.cross(&(moments * omega));
        for i in 0..3 {
            for j in 0..3 {
                equations[6 * n + i][6 * n + j] = moments[(i, j)];
            }
            equations[6 * n + 3 + i][6 * n + 3 + i] = mass;
            right[6 * n + i] = torque[i];
            right[6 * n + 3 + i] = mass * linkage.gravity[i];
        }
    }
    for (r, row) in rows.iter().enumerate() {
        for i in 0..size {
            equations[i][size + r] = row[i];
            equations[size + r][i] = row[i];
        }
        right[size + r] = bias[r];
    }
    let found = solved(&equations, &right);
    let acceleration = DVector::from_fn(size, |i, _| found[i]);
    // An axis about which a body turns against the ground does not move.
    driven.iter().map(|row| row.dot(&acceleration)).collect()
}

fn run(linkage: &Linkage, mechanism: &Arc<Mechanism>, form: Form, t_end: f64) -> Vec<State> {
    let initial = State {
        time: 0.0,
        configuration: mechanism.home(),
        speeds: linkage.speeds.to_vec(),
    };
    let count = (4.0 * t_end) as u32;
    let options = Options {
        form,
        method: Method::dormand_prince(1e-11),
        t_end,
        samples: (1..count).map(|n| f64::from(n) / 4.0).collect(),
    };
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let (inputs, observer) = (&mut no_inputs, &mut no_observer);
    let solution = integrate(&mut dynamics, &initial, &options, inputs, observer);
    let solution = solution.unwrap_or_else(|error| panic!("{}: {error}", linkage.joint));
    let mut states = vec![initial];
    states.extend(solution.samples.iter().cloned());
    states.push(solution.state);
    states
}

#[test]
fn accelerations_are_those_with_multipliers() {
    for linkage in [five_bar(), parallel_ankle(), wishbone()] {
        let mechanism = mechanism(&linkage);
        let mut recursive = Recursive::new(Arc::clone(&mechanism));
        let mut reference = Reference::new(Arc::clone(&mechanism));
        for state in run(&linkage, &mechanism, Form::Lagrangian, 2.0) {
            let expected = with_multipliers(&linkage, &state.configuration, &state.speeds);
            let all: [&mut dyn Dynamics; 2] = [&mut recursive, &mut reference];
            for dynamics in all {
                let efforts = vec![0.0; expected.len()];
                let mut found = efforts.clone();
                dynamics
                    .forward_dynamics(&state.configuration, &state.speeds, &efforts, &mut found)
                    .expect("regular");
                for (found, expected) in found.iter().zip(&expected) {
                    // Singular values of the oracle's matrix lie between 1e-4 and 10, its entries and those of the right side have errors
                    // of an ulp: 1e5 of these.
                    let allowed = 3e-11 * expected.abs().max(1.0);
                    let apart = (found - expected).abs();
                    assert!(
                        apart < allowed,
                        "{}: {found} and {expected} at {state:?}",
                        linkage.joint
                    );
                }
            }
        }
    }
}

#[test]
fn energy_and_relations_are_kept() {
    for linkage in [five_bar(), parallel_ankle(), wishbone()] {
        let mechanism = mechanism(&linkage);
        let energy = |state: &State| {
            let kinematics = mechanism.kinematics(&state.configuration, &state.speeds);
            kinematics.expect("sizes fit").energy()
        };
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let states = run(&linkage, &mechanism, form, 10.0);
            let first = energy(&states[0]);
            for state in &states {
                let own = mechanism.bodies()[0].joint();
                let residual = own.residual(&state.configuration);
                assert!(
                    residual < 4e-15,
                    "{}, {form:?}: {residual:e}",
                    linkage.joint
                );
                // The tolerance of 1e-11 a step, some thousands of them.
                let drift = (energy(state) - first).abs();
                assert!(drift < 1e-7, "{}, {form:?}: {drift:e}", linkage.joint);
            }
        }
    }
}

/// Values and derivatives of compiled equations, in which names of B are common to all kernels.
#[test]
fn compiled_scenes_have_the_values_of_the_tree() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("joints");
    for linkage in [five_bar(), parallel_ankle(), wishbone()] {
        let mechanism = mechanism(&linkage);
        let joint = compiled::joint_in(&folder, linkage.joint);
        let joints = |name: &str| (name == linkage.joint).then(|| joint.clone());
        let model = compiled::model_on(linkage.joint, &mechanism, joints);
        for (seed, state) in run(&linkage, &mechanism, Form::Lagrangian, 1.0)
            .into_iter()
            .enumerate()
        {
            let at = || {
                let q = state.configuration.clone();
                Point::at(model.clone(), &mechanism, q, seed as u64)
            };
            at().agrees();
            at().derivatives_agree();
        }
    }
}
