//! Joints beyond the known groups are read: declared manifolds, exceptions, ranges, and any Phi.

use hamel_codegen::expr::{Expr, Role, Symbol, evaluate_f64};
use hamel_codegen::model::{End, Interval, JointSpec, VelocityFrame};
use hamel_codegen::spec;

fn read(source: &str) -> JointSpec {
    spec::parse(source, "test.joint").unwrap_or_else(|errors| panic!("{errors}"))
}

/// A spec from its statements.
fn joint(statements: &str) -> JointSpec {
    read(&format!("hamel = 1;\njoint test {{\n{statements}\n}}\n"))
}

/// A joint with the parameters, of which H makes no use but a sum.
fn range_of(range: &str) -> Interval {
    let spec = read(&format!(
        "hamel = 1; joint test(a: m {range}) {{ config q: R1; H = trans_z(a * q); }}"
    ));
    spec.parameters[0].range.clone()
}

fn freedoms(spec: &JointSpec) -> Vec<&str> {
    let freedoms = spec.freedoms.value.iter();
    freedoms.map(|freedom| freedom.name.as_str()).collect()
}

const POINT_ON_ELLIPSOID: &str = "hamel = 1;
joint ellipsoid(a: m > 0, b: m > 0, c: m > 0) {
    config p: R3;
    relation p.x * p.x / (a * a) + p.y * p.y / (b * b) + p.z * p.z / (c * c) = 1;
    home = [0, 0, c];
    local  u, w;
    /// The equator, where u and w
    /// lose their meaning.
    except p.z  =  0;
    Phi = p + [phi.u, phi.w, -c * c / p.z * (p.x / (a * a) * phi.u + p.y / (b * b) * phi.w)];
    H = trans(p);
}";

#[test]
fn relations_are_part_of_the_manifold() {
    let spec = joint(
        "config n: R3; relation dot(n, n) = 1; home = [0, 0, 1]; local a, b; except n.z = 0;\n\
         Phi = (n + [phi.a, phi.b, 0]) / norm(n + [phi.a, phi.b, 0]); H = trans(n);",
    );
    let manifold = &spec.manifold.value;
    assert_eq!(manifold.declared().len(), 1);
    let [x, y, z] = [0, 1, 2].map(|n| Expr::symbol(&manifold.coordinates()[n]));
    let squares = x.square() + y.square() + z.square();
    assert!(manifold.ideal().vanishes(&(squares - Expr::one())));
    assert!(!manifold.ideal().vanishes(&x));
    assert_eq!(
        spec.home.expect("declared").value,
        [0, 0, 1].map(Expr::integer)
    );
    assert_eq!(spec.loci.len(), 1);
    assert_eq!(spec.loci[0].value.function, z);
}

#[test]
fn parameters_may_divide_in_relations() {
    let spec = read(POINT_ON_ELLIPSOID);
    assert_eq!(spec.manifold.value.declared().len(), 1);
    let locus = &spec.loci[0].value;
    assert_eq!(locus.text, "p.z = 0");
    assert_eq!(
        locus.docs,
        "The equator, where u and w\nlose their meaning."
    );
    assert_eq!(&spec.source[spec.loci[0].span.clone()], "except p.z  =  0;");
}

/// RᵀR = I for a matrix of nine real scalars: one relation for each pair of columns, each once.
#[test]
fn relations_may_be_matrices() {
    let spec = joint(
        "config r: R9; let m = [r[1], r[2], r[3]; r[4], r[5], r[6]; r[7], r[8], r[9]];\n\
         relation transpose(m) * m = I(3); relation m * transpose(m) = I(3);\n\
         relation dot(cross(m * [1, 0, 0], m * [0, 1, 0]), m * [0, 0, 1]) = 1;\n\
         home = [1; 0; 0; 0; 1; 0; 0; 0; 1]; local a, b, c;\n\
         let turned = m; Phi = [m[1, 1]; m[1, 2]; m[1, 3]; m[2, 1]; m[2, 2]; m[2, 3]; m[3, 1]; m[3, 2]; m[3, 3]];\n\
         H = pose(turned, [0, 0, 0]);",
    );
    assert_eq!(spec.manifold.value.declared().len(), 13);
    let entry = |n: usize| Expr::symbol(&spec.manifold.value.coordinates()[n]);
    let cofactor = &(&entry(4) * &entry(8)) - &(&entry(5) * &entry(7));
    assert!(spec.manifold.value.ideal().vanishes(&(cofactor - entry(0))));
}

/// The torus of revolution is of degree four; two factors share a relation.
#[test]
fn relations_may_have_any_degree_and_join_factors() {
    let torus = read(
        "hamel = 1; joint torus(major: m > 0, minor: m > 0) { require major > minor;\n\
         config p: R3; let s = dot(p, p) + major * major - minor * minor;\n\
         relation s * s = 4 * major * major * (p.x * p.x + p.y * p.y); home = [major + minor, 0, 0];\n\
         local u, v; Phi = p + phi.u * [-p.y, p.x, 0] + phi.v * [0, 0, 1]; H = trans(p); }",
    );
    assert_eq!(torus.requirements[0].value.text, "major > minor");
    let symbol = |n: usize| Expr::symbol(&torus.parameters[n].symbol);
    assert_eq!(torus.requirements[0].value.value, symbol(0) - symbol(1));
    let gear = joint(
        "config a: S1, b: S1; relation b.c = a.c * a.c - a.s * a.s; relation b.s = 2 * a.s * a.c;\n\
         home = [1, 0], [1, 0]; local turn;\n\
         Phi = [a.c * cos(phi.turn) - a.s * sin(phi.turn), a.s * cos(phi.turn) + a.c * sin(phi.turn)],\n\
         [b.c * cos(2 * phi.turn) - b.s * sin(2 * phi.turn), b.s * cos(2 * phi.turn) + b.c * sin(2 * phi.turn)];\n\
         H = rot_z(a) * trans_x(b.c);",
    );
    assert_eq!(freedoms(&gear), ["turn"]);
}

#[test]
fn ranges_have_open_and_closed_ends() {
    let end = |numerator: i64, denominator: i64, included| {
        let value = Expr::fraction(numerator, denominator);
        let value = value.as_rational().expect("a number");
        Some(End { value, included })
    };
    let interval = |lower, upper| Interval { lower, upper };
    for (text, expected) in [
        ("", interval(None, None)),
        ("> 0", interval(end(0, 1, false), None)),
        (">= 1/2", interval(end(1, 2, true), None)),
        ("< 5", interval(None, end(5, 1, false))),
        ("<= -1", interval(None, end(-1, 1, true))),
        ("> -1 <= 1", interval(end(-1, 1, false), end(1, 1, true))),
        ("in 0.5..1", interval(end(1, 2, true), end(1, 1, false))),
        ("in 1..=2.5", interval(end(1, 1, true), end(5, 2, true))),
        ("in 1..", interval(end(1, 1, true), None)),
        ("in ..=1", interval(None, end(1, 1, true))),
        (
            "in (1 + 1)..3 * 2",
            interval(end(2, 1, true), end(6, 1, false)),
        ),
    ] {
        assert_eq!(range_of(text), expected, "{text}");
    }
}

#[test]
fn without_a_twist_map_v_is_the_rate_of_the_local_coordinates() {
    let spec = joint(
        "config n: S2; local a, b; except n.z = 0;\n\
         Phi = (n + [phi.a, phi.b, 0]) / norm(n + [phi.a, phi.b, 0]); H = trans(n);",
    );
    assert!(spec.twist_map.is_none());
    assert_eq!(spec.velocity.value, VelocityFrame::Rates);
    assert!(spec.freedoms.value.iter().all(|f| f.generator.is_empty()));
}

/// Factors that move by a basis, beside one that moves as Phi says.
#[test]
fn bases_and_local_coordinates_stand_side_by_side() {
    let spec = joint(
        "config R: SO3, n: S2, d: R1; basis u, v, w of so3; local a, b, slide;\n\
         Phi = R * exp(phi.R), (n + [phi.a, phi.b, 0]) / norm(n + [phi.a, phi.b, 0]), d + phi.slide;\n\
         H = pose(R, d * n);",
    );
    assert_eq!(freedoms(&spec), ["u", "v", "w", "a", "b", "slide"]);
    let generators = spec.freedoms.value.iter().map(|f| f.generator.len());
    assert_eq!(generators.collect::<Vec<_>>(), [3, 3, 3, 0, 0, 0]);
    let indices = spec.freedoms.value.iter().map(|f| f.local.index);
    assert_eq!(indices.collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
}

/// A planar motion in space: the basis spans a subalgebra of se(3).
#[test]
fn a_basis_may_span_a_subalgebra() {
    let spec = joint(
        "config Q: SE3; basis a = e3, x = e4, y = e5, z = e6 of se3; velocity in child; H = Q;",
    );
    assert_eq!(freedoms(&spec), ["a", "x", "y", "z"]);
}

/// Φ at home, moved by (0.3, −1.1, 0.7).
fn moved(statements: &str) -> Vec<f64> {
    let spec = joint(&format!("{statements} H = pose(rot(Q), [0, 0, 0]);"));
    let home = spec.manifold.value.home();
    let at = |symbol: &Symbol| match symbol.role {
        Role::Local => [0.3, -1.1, 0.7][usize::from(symbol.index)],
        _ => evaluate_f64(&home[usize::from(symbol.index)], &|_| f64::NAN),
    };
    let retract = spec.retract.expect("declared").value;
    retract
        .iter()
        .map(|scalar| evaluate_f64(scalar, &at))
        .collect()
}

fn assert_same(first: &[f64], second: &[f64]) {
    assert_eq!(first.len(), second.len());
    for (a, b) in first.iter().zip(second) {
        // Some twenty roundings of numbers below 2.
        assert!((a - b).abs() < 1e-14, "{first:?} against {second:?}");
    }
}

#[test]
fn exp_of_a_skew_matrix_is_the_rotation() {
    let group =
        moved("config Q: SO3; basis a, b, c of so3; velocity in child; Phi = Q * exp(phi);");
    for phi in [
        "Q * exp(tilde(phi))",
        "exp(hat(Q * [phi.a, phi.b, phi.c])) * Q",
        "Q * exp(phi.a * tilde([1, 0, 0]) + phi.b * hat([0, 1, 0]) + tilde([0, 0, phi[3]]))",
    ] {
        assert_same(
            &moved(&format!("config Q: SO3; local a, b, c; Phi = {phi};")),
            &group,
        );
    }
}

/// Cayley's map takes tan(θ/2) where exp takes θ/2: scaled so, both give the same rotation.
#[test]
fn cayley_maps_are_read() {
    let theta = (0.3_f64 * 0.3 + 1.1 * 1.1 + 0.7 * 0.7).sqrt();
    let angle = 2.0 * (theta / 2.0).atan();
    let cayley = moved(
        "config Q: SO3; basis a, b, c of so3; velocity in child;\n\
         Phi = Q * (I(3) + 4 / (4 + dot(phi, phi)) * (tilde(phi) + tilde(phi) * tilde(phi) / 2));",
    );
    let trace = cayley[0] + cayley[4] + cayley[8];
    assert!((trace - (1.0 + 2.0 * angle.cos())).abs() < 1e-14, "{trace}");
    let quaternion = moved(
        "config Q: S3; local a, b, c; let one = [1, 0, 0, 0];\n\
         let i = [-Q.x, Q.w, Q.z, -Q.y]; let j = [-Q.y, -Q.z, Q.w, Q.x]; let k = [-Q.z, Q.y, -Q.x, Q.w];\n\
         Phi = (Q + phi.a / 2 * i + phi.b / 2 * j + phi.c / 2 * k + 0 * one) / sqrt(1 + dot(phi, phi) / 4);",
    );
    assert!((quaternion[0] - (angle / 2.0).cos()).abs() < 1e-14);
    assert!((quaternion.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14);
}

#[test]
fn elements_of_circles_and_quaternions_are_columns_in_sums() {
    let spec = joint(
        "config Q: S1, W: S3; local a; Phi = (Q + phi.a * [-Q.s, Q.c]) / norm(Q + phi.a * [-Q.s, Q.c]), -W / norm(-2 * W) * 2;\n\
         H = pose(rot(W), [dot(Q, Q), dot(W, W), norm(Q)]);",
    );
    assert_eq!(spec.retract.expect("declared").value.len(), 6);
}

#[test]
fn inverse_functions_have_their_values() {
    let value = |expression: &str| {
        let spec = joint(&format!("config q: R1; H = trans_z({expression} + 0 * q);"));
        evaluate_f64(spec.pose.value.translation.at(2, 0), &|_| 0.3)
    };
    for (expression, expected) in [
        ("asin(q)", 0.3_f64.asin()),
        ("acos(q)", 0.3_f64.acos()),
        ("acos(-q)", (-0.3_f64).acos()),
        ("atan(q)", 0.3_f64.atan()),
        ("asin(1)", std::f64::consts::FRAC_PI_2),
        ("atan(-3 * q)", (-0.9_f64).atan()),
    ] {
        // A root and an arctangent of numbers below 2.
        assert!((value(expression) - expected).abs() < 1e-15, "{expression}");
    }
}

/// A screw whose lead may be 0 is then a hinge, of which one pose has many angles.
#[test]
fn no_scalar_is_read_off_the_pose_by_a_parameter_that_may_vanish() {
    let fibres = |range: &str| {
        let source = format!(
            "hamel = 1; joint screw(lead: m/rad {range}) {{ config q: R1; H = rot_z(q) * trans_z(lead * q); }}"
        );
        let joint = hamel_codegen::derive(&source, "screw.joint").expect("a valid spec");
        let claim = joint.claims.iter().find(|claim| claim.name == "fibres");
        claim.map(|claim| claim.statement.clone())
    };
    assert_eq!(fibres("> 0").as_deref(), Some("one pose has one Q"));
    assert_eq!(fibres(">= 0"), None);
}

fn code_of(source: &str) -> Option<&'static str> {
    let errors = hamel_codegen::derive(source, "test.joint").err();
    errors.map(|errors| errors.errors[0].code)
}

#[test]
fn angles_must_not_jump() {
    let on_circle = |pose: &str| {
        code_of(&format!(
            "hamel = 1; joint test {{ config q: S1; basis turn of so2; velocity in child; H = {pose}; }}"
        ))
    };
    let angle = "atan2(q.s, q.c)";
    // Sine and cosine of whole multiples do not see a whole turn; those of half the angle do.
    assert_eq!(on_circle(&format!("rot_z(3 * {angle})")), None);
    assert_eq!(on_circle(&format!("rot_z({angle} / 2)")), Some("E0420"));
    assert_eq!(
        on_circle(&format!("rot_z(q) * trans_z({angle})")),
        Some("E0420")
    );
    let on_line = |pose: &str| {
        code_of(&format!(
            "hamel = 1; joint test {{ config x: R1; H = {pose}; }}"
        ))
    };
    assert_eq!(on_line("trans([x, atan(x), 0])"), None);
    assert_eq!(on_line("trans([x, asin(sin(x) / 2), 0])"), None);
    assert_eq!(on_line("trans([x, acos(sin(x) / 2), 0])"), None);
    assert_eq!(on_line("trans([x, asin(sin(x)), 0])"), Some("E0420"));
}

#[test]
fn what_is_known_of_finite_motion_is_said() {
    let statement = |phi: &str| {
        let source = format!(
            "hamel = 1; joint test {{ config n: S2; local a, b; except n.z = 0; Phi = {phi}; H = trans(n); }}"
        );
        let joint = hamel_codegen::derive(&source, "test.joint").map_err(|e| e.errors[0].code)?;
        let mut claims = joint.claims.iter();
        let claim = claims.find(|claim| claim.name == "retract_on_manifold");
        Ok(claim.map(|claim| claim.statement.clone()))
    };
    let moved = "n + [phi.a, phi.b, -(n.x * phi.a + n.y * phi.b) / n.z]";
    let shown = Ok(Some("Φ(Q, ϕ) stays on the manifold".to_owned()));
    assert_eq!(statement(&format!("({moved}) / norm({moved})")), shown);
    // The same with 1/√(1 + s) = 1 − s/2 + … cut off: to second order in ϕ, s being the square of what is added.
    let added = "dot([phi.a, phi.b, -(n.x * phi.a + n.y * phi.b) / n.z], [phi.a, phi.b, -(n.x * phi.a + n.y * phi.b) / n.z])";
    assert_eq!(
        statement(&format!("({moved}) * (1 - {added} / 2)")),
        Err("E0410")
    );
}

/// Beyond x = 0 there is no logarithm, while |x| has a value on both sides.
#[test]
fn a_joint_that_lives_on_one_side_says_so() {
    let singularity = |place: &str| {
        let source = format!(
            "hamel = 1; joint test {{ config x: R1; home = 1; except x = 0; H = trans([x, {place}, 0]); }}"
        );
        let joint = hamel_codegen::derive(&source, "test.joint").expect("a valid spec");
        let claim = joint.claims.iter().find(|claim| claim.name == "defined");
        let statement = claim
            .map(|claim| claim.statement.clone())
            .unwrap_or_default();
        let text = hamel_codegen::emit::rust::file(
            &joint,
            "test.joint",
            &hamel_codegen::emit::rust::Runtime::default(),
        )
        .expect("code");
        (
            statement.contains("on the side of home"),
            text.contains("least_absolute_beside([x], [x])"),
        )
    };
    assert_eq!(singularity("log(x)"), (true, true));
    assert_eq!(singularity("sqrt(x)"), (true, true));
    assert_eq!(singularity("sqrt(x * x)"), (false, false));
}

#[test]
fn entries_of_wide_matrices_have_names_of_their_own() {
    let row = ["1 + x * x"; 11].join(", ");
    let rows = [row.as_str(); 11].join("; ");
    let source = format!(
        "hamel = 1; joint test {{ config x: R1, y: R1; let m = [{rows}]; H = trans([x, y, m[1, 11] + m[11, 1]]); }}"
    );
    hamel_codegen::derive(&source, "test.joint").unwrap_or_else(|errors| panic!("{errors}"));
}
