//! Links that close loops: one joint of several bodies is the tree of its links with the relations as constraints.
//!
//! In the tree every link has a joint of its own. Accelerations q̈ of the closed joint are those that the tree has under constraint forces: `M q̈ + h = τ + Jᵀ λ`, `J q̈ = −J̇ q̇`, with J of the tree's own frames.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::{GRAVITY, body, mass};
use hamel_runtime::dynamics::{Dynamics, Frame, MassMatrix, Recursive, Reference};
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::joint::{Link, LinkMotion, Port, Relation, Tie, closed};
use hamel_runtime::mechanism::{BodySpec, Mechanism, NamedFrame};
use hamel_runtime::spatial::{Pose, so3};
use nalgebra::{DMatrix, DVector, Matrix6xX, Vector3};
use std::sync::Arc;

const PORTS: [Port; 4] = [Port {
    name: "y",
    unit: "rad",
    wraps: false,
}; 4];

/// A linkage: links, each a turn, what closes them, and a guess from which it closes.
struct Linkage {
    name: &'static str,
    links: Vec<Link>,
    tie: Tie,
    guess: Vec<f64>,
}

fn at(position: [f64; 3], turn: [f64; 3]) -> Pose<f64> {
    Pose::new(so3::exp(&Vector3::from(turn)), Vector3::from(position))
}

fn link(before: Option<usize>, frame: Pose<f64>, coordinate: usize) -> Link {
    Link {
        before,
        frame,
        motion: LinkMotion::Turn,
        coordinate,
        ratio: 1.0,
        offset: 0.0,
    }
}

/// A planar four-bar of crank 0.2, coupler 0.5, rocker 0.4 and ground 0.45, driven at its crank.
fn four_bar() -> Linkage {
    use Relation::{Meets, Square};
    Linkage {
        name: "four-bar",
        links: vec![
            link(None, at([0.1, 0.0, 0.3], [0.0; 3]), 0),
            link(Some(0), at([0.2, 0.0, 0.0], [0.0; 3]), 1),
            link(None, at([0.55, 0.0, 0.3], [0.0; 3]), 2),
        ],
        tie: Tie::Closure {
            links: [Some(1), Some(2)],
            frames: [at([0.5, 0.0, 0.0], [0.0; 3]), at([0.4, 0.0, 0.0], [0.0; 3])],
            relations: vec![Meets(0), Meets(1)],
            implied: vec![Meets(2), Square(0, 2), Square(1, 2)],
        },
        guess: vec![0.9, -0.6, 1.6],
    }
}

/// A crank and a rocker about skew axes, and a rod between them, on a cross at the crank and a ball at the rocker.
fn rssr() -> Linkage {
    use Relation::Meets;
    let quarter = std::f64::consts::FRAC_PI_2;
    Linkage {
        name: "RSSR",
        links: vec![
            link(None, at([0.0; 3], [0.3, 0.1, 0.0]), 0),
            link(Some(0), at([0.15, 0.0, 0.02], [quarter, 0.0, 0.0]), 1),
            link(Some(1), at([0.0; 3], [0.0, quarter, 0.2]), 2),
            link(None, at([0.5, 0.1, 0.0], [0.0, 1.1, 0.3]), 3),
        ],
        tie: Tie::Closure {
            links: [Some(2), Some(3)],
            frames: [
                at([0.1, 0.5, 0.0], [0.0; 3]),
                at([0.35, 0.0, 0.0], [0.0; 3]),
            ],
            relations: vec![Meets(0), Meets(1), Meets(2)],
            implied: vec![],
        },
        guess: vec![0.4, -2.0, -0.35, 1.3],
    }
}

impl Linkage {
    /// The guess with its dependent coordinates moved until it closes, by steps of finite differences.
    fn start(&self) -> Vec<f64> {
        let mut q = self.guess.clone();
        for _ in 0..50 {
            let (mut values, mut rows) = (vec![], vec![]);
            self.tie
                .relations(&self.links, &q, |(value, slopes): (f64, _)| {
                    values.push(value);
                    rows.extend_from_slice(&slopes[1..q.len()]);
                });
            let slopes = DMatrix::from_row_slice(values.len(), q.len() - 1, &rows);
            let step = slopes
                .lu()
                .solve(&DVector::from_vec(values))
                .expect("regular");
            (1..q.len()).for_each(|k| q[k] -= step[k - 1].clamp(-0.3, 0.3));
        }
        q
    }

    fn joint(&self) -> Arc<dyn AnyJoint> {
        let ports = &PORTS[..self.links.len()];
        let tie = std::slice::from_ref(&self.tie);
        let joint = closed(&self.links, tie, &self.start(), ports);
        joint.unwrap_or_else(|fault| panic!("{}: {fault}", self.name))
    }

    /// The closed linkage, and the tree with frames P and S at its ends.
    fn pair(&self) -> [Arc<Mechanism>; 2] {
        let mut random = Random::new(7);
        let joint = self.joint();
        let all = std::iter::once(Arc::clone(&joint)).chain(joint.more());
        let (mut together, mut apart) = (vec![], vec![]);
        for (number, (link, own)) in self.links.iter().zip(all).enumerate() {
            let name = format!("link {number}");
            let mut spec = body(&name, None, own, Pose::identity(), mass(&mut random));
            spec.joint_name = "linkage".into();
            spec.child_placement = Pose::identity();
            apart.push(BodySpec {
                joint_name: name,
                parent: link.before,
                placement: link.frame,
                joint: joints::revolute(),
                ..spec.clone()
            });
            together.push(spec);
        }
        let Tie::Closure { links, frames, .. } = &self.tie else {
            panic!("it closes");
        };
        let frames = ["P", "S"].iter().zip(links).zip(frames);
        let frames = frames.map(|((name, body), at)| NamedFrame {
            name: (*name).into(),
            body: *body,
            at: *at,
        });
        let [together, apart] =
            [together, apart].map(|bodies| Mechanism::new(GRAVITY, bodies).expect("valid"));
        let apart = apart.with_frames(frames.collect()).expect("they fit");
        [together, apart].map(Arc::new)
    }
}

/// J and J̇ q̇ of the velocity of the origin of S relative to P, in world axes, as far as its rows are independent; with `planar` in the x–y plane.
fn constraint(
    tree: &Arc<Mechanism>,
    (q, rates): (&[f64], &[f64]),
    planar: bool,
) -> (DMatrix<f64>, DVector<f64>) {
    let size = tree.layout().speeds;
    let mut recursive = Recursive::new(Arc::clone(tree));
    let readings = recursive.readings(q, rates).expect("sizes fit");
    let [first, second] = [0, 1].map(|index| {
        let frame = readings.frame(index).expect("a frame");
        let mut jacobian = Matrix6xX::zeros(size);
        frame
            .jacobian(Frame::WorldAligned, jacobian.as_mut_slice())
            .expect("sizes fit");
        (jacobian, frame.jacobian_rate_product(Frame::WorldAligned))
    });
    let rows = if planar { 2 } else { 3 };
    let jacobian = DMatrix::from_fn(rows, size, |i, k| {
        second.0[(3 + i, k)] - first.0[(3 + i, k)]
    });
    let bias = DVector::from_fn(rows, |i, _| second.1[3 + i] - first.1[3 + i]);
    (jacobian, bias)
}

/// Rounding of some ten products and solves of matrices with conditions below 1e3.
const ROUNDING: f64 = 1e-12;

/// Rounding of sums of terms below 1 m, and of their squares.
const CLOSED: f64 = 1e-15;

#[track_caller]
fn close(what: &str, found: &DVector<f64>, expected: &DVector<f64>) {
    let error = (found - expected).amax() / (1.0 + expected.amax());
    assert!(error <= ROUNDING, "{what}: {error:e}\n{found}{expected}");
}

#[test]
fn a_closed_loop_is_the_tree_with_its_constraint() {
    for linkage in [four_bar(), rssr()] {
        let [closed, tree] = linkage.pair();
        let home = closed.home();
        let mut q = home.clone();
        for step in 0..8 {
            let start = q.clone();
            closed.bodies()[0].joint().retract(&start, &[0.23], &mut q);
            let speeds = [1.3 - 0.4 * f64::from(step)];
            let mut rates = vec![0.0; q.len()];
            closed.bodies()[0]
                .joint()
                .configuration_rate(&q, &speeds, &mut rates);
            let (jacobian, bias) = constraint(&tree, (&q, &rates), linkage.name == "four-bar");
            let broken = (&jacobian * DVector::from_column_slice(&rates)).amax();
            assert!(
                broken < ROUNDING,
                "{}: the loop opens at {broken:e}",
                linkage.name
            );
            // M q̈ − Jᵀ λ = τ − h.
            let mut recursive = Recursive::new(Arc::clone(&tree));
            let mut matrix = MassMatrix::new(&tree);
            recursive.mass_matrix(&q, &mut matrix).expect("finite");
            let (n, c) = (q.len(), bias.len());
            let mut forces = vec![0.0; n];
            recursive
                .inverse_dynamics(&q, &rates, &vec![0.0; n], &mut forces)
                .expect("finite");
            let mut whole = DMatrix::zeros(n + c, n + c);
            whole.view_mut((0, 0), (n, n)).copy_from(&matrix.matrix());
            whole
                .view_mut((0, n), (n, c))
                .copy_from(&jacobian.transpose());
            whole.view_mut((n, 0), (c, n)).copy_from(&jacobian);
            let side = DVector::from_fn(n + c, |i, _| match i {
                0 => 0.7 - forces[0],
                _ if i < n => -forces[i],
                _ => -bias[i - n],
            });
            let expected = whole.lu().solve(&side).expect("regular")[0];
            let forms: [Box<dyn Dynamics>; 2] = [
                Box::new(Recursive::new(Arc::clone(&closed))),
                Box::new(Reference::new(Arc::clone(&closed))),
            ];
            for mut form in forms {
                let mut found = [0.0];
                form.forward_dynamics(&q, &speeds, &[0.7], &mut found)
                    .expect("regular");
                close(
                    linkage.name,
                    &DVector::from_column_slice(&found),
                    &DVector::from_element(1, expected),
                );
            }
        }
    }
}

/// Derivatives of the kernels along Φ, by differences; and bodies where the tree has them.
#[test]
fn kernels_are_those_of_the_poses() {
    for linkage in [four_bar(), rssr()] {
        let joint = linkage.joint();
        let all: Vec<_> = std::iter::once(Arc::clone(&joint))
            .chain(joint.more())
            .collect();
        let q = linkage.start();
        let moved = |phi: f64| {
            let mut moved = vec![0.0; q.len()];
            joint.retract(&q, &[phi], &mut moved);
            assert!(
                joint.residual(&moved) < CLOSED,
                "{}",
                joint.residual(&moved)
            );
            moved
        };
        for body in &all {
            // Central differences of fourth order: their errors are those of rounding, 1e-16 over the step, times some ten.
            const STEP: f64 = 3e-4;
            let difference = |of: &dyn Fn(f64) -> Vec<f64>| {
                let at = [-2.0, -1.0, 1.0, 2.0].map(|n| of(n * STEP));
                let entry = |i: usize| {
                    (8.0 * (at[2][i] - at[1][i]) - (at[3][i] - at[0][i])) / (12.0 * STEP)
                };
                (0..at[0].len()).map(entry).collect::<Vec<f64>>()
            };
            let pose = |phi: f64| body.pose(&moved(phi)).matrix().as_slice().to_vec();
            let rate = nalgebra::Matrix4::from_column_slice(&difference(&pose));
            let local = body.pose(&q).inverse().matrix() * rate;
            let expected = [
                local[(2, 1)],
                local[(0, 2)],
                local[(1, 0)],
                local[(0, 3)],
                local[(1, 3)],
                local[(2, 3)],
            ];
            let map = |phi: f64| {
                let mut map = vec![0.0; 6];
                body.twist_map_child(&moved(phi), &mut map);
                map
            };
            let mut gradient = vec![0.0; 6];
            body.twist_map_child_gradient(&q, &mut gradient);
            let bias = body.bias_acceleration(&q, &[1.5]);
            let slope = difference(&map);
            for i in 0..6 {
                assert!(
                    (map(0.0)[i] - expected[i]).abs() < 1e-11,
                    "{}",
                    linkage.name
                );
                assert!(
                    (gradient[i] - slope[i]).abs() < 1e-11,
                    "{}: {} {}",
                    linkage.name,
                    gradient[i],
                    slope[i]
                );
                assert!(
                    (bias[i] - 2.25 * gradient[i]).abs() < 1e-13,
                    "{}",
                    linkage.name
                );
            }
            let h = nalgebra::Vector6::from_fn(|i, _| 0.3 + i as f64);
            let mut dual = [0.0];
            body.bias_momentum(&q, &[1.5], &h, &mut dual);
            let expected: f64 = (0..6).map(|i| 1.5 * gradient[i] * h[i]).sum();
            assert!((dual[0] - expected).abs() < 1e-13 * (1.0 + expected.abs()));
        }
    }
}

/// At the end of a rocker that cannot turn further Φ has no value, and the joint says how near it is.
#[test]
fn a_linkage_ends_where_its_dependent_coordinates_do_not_follow() {
    let mut linkage = four_bar();
    // The rocker leads, which swings between two dead points.
    for link in &mut linkage.links {
        link.coordinate = [2, 1, 0][link.coordinate];
    }
    let mut start = four_bar().start();
    start.reverse();
    let joint = closed(&linkage.links, &[linkage.tie.clone()], &start, &PORTS[..3]);
    let joint: Arc<dyn AnyJoint> = joint.expect("it closes");
    let mut moved = vec![0.0; 3];
    let left = [-0.01, 0.0, 0.01].map(|phi| {
        joint.retract(&start, &[phi], &mut moved);
        let residual = joint.residual(&moved);
        assert!(residual < CLOSED, "{phi}: {residual:e}");
        joint.singularity(&moved)
    });
    assert!(left[0] < left[1] && left[1] < left[2] || left[0] > left[1] && left[1] > left[2]);
    for phi in [-1.5, 1.5] {
        joint.retract(&start, &[phi], &mut moved);
        assert!(moved.iter().all(|q| q.is_nan()), "{moved:?}");
    }
    assert_eq!(joint.singularities().len(), 1);
}

/// A parallelogram that begins nearly folded ends by its own size, and one that begins folded except for half of the digits is refused.
#[test]
fn a_linkage_ends_before_it_loses_half_of_its_digits() {
    use Relation::Meets;
    let links = [
        link(None, at([0.0; 3], [0.0; 3]), 0),
        link(Some(0), at([0.2, 0.0, 0.0], [0.0; 3]), 1),
        link(None, at([0.5, 0.0, 0.0], [0.0; 3]), 2),
    ];
    let tie = Tie::Closure {
        links: [Some(1), Some(2)],
        frames: [at([0.5, 0.0, 0.0], [0.0; 3]), at([0.2, 0.0, 0.0], [0.0; 3])],
        relations: vec![Meets(0), Meets(1)],
        implied: vec![],
    };
    let begin = |angle: f64| {
        let start = [angle, -angle, angle];
        closed(&links, std::slice::from_ref(&tie), &start, &PORTS[..3]).map(|joint| (joint, start))
    };
    // What both dependent angles do to the relations is at the angle of the crank. It ends at ε^(1/4) of that, or at ε^(1/6) of its beginning.
    for (angle, there, is_on) in [
        (1e-3, 1.5e-4, true),
        (1e-3, 1e-4, false),
        (2e-4, 1.5e-4, true),
        (0.5, 1.3e-3, true),
        (0.5, 1.1e-3, false),
    ] {
        let (joint, mut q) = begin(angle).expect("it closes");
        let mut moved = q;
        // By parts, as Φ is found from near it.
        while !moved[1].is_nan() && q[0] > there {
            let step = f64::max(0.7 * q[0], there) - q[0];
            joint.retract(&q, &[step], &mut moved);
            q = moved;
        }
        assert_eq!(
            !moved[1].is_nan(),
            is_on,
            "from {angle} to {there}: {moved:?}"
        );
    }
    for angle in [1e-4, 1e-8, 0.0] {
        let fault = begin(angle).expect_err("it is folded").to_string();
        assert_eq!(
            fault,
            "coupled links: at the start the dependent coordinates do not follow from the others",
            "{angle}"
        );
    }
}

/// What is done to links, a tie and a start that are sound.
type Change<'c> = &'c dyn Fn(&mut Vec<Link>, &mut Tie, &mut Vec<f64>);

/// Each fault with its message.
#[test]
fn ties_that_make_no_joint_are_refused() {
    let linkage = four_bar();
    let start = linkage.start();
    let fault = |change: Change<'_>| {
        let (mut links, mut tie, mut start) =
            (linkage.links.clone(), linkage.tie.clone(), start.clone());
        change(&mut links, &mut tie, &mut start);
        let fault = closed(&links, &[tie], &start, &PORTS[..3]).expect_err("a fault");
        fault.to_string()
    };
    let relations = |tie: &mut Tie, own: &[Relation]| {
        if let Tie::Closure { relations, .. } = tie {
            *relations = own.to_vec();
        }
    };
    use Relation::{Meets, Square};
    assert_eq!(
        fault(&|_, tie, _| relations(tie, &[Meets(0), Meets(1), Meets(2)])),
        "coupled links: 3 relations leave 0 coordinates independent: a joint has 1 to 6 independent coordinates and 1 to 12 relations, and at most 16 of both together"
    );
    assert_eq!(
        fault(&|_, tie, _| relations(tie, &[Meets(0), Square(3, 0)])),
        "coupled links: tie 0: its numbers must be finite, its frames poses, and its axes 0, 1 or 2"
    );
    assert_eq!(
        fault(&|_, tie, _| relations(tie, &[Meets(0), Meets(2)])),
        "coupled links: at the start the dependent coordinates do not follow from the others"
    );
    assert_eq!(
        fault(&|_, tie, _| *tie = Tie::Sum {
            terms: vec![(5, 1.0)],
            constant: 0.0
        }),
        "coupled links: tie 0 is of link 5, and there are 3"
    );
    assert_eq!(
        fault(&|_, _, start| _ = start.pop()),
        "coupled links: 2 coordinates of the start, not one a coordinate"
    );
    assert!(
        fault(&|_, _, start| start[1] += 0.1)
            .starts_with("coupled links: at the start the ties are 0.04")
    );
    assert_eq!(
        fault(&|links, _, _| links[0].coordinate = 7),
        "coupled links: they follow 8 coordinates, and must follow 1 to 4"
    );
}
