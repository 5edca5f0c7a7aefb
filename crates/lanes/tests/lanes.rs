//! Rows side by side against the same rows by the tree, and against themselves in other company.

use hamel_lanes::{Lanes, Plan, Ways, sample};
use hamel_sweep::{Cells, Movers, Outcome, Row, Sweep, Watch};

/// Largest difference between side by side and the tree, as a part of max(1, size). Both take the same steps of the same method, and round the equations of motion in another order: some 100 roundings of
/// 1.1e-16 an evaluation, of which a step of length h keeps h times as much. Over a second that is 1e-14; the motions here make at most some thousand times as much of it.
const ROUNDING: f64 = 1e-11;

fn described(bodies: &str) -> String {
    format!(
        "hamel = 1\ngravity = [0.3, 0.0, -9.81]\n{bodies}\n[simulation]\nmethod = \"rk4\"\ndt = 0.004\nt_end = 1.0\n"
    )
}

fn body(name: &str, parent: &str, joint: &str, more: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\nmass = 1.3\ninertia = [[0.02, 0.001, 0.0], [0.001, 0.03, -0.002], [0.0, -0.002, 0.025]]\n\
         joint = {joint}\n{more}\n"
    )
}

const PENDULUM: &str = "at = { position = [0.1, 0.0, 0.3], rotation_vector = [1.2, 0.1, 0.0] }\nbody_at = { position = [0.2, 0.05, 0.0] }\n\
                        initial = { configuration = [0.4], speeds = [0.7] }";

fn double_pendulum() -> String {
    let lower = "at = { position = [0.4, 0.0, 0.0] }\nbody_at = { position = [0.2, 0.0, 0.1] }\ninitial = { configuration = [-0.9], speeds = [0.0] }";
    described(
        &(body("upper", "world", "{ type = \"revolute\" }", PENDULUM)
            + &body("lower", "upper", "{ type = \"revolute\" }", lower)),
    )
}

/// Rows that move all columns by some of their numbers.
fn rows(starts: &[f64], count: usize) -> Vec<Cells> {
    let row = |number: usize| {
        let cell = |(place, start): (usize, &f64)| {
            start * (1.0 + 0.1 * (1.0 + 2.3 * number as f64 + 0.7 * place as f64).sin())
        };
        Cells::from(starts.iter().enumerate().map(cell).collect::<Vec<f64>>())
    };
    (0..count).map(row).collect()
}

fn swept(text: &str, columns: &[&str]) -> Sweep {
    Sweep::new(text, "scene.toml", columns, &hamel_sweep::joints())
        .expect("a scene and its columns")
}

fn side_by_side(sweep: &Sweep, sample: &[Cells], rows: &[Cells]) -> (Vec<Row>, Ways) {
    let joints = hamel_sweep::joints();
    let plan = Plan::new(sweep, &joints, sample).expect("a sweep that goes side by side");
    let lanes = Lanes::new(sweep, &joints, plan);
    let moved = lanes
        .mover()
        .rows(rows, Watch::NONE)
        .expect("nobody stops it");
    (moved, lanes.ways())
}

/// The largest difference from the tree, as a part of max(1, size).
fn difference(sweep: &Sweep, rows: &[Cells], moved: &[Row]) -> f64 {
    let joints = hamel_sweep::joints();
    let mut most = 0.0_f64;
    for (cells, own) in rows.iter().zip(moved) {
        let tree = sweep.motion(cells, &joints);
        assert_eq!(own.outcome, tree.outcome);
        if own.outcome != Outcome::Ended {
            continue;
        }
        for ((name, a), b) in sweep.results().iter().zip(&own.numbers).zip(&tree.numbers) {
            let part = (a - b).abs() / b.abs().max(1.0);
            assert!(
                part < ROUNDING,
                "{name}: {a:e} side by side, {b:e} by the tree"
            );
            most = most.max(part);
        }
    }
    most
}

fn check(name: &str, text: &str, columns: &[(&str, f64)]) {
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let starts: Vec<f64> = columns.iter().map(|(_, start)| *start).collect();
    let (sweep, rows) = (swept(text, &names), rows(&starts, 19));
    let (moved, ways) = side_by_side(&sweep, &rows, &rows);
    assert_eq!((ways.lanes, ways.tree.len()), (19, 0), "{name}: {ways:?}");
    assert!(moved.iter().all(|row| row.outcome == Outcome::Ended));
    println!("{name}: {:e}", difference(&sweep, &rows, &moved));
}

const MASSES: [(&str, f64); 3] = [
    ("body.upper.mass", 1.3),
    ("body.lower.mass", 0.9),
    ("body.lower.body_at.position.1", 0.2),
];

#[test]
fn a_double_pendulum_moves_as_by_the_tree() {
    check("double pendulum", &double_pendulum(), &MASSES);
    let all = [
        ("body.lower.at.position.1", 0.4),
        ("gravity.3", -9.0),
        ("body.upper.initial.configuration.1", 0.3),
        ("body.lower.initial.speeds.1", 1.0),
        ("body.upper.inertia.1.1", 0.02),
    ];
    check(
        "double pendulum, all kinds of columns",
        &double_pendulum(),
        &all,
    );
}

#[test]
fn other_explicit_methods_move_as_by_the_tree() {
    for method in ["dopri5", "dop853", "verner9"] {
        let text = double_pendulum().replace("rk4", method);
        check(method, &text, &MASSES);
    }
}

/// Of the turns that a placement is made of, none is known to more than the rounding over the tilt, and their sum must be.
#[test]
fn axes_that_are_nearly_parallel_move_as_by_the_tree() {
    let upper = "at = { position = [0.1, 0.2, 0.3], rpy = [0.8, 0.4, 0.3] }\nbody_at = { position = [0.2, 0.05, 0.1], rpy = [0.0, 0.0, 0.7] }\ninitial.speeds = [1.5]";
    for half in [0.0, std::f64::consts::PI] {
        for tilt in [0.0, 3e-16, 1e-15, 1e-14, 1e-12, 1e-10, 1e-8, 1e-5] {
            let lower = format!(
                "at = {{ position = [0.1, 0.5, 0.3], rpy = [{:?}, 0.0, 1.1] }}\nbody_at = {{ position = [0.2, 0.05, 0.1] }}\ninitial.speeds = [-2.0]",
                half + tilt
            );
            let text = described(
                &(body("upper", "world", "{ type = \"revolute\" }", upper)
                    + &body("lower", "upper", "{ type = \"revolute\" }", &lower)),
            );
            check(&format!("{half} {tilt:e}"), &text, &MASSES);
        }
    }
}

#[test]
fn balls_move_as_by_the_tree() {
    let initial = "at = { position = [0.0, 0.1, 0.3] }\nbody_at = { position = [0.2, 0.05, 0.1] }\ninitial.speeds = [1.5, -0.5, 3.0]";
    let text = described(
        &(body("upper", "world", "{ type = \"ball\" }", initial)
            + &body("lower", "upper", "{ type = \"ball_child\" }", initial)),
    );
    check("balls", &text, &MASSES);
}

#[test]
fn a_free_body_moves_as_by_the_tree() {
    let initial = "com = [0.02, 0.0, 0.01]\ninitial = { twist = { angular = [0.5, 6.0, 0.0], linear = [0.3, 0.0, 0.1], frame = \"child\" } }";
    let text = described(&body("racket", "world", "{ type = \"free\" }", initial));
    check(
        "free body",
        &text,
        &[("body.racket.mass", 2.0), ("body.racket.com.1", 0.1)],
    );
}

#[test]
fn a_knife_edge_moves_as_by_the_tree() {
    let initial = "body_at = { position = [0.2, 0.0, 0.0] }\ninitial = { phi = [0.25, 0.0, 0.0], speeds = [5.0, 0.8] }";
    let text = described(&body(
        "sleigh",
        "world",
        "{ type = \"knife_edge\" }",
        initial,
    ));
    check(
        "knife edge",
        &text,
        &[
            ("body.sleigh.mass", 2.0),
            ("body.sleigh.body_at.position.1", 0.3),
        ],
    );
}

#[test]
fn springs_and_dampers_move_as_by_the_tree() {
    let upper =
        format!("{PENDULUM}\nspring = {{ stiffness = 20.0 }}\ndamping = 0.3\narmature = 0.02");
    let text = described(&body("upper", "world", "{ type = \"revolute\" }", &upper));
    let text = text.replace(
        "[simulation]",
        "[[spring]]\nfrom = { body = \"world\", point = [0.5, 0.0, 0.0] }\nto = { body = \"upper\", point = [0.1, 0.0, 0.0] }\nstiffness = 30.0\ndamping = 0.2\nlength = 0.2\n[simulation]",
    );
    let columns = [
        ("body.upper.spring.stiffness", 20.0),
        ("body.upper.damping", 0.3),
        ("body.upper.armature", 0.2),
        ("spring.1.stiffness", 30.0),
        ("spring.1.damping", 0.5),
        ("spring.1.length", 0.4),
        ("spring.1.to.point.1", 0.2),
    ];
    check("springs", &text, &columns);
}

/// Of joints whose base points move and whose angles count turns, too.
#[test]
fn samples_are_those_of_the_tree() {
    let circle = "at = { position = [0.0, 0.1, 0.3] }\nbody_at = { position = [0.2, 0.05, 0.1] }\ninitial.speeds = [9.0]";
    let wheel = described(&body(
        "upper",
        "world",
        "{ type = \"revolute_circle\" }",
        circle,
    ));
    for (text, columns) in [
        (
            double_pendulum(),
            &["body.upper.mass", "body.lower.mass"][..],
        ),
        (wheel, &["body.upper.mass"]),
    ] {
        // 0.3 / 0.004 is 74.99…; the end of the motion is a sample, too.
        let sampled = |times: &[f64]| {
            let sweep = swept(&text, columns);
            sweep
                .sampling(times, &hamel_sweep::joints())
                .expect("times of the motion")
        };
        let rows = rows(&[1.3, 0.9][..columns.len()], 70);
        let sweep = sampled(&[0.0, 0.3, 0.5, 0.996, 1.0]);
        let (moved, ways) = side_by_side(&sweep, &rows, &rows);
        assert_eq!(ways.lanes, 70);
        let all = moved.iter().flat_map(|row| &row.numbers);
        assert!(all.clone().all(|number| number.is_finite()));
        println!("{:e}", difference(&sweep, &rows, &moved));
        // The last sample is the end.
        let states: Vec<_> = sweep.states().collect();
        for row in &moved {
            let end = &row.numbers[states[0].clone()];
            assert_eq!(end, &row.numbers[states[5].clone()]);
        }
        // Side by side there is nothing between the ends of steps.
        let joints = hamel_sweep::joints();
        let refused = Plan::new(&sampled(&[0.3, 0.301]), &joints, &rows).err();
        let wanted = "no step ends at 0.301 s, where a sample is taken";
        assert_eq!(refused.as_deref(), Some(wanted));
    }
}

/// Ends that differ from samples by rounding, by less than what the last step takes along, and by more.
#[test]
fn samples_at_the_ends_of_motions_are_those_of_the_tree() {
    let joints = hamel_sweep::joints();
    let sweep = swept(&double_pendulum(), &["simulation.t_end"]);
    let sweep = sweep.sampling(&[0.1, 0.1 + 0.2, 0.5], &joints);
    let sweep = sweep.expect("times that ascend");
    let ends = [
        0.05,
        0.3,
        0.1 + 0.2,
        0.300_000_000_001,
        0.3001,
        0.302,
        0.5,
        0.7,
    ];
    let rows: Vec<Cells> = ends.map(|end| Cells::from([end])).into();
    let (moved, ways) = side_by_side(&sweep, &rows, &rows);
    let left = "no step ends at 0.30000000000000004 s, where a sample is taken";
    assert_eq!((ways.lanes, ways.tree.get(left)), (7, Some(&1)), "{ways:?}");
    for ((cells, own), end) in rows.iter().zip(&moved).zip(ends) {
        let tree = sweep.motion(cells, &joints);
        let reached = sweep.times_until(end).len();
        for (number, state) in sweep.states().skip(1).enumerate() {
            for place in state {
                let (a, b) = (own.numbers[place], tree.numbers[place]);
                assert_eq!(a.is_finite(), number < reached, "{end}: {a:e}");
                assert_eq!(b.is_finite(), number < reached, "{end}: {b:e} by the tree");
                assert!(
                    a.is_nan() || (a - b).abs() < ROUNDING,
                    "{end}: {a:e}, {b:e}"
                );
            }
        }
    }
}

fn bits(rows: &[Row]) -> Vec<Vec<u64>> {
    let all = rows
        .iter()
        .map(|row| row.numbers.iter().map(|x| x.to_bits()).collect());
    all.collect()
}

#[test]
fn a_row_has_the_same_bits_wherever_it_stands() {
    let columns = MASSES.map(|(name, _)| name);
    let (sweep, rows) = (
        swept(&double_pendulum(), &columns),
        rows(&[1.3, 0.9, 0.2], 70),
    );
    let (all, _) = side_by_side(&sweep, &rows, &rows);
    for place in [0, 5, 63, 64, 69] {
        let (alone, _) = side_by_side(&sweep, &rows, &rows[place..=place]);
        assert_eq!(bits(&alone), bits(&all[place..=place]));
    }
    let backwards: Vec<Cells> = rows.iter().rev().cloned().collect();
    let (mut moved, _) = side_by_side(&sweep, &rows, &backwards);
    moved.reverse();
    assert_eq!(bits(&moved), bits(&all));
}

/// Rows that follow each other with the same masses share a scene, and others not: the bits are those of each row alone.
#[test]
fn rows_with_other_starts_have_the_bits_of_rows_alone() {
    let columns = [
        "body.upper.mass",
        "body.upper.initial.configuration.1",
        "body.2.initial.speeds.1",
    ];
    let sweep = swept(&double_pendulum(), &columns);
    let row = |number: usize| {
        let start = 0.1 * number as f64;
        Cells::from([1.0 + 0.2 * (number / 4) as f64, start - 0.5, 2.0 - start])
    };
    let mut rows: Vec<Cells> = (0..14).map(row).collect();
    // No start, a start that no joint takes, and a mass that no body has.
    rows[2].fault = Some("a cell is no number".into());
    rows[6].numbers[2] = f64::NAN;
    rows[10].numbers[0] = -1.0;
    let sample: Vec<Cells> = [0, 5, 13].map(|place: usize| rows[place].clone()).into();
    let (all, ways) = side_by_side(&sweep, &sample, &rows);
    assert_eq!((ways.lanes, ways.tree.len()), (11, 0), "{ways:?}");
    let joints = hamel_sweep::joints();
    for (place, cells) in rows.iter().enumerate() {
        let (alone, _) = side_by_side(&sweep, &sample, std::slice::from_ref(cells));
        assert_eq!(bits(&alone), bits(&all[place..=place]), "{place}");
        assert_eq!(all[place].outcome, sweep.motion(cells, &joints).outcome);
    }
    let fine = [&rows[..2], &rows[3..6], &rows[7..10], &rows[11..]].concat();
    let (moved, _) = side_by_side(&sweep, &sample, &fine);
    difference(&sweep, &fine, &moved);
}

/// All ways in which `initial` gives numbers.
#[test]
fn starts_of_all_kinds_are_those_of_scenes() {
    let hinge = |initial: &str| {
        described(&body(
            "arm",
            "world",
            "{ type = \"revolute\" }",
            &format!("body_at = {{ position = [0.2, 0.05, 0.0] }}\ninitial = {initial}"),
        ))
    };
    let free = "com = [0.02, 0.0, 0.01]\ninitial = { phi = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], twist = { angular = [0.5, 6.0, 0.0], linear = [0.3, 0.0, 0.1], frame = \"parent\" } }";
    let free = described(&body("arm", "world", "{ type = \"free\" }", free));
    let cases = [
        (
            hinge("{ phi = [0.3], velocity = [0.2] }"),
            vec!["phi.1", "velocity.1"],
        ),
        (
            hinge(
                "{ configuration = [0.3], twist = { angular = [0.0, 0.0, 0.2], linear = [0.0, 0.0, 0.0], frame = \"child\" } }",
            ),
            vec!["configuration.1", "twist.angular.3"],
        ),
        (
            free,
            vec!["phi.2", "phi.5", "twist.angular.1", "twist.linear.3"],
        ),
    ];
    for (text, keys) in cases {
        let columns: Vec<String> = keys
            .iter()
            .map(|key| format!("body.arm.initial.{key}"))
            .collect();
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        let (sweep, rows) = (swept(&text, &columns), rows(&vec![0.3; keys.len()], 9));
        let (moved, ways) = side_by_side(&sweep, &rows, &rows);
        assert_eq!(ways.lanes, 9, "{keys:?}: {ways:?}");
        difference(&sweep, &rows, &moved);
        for (place, cells) in rows.iter().enumerate() {
            let (alone, _) = side_by_side(&sweep, &rows, std::slice::from_ref(cells));
            assert_eq!(bits(&alone), bits(&moved[place..=place]), "{keys:?}");
        }
    }
}

#[test]
fn a_number_may_be_0_in_the_first_row() {
    let columns = ["body.lower.body_at.position.2", "body.upper.damping"];
    let text = double_pendulum().replacen("initial =", "damping = 0.0\ninitial =", 1);
    let sweep = swept(&text, &columns);
    let rows: Vec<Cells> = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.4], [0.0, 0.2]]
        .map(Cells::from)
        .into();
    let (moved, ways) = side_by_side(&sweep, &rows, &rows);
    println!("{ways:?}: {:e}", difference(&sweep, &rows, &moved));
    // A row that the sample does not know goes by the tree, or with the others.
    let (moved, ways) = side_by_side(&sweep, &rows[..1], &rows);
    println!("{ways:?}: {:e}", difference(&sweep, &rows, &moved));
    assert_eq!(ways.lanes, 1);
}

#[test]
fn rows_of_other_lengths_end_where_they_should() {
    let columns = ["simulation.t_end", "simulation.dt"];
    let sweep = swept(&double_pendulum(), &columns);
    let rows: Vec<Cells> = [[1.0, 0.004], [0.5, 0.004], [0.50001, 0.003], [0.0, 0.01]]
        .map(Cells::from)
        .into();
    let (moved, ways) = side_by_side(&sweep, &rows, &rows);
    assert_eq!(ways.lanes, 4);
    difference(&sweep, &rows, &moved);
}

#[test]
fn a_row_that_is_refused_fails_alone() {
    let columns = MASSES.map(|(name, _)| name);
    let (sweep, mut rows) = (
        swept(&double_pendulum(), &columns),
        rows(&[1.3, 0.9, 0.2], 5),
    );
    rows[1].numbers[0] = -1.0;
    rows[3].fault = Some("a cell is no number".into());
    let (moved, _) = side_by_side(&sweep, &rows, &rows);
    let joints = hamel_sweep::joints();
    for place in [1, 3] {
        let tree = sweep.motion(&rows[place], &joints);
        assert_eq!(moved[place].outcome, tree.outcome);
    }
    let whole: Vec<usize> = (0..5)
        .filter(|place| moved[*place].outcome == Outcome::Ended)
        .collect();
    assert_eq!(whole, [0, 2, 4]);
}

/// Two bodies on slides in a row, the upper one without mass: its mass matrix is singular, which steps side by side do not see.
#[test]
fn a_row_whose_mass_matrix_is_singular_fails_as_by_the_tree() {
    let slides = |name: &str, parent: &str, at: &str| {
        body(name, parent, "{ type = \"translation\" }", at).replace(
            "[[0.02, 0.001, 0.0], [0.001, 0.03, -0.002], [0.0, -0.002, 0.025]]",
            "[[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]",
        )
    };
    let turned =
        "at = { rotation_vector = [0.3, 0.7, 0.2] }\ninitial = { speeds = [0.3, 0.2, 0.1] }";
    let text = described(&(slides("a", "world", "") + &slides("b", "a", turned)));
    let sweep = swept(&text, &["body.a.mass"]);
    let rows: Vec<Cells> = [1.0, 0.0, 0.5]
        .iter()
        .map(|mass| Cells::from(vec![*mass]))
        .collect();
    let (moved, ways) = side_by_side(&sweep, &rows, &rows);
    difference(&sweep, &rows, &moved);
    let ended = moved.iter().map(|row| row.outcome == Outcome::Ended);
    assert_eq!(ended.collect::<Vec<_>>(), [true, false, true]);
    assert_eq!(ways.lanes, 2, "{ways:?}");
}

#[test]
fn samples_are_spread_over_tables() {
    let of = |rows| sample(rows).collect::<Vec<u64>>();
    assert!(of(0).is_empty());
    assert_eq!(of(1), [0]);
    assert_eq!(of(3), [0, 1, 2]);
    let many = of(10_000_000_000);
    assert_eq!((many.len(), many[0], many[31]), (32, 0, 9_999_999_999));
    assert!(many.is_sorted());
}
