//! What poses, rotations and expressions of specs amount to, in numbers.

use hamel_codegen::expr::{Expr, Role, Symbol, evaluate_f64};
use hamel_codegen::manifold::Kind;
use hamel_codegen::matrix::Matrix;
use hamel_codegen::model::JointSpec;
use hamel_codegen::spec;
use std::collections::BTreeMap;

fn read(source: &str) -> JointSpec {
    spec::parse(source, "test.joint").unwrap_or_else(|errors| panic!("{errors}"))
}

/// A spec from its statements.
fn joint(statements: &str) -> JointSpec {
    read(&format!("hamel = 1;\njoint test {{\n{statements}\n}}\n"))
}

/// H of a joint with one real coordinate `q` and displacement `expression` along z.
fn scalar(expression: &str) -> Expr {
    let spec = joint(&format!("config q: R1; H = trans_z({expression} + 0 * q);"));
    spec.pose.value.translation.at(2, 0).clone()
}

/// The rotation matrix that exp of the same rotation vector gives on each manifold of rotations, at the home configuration.
#[test]
fn rotations_of_all_manifolds_agree() {
    let vector = [0.3, -1.1, 0.7];
    let rotation = |kind: Kind, basis: &str, rotation: &str| -> Vec<f64> {
        let spec = joint(&format!(
            "config Q: {}; basis {basis}; velocity in child; Phi = Q * exp(phi); H = pose({rotation}, [0, 0, 0]);",
            kind.name()
        ));
        let moved = spec.retract.as_ref().expect("declared").value.clone();
        let home = spec.manifold.value.home();
        let coordinates = spec.manifold.value.coordinates();
        let at = |symbol: &Symbol| match symbol.role {
            Role::Local => vector
                .get(usize::from(symbol.index))
                .copied()
                .unwrap_or(0.0),
            _ => evaluate_f64(&home[usize::from(symbol.index)], &|_| f64::NAN),
        };
        let values: Vec<f64> = moved
            .iter()
            .map(|scalar| evaluate_f64(scalar, &at))
            .collect();
        let moved_to = |symbol: &Symbol| {
            values[coordinates
                .iter()
                .position(|q| q == symbol)
                .expect("a coordinate")]
        };
        spec.pose
            .value
            .rotation
            .entries()
            .iter()
            .map(|r| evaluate_f64(r, &moved_to))
            .collect()
    };
    let reference = rotation(Kind::So3, "a, b, c of so3", "Q");
    for (kind, basis, matrix) in [
        (Kind::S3, "a, b, c of so3", "rot(Q)"),
        (Kind::Se3, "a, b, c, d, e, f of se3", "Q.R"),
    ] {
        for (found, expected) in rotation(kind, basis, matrix).iter().zip(&reference) {
            // Some ten roundings of numbers below 2.
            assert!(
                (found - expected).abs() < 1e-14,
                "{}: {found} against {expected}",
                kind.name()
            );
        }
    }
}

/// A quarter turn on each manifold of planar rotations takes x to y.
#[test]
fn planar_rotations_turn_right_handed() {
    for (kind, algebra) in [("S1", "so2"), ("SO2", "so2"), ("SE2", "se2")] {
        let names = if algebra == "so2" { "a" } else { "a, b, c" };
        let spec = joint(&format!(
            "config Q: {kind}; basis {names} of {algebra}; velocity in child; Phi = Q * exp(phi); H = pose(rot_z(Q), [0, 0, 0]);"
        ));
        let home: BTreeMap<Symbol, Expr> = spec
            .manifold
            .value
            .coordinates()
            .into_iter()
            .zip(spec.manifold.value.home())
            .collect();
        let moved = spec
            .retract
            .expect("declared")
            .value
            .into_iter()
            .map(|scalar| scalar.substitute(&home));
        let moved: BTreeMap<Symbol, Expr> = spec
            .manifold
            .value
            .coordinates()
            .into_iter()
            .zip(moved)
            .collect();
        let sine = spec.pose.value.rotation.at(1, 0).substitute(&moved);
        let at = |symbol: &Symbol| {
            if symbol.index == 0 {
                std::f64::consts::FRAC_PI_2
            } else {
                0.0
            }
        };
        // The series of the sine ends in rounding errors of terms below 5.
        assert!((evaluate_f64(&sine, &at) - 1.0).abs() < 1e-14, "{kind}");
    }
}

#[test]
fn expressions_have_their_values() {
    let pairs = [
        ("1 - 2 - 3", "-4"),
        ("8 / 2 / 2 * 3", "6"),
        ("-q * -2", "2 * q"),
        ("--q", "q"),
        ("2 * (q + 1) - q", "q + 2"),
        ("0.125", "1/8"),
        ("1.5e-2 + 1e2", "100 + 3/200"),
        ("pow(q, 3)", "q * q * q"),
        ("pow(q, -2)", "1 / (q * q)"),
        (
            "pow(q, 3/2)",
            "q * sqrt(q) + sqrt(q) * sqrt(q) * sqrt(q) - q * sqrt(q)",
        ),
        ("sqrt(4/9)", "2/3"),
        ("tan(q)", "sin(q) / cos(q)"),
        ("cos(2 * q)", "pow(cos(q), 2) - pow(sin(q), 2)"),
        ("sin(pi / 2)", "1"),
        ("exp(q) * exp(-q)", "1"),
        ("1 / exp(q)", "exp(-q)"),
        ("cosh(q) * cosh(q) - sinh(q) * sinh(q)", "1"),
        ("tanh(-q) * cosh(q)", "-sinh(q)"),
        ("sinh(q) / cosh(q)", "tanh(q)"),
        ("1 - tanh(q) * tanh(q)", "1 / (cosh(q) * cosh(q))"),
        ("cosh(0) + tanh(0) + log(1)", "1"),
        ("atan2(0, 1)", "0"),
        ("dot([1, 2], [3; 4])", "11"),
        ("norm([3, 4])", "5"),
        ("cross([1, 0, 0], [0, 1, 0]).z", "1"),
        ("(tilde([0, 0, 1]) * [1, 0, 0])[2]", "1"),
        ("transpose([1, 2; 3, 4])[1, 2]", "3"),
        ("transpose([1; 2; 3]) * [q, 0, 0]", "q"),
        ("[1, 2; 3, 4][2, 1]", "3"),
        ("[I(2), [5, 6]; O(1, 2), 7][1, 3]", "5"),
        ("([1, 2] + [3; 4])[2]", "6"),
        ("rot_x(q)[3, 2]", "sin(q)"),
        ("rot_y(q)[1, 3]", "sin(q)"),
        ("rot_z(q)[2, 1]", "sin(q)"),
        ("(rot_z(q) * trans_x(2)).y", "2 * sin(q)"),
        ("(rot_z(q) * trans([1, 0, 3]) * [1, 0, 0]).x", "2 * cos(q)"),
        ("(trans([1, 2, 3]) * rot_x(q)).R[3, 2]", "sin(q)"),
        (
            "(pose(rot_x(q), [1, 2, 3]) * trans_z(1)).p[3]",
            "3 + cos(q)",
        ),
    ];
    for (left, right) in pairs {
        let difference = scalar(left) - scalar(right);
        let normal = hamel_codegen::manifold::Ideal::default().normal_form(&difference);
        assert!(normal.is_zero(), "{left} is {}, not {right}", scalar(left));
    }
}

#[test]
fn poses_may_be_written_in_any_form() {
    let forms = [
        "rot_z(q) * trans_z(2)",
        "trans([0, 0, 2]) * rot_z(q)",
        "pose(rot_z(q), [0; 0; 2])",
        "[cos(q), -sin(q), 0, 0; sin(q), cos(q), 0, 0; 0, 0, 1, 2; 0, 0, 0, 1]",
        "[rot_z(q), [0, 0, 2]; O(1, 3), 1]",
    ];
    for form in forms {
        let pose = joint(&format!("config q: R1; H = {form};")).pose.value;
        assert_eq!(
            pose.rotation,
            joint("config q: R1; H = rot_z(q);").pose.value.rotation,
            "{form}"
        );
        assert_eq!(
            pose.translation,
            Matrix::integers(&[[0], [0], [2]]),
            "{form}"
        );
    }
}

/// What messages quote is text that the same spec could hold: names, quotients, functions and long numbers among it.
#[test]
fn expressions_are_shown_as_a_spec_writes_them() {
    for (statements, expressions) in [
        (
            "config Turn: R1;",
            &[
                "Turn * Turn / 3 - 2 / 7",
                "sqrt(Turn * Turn + 1) * log(2 + Turn * Turn) / (Turn * Turn + 2)",
                "1 / (1 + Turn * Turn) / (2 + exp(Turn)) - cos(Turn) * sin(Turn) * pi",
                "atan2(Turn, 2) * 123456789 + 1 / 30000000 * Turn - 5e-9",
                "1e40 * Turn + 12000000",
                "tan(Turn / 2) / tanh(Turn + 1)",
            ][..],
        ),
        (
            "config Q: SO3; basis a, b, c of so3; velocity in child;",
            &["Q[1, 2] * Q[3, 3] - Q[2, 1] / 2", "sqrt(2 + Q[1, 3])"],
        ),
        (
            "config Q: SE2; basis a, b, c of se2; velocity in child;",
            &["Q[1, 3] - Q[2, 1] * Q.y"],
        ),
        (
            "config Q: SE3; basis a, b, c, d, e, f of se3; velocity in child;",
            &["Q[1, 4] * Q[3, 2] - Q.z"],
        ),
        (
            "config u: S1; basis a of so2; velocity in child;",
            &["u.c * u.s - u.c"],
        ),
        (
            "config u: S3; basis a, b, c of so3; velocity in child;",
            &["u.w * u.x - u.y - u.z"],
        ),
        (
            "config R: SO2, p: R3, w: R2; basis a of so2; velocity in child;",
            &["R[2, 1] * p.x - p.z * w.y + R.c"],
        ),
        ("config w: R5;", &["w[5] * w[1] - w[2]"]),
    ] {
        for expression in expressions {
            let read = |text: &str| {
                let spec = joint(&format!("{statements} H = trans_z({text});"));
                spec.pose.value.translation.at(2, 0).clone()
            };
            let shown = read(expression).to_string();
            assert_eq!(read(&shown), read(expression), "{expression}: {shown}");
        }
    }
    let spec = joint("config q: R1; local slide; Phi = q + phi.slide; H = trans_z(q);");
    assert_eq!(spec.freedoms.value[0].local.spelling(), "phi.slide");
}

#[test]
fn long_numbers_are_shown_with_exponents_and_all_their_digits() {
    for (written, shown) in [
        ("1000000", "1000000"),
        ("12000000", "1.2e7"),
        ("123456789", "1.23456789e8"),
        ("1e-7", "1/1e7"),
        ("2.5", "5/2"),
    ] {
        assert_eq!(scalar(written).to_string(), shown);
    }
}
