//! What is claimed holds on the whole domain: on both sides of exceptions, on every component, for every value of the parameters.

use hamel_codegen::derived::{Claim, Derived, KernelKind, Proof};
use hamel_codegen::emit::report::Accuracy;
use hamel_codegen::expr::{Expr, evaluate_f64};
use hamel_codegen::{derive, emit};

fn derived(declared: &str) -> Derived {
    let source = format!("hamel = 1;\njoint test{declared}");
    derive(&source, "test.joint").unwrap_or_else(|errors| panic!("{errors}"))
}

fn claim<'d>(joint: &'d Derived, name: &str) -> Option<&'d Claim> {
    joint.claims.iter().find(|claim| claim.name == name)
}

/// The value of an expression where every scalar of Q is `at`, `gain` is 0 and everything else 1.
fn value(expression: &Expr, joint: &Derived, at: f64) -> f64 {
    let coordinates = &joint.arguments.configuration;
    evaluate_f64(expression, &|symbol| match coordinates.contains(symbol) {
        true => at,
        false if symbol.name() == "gain" => 0.0,
        false => 1.0,
    })
}

#[test]
fn nothing_derived_is_divided_by_a_parameter_that_may_be_zero() {
    let pose = [
        // Solved for the power of q, the quotient and the root are what is left of it, divided by the gain.
        "trans([q, r + q * q * q / (1 + gain * q * q), 0])",
        "trans([q, r + q * q * q * sqrt(1 + gain * q * q * q * q), 0])",
        "trans([q, r + q * q * sqrt(arm + gain * q * q) / (1 + gain * q * q), 0])",
    ];
    for pose in pose {
        let joint = derived(&format!(
            "(gain: 1 >= 0, arm: 1 > 0) {{ config q: R1, r: R1; H = {pose}; X = [O(3, 2); 1, 0; 0, arm; 0, 0]; }}"
        ));
        for kernel in joint.kernels.iter().filter(|k| k.steps.is_empty()) {
            let entries = kernel.outputs.iter().flat_map(|output| output.entries());
            for entry in entries {
                let at_zero = value(entry, &joint, 0.5);
                assert!(at_zero.is_finite(), "{:?}: {entry}", kernel.kind);
            }
        }
    }
}

/// 1/x changes its sign where it is not defined.
#[test]
fn a_sign_may_change_at_an_exception_without_a_zero() {
    let joint = derived(" { config q: R1; home = 1; except q = 0; H = trans_x(log(1 / q)); }");
    let defined = claim(&joint, "defined").expect("there is a logarithm");
    assert!(defined.statement.contains("on the side of home alone"));
    let singularity = joint.kernels.iter();
    let mut singularity = singularity.filter(|k| k.kind == KernelKind::Singularity);
    let sides = &singularity.next().expect("an exception").outputs[1];
    assert!(value(sides.at(0, 0), &joint, -1.0) < 0.0);
    assert!(value(sides.at(0, 0), &joint, 1.0) > 0.0);
}

/// Relations may cut out several components, and nothing may be excepted: x = 0 nowhere meets x y = 1.
#[test]
fn components_without_a_value_are_refused_without_an_exception() {
    let joint = derived(
        " { config p: R2; relation p.x * p.y = 1; home = [1, 1]; local a;
            Phi = [p.x * exp(phi.a), p.y * exp(-phi.a)]; H = trans_x(log(p.x)); }",
    );
    let rust = emit::rust::file(&joint, "test.joint", &emit::rust::Runtime::default())
        .expect("it can be written");
    assert!(rust.contains(r#"const SINGULARITIES: &'static [&'static str] = &["p.x = 0"];"#));
    assert!(rust.contains("least_absolute_beside([p1], [p1])"));
}

/// log q² = 2 log q holds wherever log q has a value.
#[test]
fn identities_need_hold_only_where_the_joint_lives() {
    let joint = derived(
        " { config q: R1, r: R1; home = 1, 0; except q = 0; H = trans([q, r, 0]);
            A = [log(q * q) - 2 * log(q); 1]; S_bar = [1; 0]; }",
    );
    let met = claim(&joint, "speeds_meet_constraint").expect("it is claimed");
    assert_eq!(met.proof, Proof::NormalForm);
}

/// The rate of a cam's profile is (q − 1)² + 1: no sum of its terms is of one sign, and it has no root.
#[test]
fn polynomials_in_one_unknown_need_no_sum_of_squares() {
    let joint = derived(" { config q: R1; H = trans_x(q * q * q / 3 - q * q + 2 * q); }");
    let rank = claim(&joint, "twist_map_rank").expect("it is claimed");
    assert!(rank.detail.contains("of one sign"), "{}", rank.detail);
}

/// atan(q) / 2 is the angle of (1 + √(1 + q²), q), which the algebra does not know.
#[test]
fn a_claim_that_is_not_proved_says_so_everywhere() {
    let joint = derived(
        " { config q: R1, r: R1; H = trans([q, r, 0]);
            unproved speeds_meet_constraint because \"the half angle\";
            A = [atan2(q, 1 + sqrt(1 + q * q)) - atan2(q, 1) / 2; 1]; S_bar = [1; 0]; }",
    );
    let met = claim(&joint, "speeds_meet_constraint").expect("it is claimed");
    assert_eq!(met.proof, Proof::Checked);
    assert!(met.points >= 100, "{} points", met.points);
    assert_eq!(met.detail, "the half angle");
    let page = emit::page::page(&joint, "test.joint", &Accuracy::default()).expect("a page");
    let words = format!("checked at {} points, not proved", met.points);
    assert!(page.contains(&words), "{page}");
    let rust = emit::rust::file(&joint, "test.joint", &emit::rust::Runtime::default())
        .expect("it can be written");
    assert!(rust.contains("not proved"), "the docs of the joint say so");
}

/// A search for a place where a claim fails must not leave the manifold, whatever value a parameter of its relations has, nor a range.
#[test]
fn true_claims_are_not_refuted_outside_of_the_domain() {
    let circle = "config p: R2, y: R1; relation dot(p, p) = r * r; home = [r, 0], 0; local t, u;
        Phi = [p.x * cos(phi.t) - p.y * sin(phi.t); p.x * sin(phi.t) + p.y * cos(phi.t)], y + phi.u;
        H = trans([p.x, p.y, y]); speeds s;";
    let plane = "config x: R1, y: R1; H = trans([x, y, 0]); speeds s;";
    let specs = [
        format!(
            "(r: m > 0) {{ {circle} let w = sqrt(3 * r * r + p.x * p.x);
            A = [2 * atan2(p.y, 2 * r + w); -1]; S_bar = [1; atan2(p.y, w)];"
        ),
        format!(
            "(r: m > 0) {{ {circle}
            A = [exp(-sqrt(p.x * p.x + 3 * r * r + p.y * p.y) / r) * exp(2 * atan2(y, 1 + sqrt(1 + y * y))); -1];
            S_bar = [1; exp(-2) * exp(atan(y))];"
        ),
        format!("(m: 1 in 0.1..=0.1) {{ {plane} A = [tanh(x) * m; -1]; S_bar = [1; tanh(x) / 10];"),
        format!("{{ {plane} A = [pow(exp(x), 1/2); -1]; S_bar = [1; exp(x / 2)];"),
    ];
    for spec in specs {
        let unproved = "unproved speeds_meet_constraint because \"a law of functions\"; }";
        let joint = derived(&format!("{spec} {unproved}"));
        let met = claim(&joint, "speeds_meet_constraint").expect("it is claimed");
        assert_eq!(met.proof, Proof::Checked);
    }
}

/// Beyond its ends the curve keeps the slopes that it has there, which are not 0.
#[test]
fn a_curve_that_goes_on_straight_keeps_its_rank() {
    for kind in ["quintic", "cubic"] {
        let joint = derived(&format!(
            " {{ curve f(m): m = {kind} natural through [0, 0], [1, 1], [2, 2.5], [3, 4] continue linear;
                config x: R1; H = trans_x(f(x)); }}"
        ));
        let full = claim(&joint, "twist_map_rank").expect("the rank of X is claimed");
        assert!(matches!(full.proof, Proof::Certificate), "{:?}", full.proof);
    }
}

/// The value at ϕ = 0, and the slope, are numbers.
#[test]
fn a_curve_may_say_how_phi_moves() {
    let joint = derived(
        " { curve f(rad): rad = quintic natural through [-2, -3], [-1, -1.2], [0, 0], [1, 1], [2, 3] continue linear;
            config q: R1; local s; Phi = q + f(phi.s); H = rot_z(q); }",
    );
    let at_zero = claim(&joint, "retract_at_zero").expect("Phi is declared");
    assert!(
        matches!(at_zero.proof, Proof::NormalForm),
        "{:?}",
        at_zero.proof
    );
}

/// The square of its length has no rational root: the angle is the root of 14 times q.
#[test]
fn an_axis_may_have_any_length() {
    for axis in ["[1, 2, 3]", "[1, 1, 0]", "[3, 0, 4]"] {
        let joint = derived(&format!(" {{ config q: R1; H = exp(q * tilde({axis})); }}"));
        let rigid = claim(&joint, "pose_in_se3").expect("a claim");
        assert!(rigid.proof == Proof::NormalForm, "{axis}: {rigid:?}");
    }
}

/// A root vanishes where what it is taken of does, which `require` excludes.
#[test]
fn a_quotient_by_a_required_root_is_defined() {
    let joint = |condition: &str| {
        let source = format!(
            "hamel = 1; joint test(x: 1 in -1..=1, y: 1 in -1..=1) {{ {condition} config q: R1; H = trans_x(q / sqrt(x * x + y * y)); }}"
        );
        derive(&source, "test.joint").map_err(|errors| errors.to_string())
    };
    let found = joint("require x * x + y * y > 0;");
    assert!(found.is_ok(), "{found:?}");
    let refused = joint("").expect_err("it may be 0");
    assert!(refused.contains("E0420"), "{refused}");
}

/// The platform of three arms: the determinant that must not vanish, times a height. Where the product is not 0 neither is the determinant.
#[test]
fn an_exception_may_be_a_multiple_of_what_must_not_vanish() {
    let delta = |exception: &str| {
        let source = format!(
            "hamel = 1; joint delta {{ config a: S1, b: S1, c: S1, p: R3; bodies la, lb, lc, platform;\n\
             let pa = [1/2 * a.c + 1/5, 0, 1/2 * a.s];\n\
             let pb = rot_z(2/3 * pi) * [1/2 * b.c + 1/5, 0, 1/2 * b.s];\n\
             let pc = rot_z(-2/3 * pi) * [1/2 * c.c + 1/5, 0, 1/2 * c.s];\n\
             relation dot(p - pa, p - pa) = 1; relation dot(p - pb, p - pb) = 1; relation dot(p - pc, p - pc) = 1;\n\
             home near [1, 0], [1, 0], [1, 0], [0, 0, -1];\n\
             basis ta of so2(a); basis tb of so2(b); basis tc of so2(c);\n\
             except {exception} = 0;\n\
             H.la = rot_y(-1 * atan2(a.s, a.c)); H.lb = trans(pb); H.lc = trans(pc); H.platform = trans(p); }}"
        );
        derive(&source, "delta.joint").map_err(|errors| errors.to_string())
    };
    let determinant = "dot(p - pa, cross(p - pb, p - pc))";
    let found = delta(&format!("{determinant} * p.z"));
    assert!(found.is_ok(), "{:?}", found.err());
    let refused = delta("p.z").expect_err("it vanishes elsewhere too");
    assert!(refused.contains("E0401"), "{refused}");
}

/// A linkage on a sphere whose arcs are several parts of one turn: what its relation holds of these, its exception need not hold.
#[test]
fn an_exception_may_have_other_multiples_of_an_angle() {
    let linkage = |ground: &str, coupler: &str| {
        let source = format!(
            "hamel = 1; joint spherical {{ config a: S1, c: S1; bodies crank, rocker;\n\
             let frame = rot_y({ground} * pi);\n\
             let p = rot_z(a) * [1/2, 0, sqrt(3)/2]; let q = frame * rot_z(c) * [sqrt(3)/2, 0, 1/2];\n\
             relation dot(p, q) = cos({coupler} * pi); basis turn of so2(a);\n\
             except dot(cross(frame * [0, 0, 1], q), p) = 0; home near [1, 0], [0, 1];\n\
             H.crank = rot_z(a); H.rocker = pose(frame * rot_z(c), [0, 0, 0]); }}"
        );
        derive(&source, "spherical.joint").map_err(|errors| errors.to_string())
    };
    for (ground, coupler) in [("2/5", "1/5"), ("1/5", "1/10"), ("4/9", "7/18")] {
        let found = linkage(ground, coupler);
        assert!(found.is_ok(), "{:?}", found.err());
    }
}

/// A second loop on the coupler of a first one: the pins that close either hold by its own relations.
#[test]
fn pins_may_close_several_loops() {
    let source = include_str!("proved/stephenson.joint");
    let joint = derive(source, "stephenson.joint").unwrap_or_else(|errors| panic!("{errors}"));
    for name in ["pins_meet", "pins_hold"] {
        let found = claim(&joint, name).map(|claim| claim.proof);
        assert_eq!(found, Some(Proof::NormalForm), "{name}");
    }
}
