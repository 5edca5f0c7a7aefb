//! Specs that must be read, and what is read from them.

use hamel_codegen::expr::{Expr, Role, Symbol};
use hamel_codegen::matrix::Matrix;
use hamel_codegen::model::{JointSpec, VelocityFrame};
use hamel_codegen::spec;
use std::path::Path;

fn read(source: &str) -> JointSpec {
    spec::parse(source, "test.joint").unwrap_or_else(|errors| panic!("{errors}"))
}

fn library(name: &str) -> JointSpec {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../joint-specs")
        .join(format!("{name}.joint"));
    read(&std::fs::read_to_string(path).expect("a joint of the library"))
}

/// A spec from its statements.
fn joint(statements: &str) -> JointSpec {
    read(&format!("hamel = 1;\njoint test {{\n{statements}\n}}\n"))
}

fn freedoms(spec: &JointSpec) -> Vec<&str> {
    spec.freedoms
        .value
        .iter()
        .map(|freedom| freedom.name.as_str())
        .collect()
}

#[test]
fn every_joint_of_the_library_is_read_under_its_own_name() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../joint-specs");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the library") {
        let path = entry.expect("a readable folder").path();
        if path
            .extension()
            .is_some_and(|extension| extension == "joint")
        {
            let name = path
                .file_stem()
                .expect("a file")
                .to_string_lossy()
                .into_owned();
            let spec = library(&name);
            assert_eq!(spec.name.value, name);
            assert!(
                spec.docs.len() > 2,
                "{name} says what it is, its frames and its units"
            );
            count += 1;
        }
    }
    assert!(count >= 7, "{count} joints");
}

#[test]
fn the_ball_joint_is_that_of_example_1() {
    let ball = library("ball");
    assert_eq!(freedoms(&ball), ["e1", "e2", "e3"]);
    assert_eq!(ball.velocity.value, VelocityFrame::Parent);
    let twist_map = ball.twist_map.expect("X is declared").value;
    assert_eq!(twist_map, Matrix::identity(3).stack(&Matrix::zeros(3, 3)));
    assert_eq!(
        ball.pose.value.rotation,
        ball.manifold.value.factors()[0].matrix()
    );
    assert!(ball.pose.value.translation.is_zero());
    let names: Vec<&str> = ball
        .freedoms
        .value
        .iter()
        .map(|freedom| freedom.local.name())
        .collect();
    assert_eq!(names, ["phi_e1", "phi_e2", "phi_e3"]);
}

#[test]
fn the_cart_is_that_of_examples_3_and_6() {
    let cart = library("cart");
    assert_eq!(freedoms(&cart), ["turn", "forward", "sideways"]);
    assert_eq!(cart.velocity.value, VelocityFrame::Child);
    assert_eq!(
        cart.constraint.expect("A").value,
        Matrix::integers(&[[0], [0], [1]])
    );
    assert_eq!(
        cart.speed_basis.expect("S_bar").value,
        Matrix::integers(&[[1, 0], [0, 1], [0, 0]])
    );
    assert_eq!(cart.speed_names.expect("speeds").value, ["turn", "forward"]);
}

#[test]
fn real_factors_give_their_coordinates_as_freedoms() {
    let planar = library("planar_euclidean");
    assert_eq!(freedoms(&planar), ["theta", "x", "y"]);
    assert_eq!(planar.velocity.value, VelocityFrame::Rates);
    assert!(planar.retract.is_none());
    let spec = joint("config p: R3; H = trans(p);");
    assert_eq!(freedoms(&spec), ["p1", "p2", "p3"]);
    assert_eq!(
        spec.freedoms.value[1].generator,
        [Expr::zero(), Expr::one(), Expr::zero()]
    );
}

#[test]
fn parameters_keep_their_units_and_docs() {
    let spec = read(
        "hamel = 1;\n/// Screw.\njoint screw(\n    /// Advance of one turn.\n    lead: m,\n    /** Friction,\n     * unused. */\n    pitch: m/rad,\n) {\n\
         config q: R1; let advance = lead * q / (2 * pi);\n H = rot_z(q) * trans_z(advance + pitch * q);\n}",
    );
    assert_eq!(spec.docs, ["Screw."]);
    let units: Vec<(&str, &str)> = spec
        .parameters
        .iter()
        .map(|p| (p.symbol.name(), p.unit.as_str()))
        .collect();
    assert_eq!(units, [("lead", "m"), ("pitch", "m/rad")]);
    assert_eq!(spec.parameters[0].docs, "Advance of one turn.");
    assert_eq!(spec.parameters[1].docs, "Friction,\nunused.");
    let symbol = |role, index, name| Expr::symbol(&Symbol::new(role, index, name));
    let (lead, pitch, q) = (
        symbol(Role::Parameter, 0, "lead"),
        symbol(Role::Parameter, 1, "pitch"),
        symbol(Role::Coordinate, 0, "q"),
    );
    let turns = &q * &(&Expr::integer(2) * &Expr::pi()).recip().expect("not zero");
    assert_eq!(
        *spec.pose.value.translation.at(2, 0),
        &(&lead * &turns) + &(&pitch * &q)
    );
}

#[test]
fn spans_point_at_the_text() {
    let spec = library("cart");
    let text = |span: &std::ops::Range<usize>| &spec.source[span.clone()];
    assert_eq!(text(&spec.name.span), "cart");
    assert_eq!(text(&spec.manifold.span), "config  Q: SE2;");
    assert_eq!(text(&spec.velocity.span), "velocity in child;");
    assert_eq!(
        text(&spec.pose.span),
        "H     = pose(rot_z(Q), [Q.x, Q.y, 0]);"
    );
    assert_eq!(
        text(&spec.constraint.as_ref().expect("A").span),
        "A     = [0; 0; 1];"
    );
}

#[test]
fn greek_letters_are_the_same_names() {
    let statements = "config Q: SE2; basis a, b, c of se2; velocity in child; H = pose(rot_z(Q), [Q.x, Q.y, 0]); A = [0; 0; 1];";
    let ascii = joint(&format!(
        "{statements} Phi = Q * exp(phi + pi * a); S_bar = [1, 0; 0, 1; 0, 0];"
    ));
    let greek = joint(&format!(
        "{statements} Φ = Q * exp(ϕ + π * a); S̄ = [1, 0; 0, 1; 0, 0];"
    ));
    assert_eq!(
        ascii.retract.map(|phi| phi.value),
        greek.retract.map(|phi| phi.value)
    );
    assert_eq!(
        ascii.speed_basis.map(|s| s.value),
        greek.speed_basis.map(|s| s.value)
    );
}

#[test]
fn bases_of_subgroups_close() {
    let screw = read(
        "hamel = 1; joint screw(lead: m) { config Q: SE3; basis s = e3 + lead / (2 * pi) * e6 of se3; velocity in child; H = Q; }",
    );
    assert_eq!(freedoms(&screw), ["s"]);
    let cylinder = joint(
        "config Q: SE3; basis turn = e3, slide = [0, 0, 0, 0, 0, 1] of se3; velocity in child; H = Q;",
    );
    assert_eq!(cylinder.freedoms.value[1].generator[5], Expr::one());
    // Rotations about a point off the origin, and a skewed basis of them: the brackets are found with parameters in them.
    let offset = read(
        "hamel = 1; joint offset(r: m, k: 1) { config Q: SE3;\n\
         basis a = e1 + k * (e2 - r * e6), b = e2 - r * e6, c = e3 + r * e5 of se3; velocity in child; H = Q; }",
    );
    assert_eq!(freedoms(&offset), ["a", "b", "c"]);
}

#[test]
fn a_basis_with_parameters_that_does_not_close_is_refused() {
    let source = "hamel = 1; joint offset(r: m) { config Q: SE3; basis a = e1 + r * e4, b = e2, c = e3 of se3; velocity in child; H = Q; }";
    let errors = spec::parse(source, "offset.joint").expect_err("the bracket of b and c is e1");
    assert_eq!(errors.errors[0].code, spec::code::NOT_CLOSED);
}

#[test]
fn several_factors_take_their_bases_in_order() {
    let spec = joint(
        "config R: SO3, p: R1, W: SO3, a: S1; basis w of so2; basis u = e3 of so3(W); basis x = e1 of so3;\n\
         velocity in child; H = pose(R * W, [0, 0, p]) * rot_z(a);",
    );
    assert_eq!(freedoms(&spec), ["w", "u", "x", "p"]);
    let factors: Vec<usize> = spec
        .freedoms
        .value
        .iter()
        .map(|freedom| freedom.factor)
        .collect();
    assert_eq!(factors, [3, 2, 0, 1]);
    let indices: Vec<u16> = spec
        .freedoms
        .value
        .iter()
        .map(|freedom| freedom.local.index)
        .collect();
    assert_eq!(indices, [0, 1, 2, 3]);
}

#[test]
fn phi_has_a_part_for_each_factor() {
    let spec = joint(
        "config R: SO3, p: R3; basis u, v, w of so3; velocity in child;\n\
         Phi = R * exp(phi.R), p + R * phi.p; H = pose(R, p);",
    );
    assert_eq!(freedoms(&spec), ["u", "v", "w", "p1", "p2", "p3"]);
    let retract = spec.retract.expect("declared").value;
    assert_eq!(retract.len(), 12);
    let locals: Vec<Symbol> = spec
        .freedoms
        .value
        .iter()
        .map(|freedom| freedom.local.clone())
        .collect();
    let home: Vec<Expr> = retract
        .iter()
        .map(|scalar| scalar.at_zero(&locals))
        .collect();
    let coordinates: Vec<Expr> = spec
        .manifold
        .value
        .coordinates()
        .iter()
        .map(Expr::symbol)
        .collect();
    assert_eq!(home, coordinates);
}

#[test]
fn products_of_exponentials_are_read() {
    let spec = joint(
        "config Q: SO3; basis a, b, c of so3; velocity in child;\n\
         Phi = Q * exp(phi.a * a) * exp(phi[2] * b) * exp(phi.c * c); H = pose(Q, [0, 0, 0]);",
    );
    assert!(spec.retract.is_some());
}

#[test]
fn a_manifold_that_is_no_group_has_local_coordinates() {
    let spec = joint(
        "config n: S2; local a, b; Phi = n + phi.a * [1, 0, 0] + phi[2] * [0, 1, 0] + dot(phi, phi) * n;\n\
         H = trans(n); X = O(6, 2);",
    );
    assert_eq!(freedoms(&spec), ["a", "b"]);
    assert!(
        spec.freedoms
            .value
            .iter()
            .all(|freedom| freedom.generator.is_empty())
    );
    assert_eq!(spec.retract.expect("declared").value.len(), 3);
}
