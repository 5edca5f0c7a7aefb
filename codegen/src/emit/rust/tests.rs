//! What is emitted where no formula serves: calls of the runtime's iterations, ranges and requirements of parameters, loci.
//!
//! The joints are derived from specs with closed forms and patched, so that these tests need no derivation of other maps.

use super::{Index, Runtime, file, imports, index};
use crate::derive;
use crate::derived::{Derived, Kernel, KernelKind, Method, Structure};
use crate::emit::types::type_name;
use crate::emit::{Accuracy, Report, explain_text, page};
use crate::expr::{Expr, Rational};
use crate::matrix::Matrix;
use crate::model::{Declared, End, Interval, Locus, Requirement};

const BALL: &str = "hamel = 1;
/// Ball joint.
joint ball {
    config Q: SO3;
    basis e1, e2, e3 of so3;
    velocity in parent;
    H = pose(Q, [0, 0, 0]);
}";

const CRANK: &str = "hamel = 1;
/// Crank.
joint crank(/** Radius. */ outer: m, inner: 1) {
    config q: R1;
    H = rot_z(q) * trans_x(outer) * trans_z(q / inner);
}";

fn derived(source: &str) -> Derived {
    derive(source, "test").unwrap_or_else(|errors| panic!("{errors}"))
}

fn emitted(derived: &Derived) -> String {
    let text = file(derived, "joint-specs/test.joint", &Runtime::default())
        .expect("the emitted tokens are Rust");
    // Without line breaks: what matters is what is called.
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn assert_contains(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
}

fn by(method: Method, kind: KernelKind, outputs: Vec<Matrix>) -> Kernel {
    Kernel {
        kind,
        steps: vec![],
        outputs,
        method,
        structure: Structure::General,
    }
}

/// The joint with the kernels in place of its own of the same kinds.
fn patched(mut derived: Derived, kernels: Vec<Kernel>) -> Derived {
    kernels
        .into_iter()
        .for_each(|kernel| derived.replace(kernel));
    derived
}

/// The ball joint as if nothing were known of its Φ and its manifold.
fn numeric_ball() -> Derived {
    let ball = derived(BALL);
    let q = Matrix::symbols(&ball.arguments.configuration);
    let relations = Matrix::column_vector(ball.space.manifold.relations());
    patched(
        ball,
        vec![
            by(Method::Newton, KernelKind::Local, vec![]),
            by(Method::Solve, KernelKind::RetractDifferential, vec![]),
            by(
                Method::Solve,
                KernelKind::RetractDifferentialInverse,
                vec![],
            ),
            by(Method::Formula, KernelKind::Relations, vec![relations]),
            by(Method::Newton, KernelKind::Project, vec![q]),
        ],
    )
}

#[test]
fn maps_without_closed_form_call_the_runtime() {
    let text = emitted(&numeric_ball());
    assert_contains(
        &text,
        &[
            "::hamel::finite::local(q, target, |q, phi| self.retract(q, phi))",
            "fn retract_differential<T: Scalar>(&self, q: &SVector<T, 9>, phi: &SVector<T, 3>) -> SMatrix<T, 3, 3> { \
             ::hamel::finite::differential(q, phi, |q, phi| self.retract(q, phi)) }",
            "::hamel::finite::differential_inverse(q, phi, rate, |q, phi| self.retract(q, phi))",
            "::hamel::finite::project(q, 6, |q| self.relations(q))",
            "By Newton's method from ϕ = 0, in at most `finite::LOCAL_ITERATIONS` steps",
        ],
    );
}

#[test]
fn relations_are_a_method_of_the_type() {
    let text = emitted(&numeric_ball());
    let (own, of_trait) = text
        .split_once("impl Joint<9, 3, 3, 0> for Ball {")
        .expect("the implementation");
    assert_contains(own, &["impl Ball {", "pub fn relations<T: Scalar>("]);
    assert!(!of_trait.contains("fn relations<"), "{of_trait}");
}

#[test]
fn a_projection_begins_at_the_value_of_its_formulas() {
    let ball = numeric_ball();
    let halved = Matrix::symbols(&ball.arguments.configuration).scale(&Expr::fraction(1, 2));
    let ball = patched(
        ball,
        vec![by(Method::Newton, KernelKind::Project, vec![halved])],
    );
    assert_contains(
        &emitted(&ball),
        &[
            "let start: SVector<T, 9> = {",
            "half * q11",
            "::hamel::finite::project(&start, 6,",
        ],
    );
}

/// Of the 12 entries, 6 relations leave the pose of a rigid body; those of the cosets leave 2 degrees of freedom, or 4.
#[test]
fn a_projection_solves_as_many_relations_as_the_coset_has() {
    for (basis, rank) in [
        (
            "turn = 1/3 * e1 + 2/3 * e2 + 2/3 * e3 + 1/30 * e4 + 2/30 * e5 + 2/30 * e6",
            10,
        ),
        ("turn = e3 + 1/10 * e6, x = e4, y = e5", 8),
        ("turn = e3, x = e4, y = e5", 9),
    ] {
        let text = emitted(&derived(&format!(
            "hamel = 1; joint some {{ config Q: SE3; basis {basis} of se3; velocity in child; H = Q; }}"
        )));
        assert_contains(&text, &[&format!("{rank}, |q| self.relations(q))")]);
    }
}

#[test]
fn pages_and_the_index_take_kernels_without_formulas() {
    let ball = numeric_ball();
    let report = Report::new(&ball);
    assert!(
        report
            .formulas
            .iter()
            .all(|formula| !formula.text.trim().is_empty())
    );
    explain_text(&ball, &Accuracy::default()).expect("the template holds");
    page(&ball, "joint-specs/test.joint", &Accuracy::default()).expect("the template holds");
    index(&[ball], "joint-specs", Index::Nested, &Runtime::default())
        .expect("the emitted tokens are Rust");
}

fn declared<T>(value: T) -> Declared<T> {
    Declared { value, span: 0..0 }
}

fn end(above: i64, below: i64, included: bool) -> Option<End> {
    let value = Rational::new(above.into(), below.into());
    Some(End { value, included })
}

#[test]
fn loci_become_a_distance() {
    assert_contains(
        &emitted(&derived(BALL)),
        &["const SINGULARITIES: &'static [&'static str] = &[];"],
    );
    assert!(!emitted(&derived(BALL)).contains("fn singularity"));
    let mut ball = derived(BALL);
    let functions = [0, 4].map(|n| Expr::symbol(&ball.arguments.configuration[n]));
    for (function, text) in functions.iter().zip(["Q[1, 1]", "Q[2, 2]"]) {
        ball.space.loci.push(declared(Locus {
            function: function.clone(),
            text: text.into(),
            docs: String::new(),
        }));
    }
    let column = Matrix::column_vector(functions.to_vec());
    let ball = patched(
        ball,
        vec![by(Method::Formula, KernelKind::Singularity, vec![column])],
    );
    assert_contains(
        &emitted(&ball),
        &[
            "const SINGULARITIES: &'static [&'static str] = &[\"Q[1, 1]\", \"Q[2, 2]\"];",
            "::hamel::finite::least_absolute([q11, q22])",
        ],
    );
}

#[test]
fn finite_maps_of_known_groups_are_calls() {
    let ball = emitted(&derived(BALL));
    assert_contains(
        &ball,
        &[
            "{ so3::times_exp(q, phi) }",
            "{ so3::log_between(q, target) }",
            "{ so3::differential(phi) }",
            "{ so3::differential_inverse(phi, rate) }",
            "{ so3::nearest(q) }",
            "{ so3::residual_squared(q).sqrt() }",
            "Zero, and not written: A, ∂S̄/∂ϕ, c.",
        ],
    );
    let turned = BALL.replace("e1, e2, e3 of", "a = e2, b = e1 + e2, c = e3 of");
    assert_contains(
        &emitted(&derived(&turned)),
        &[
            "so3::times_exp(q, &SVector::from([phi_b, phi_a + phi_b, phi_c]))",
            "let [q_log1, q_log2, q_log3]: [T; 3] = so3::log_between(q, target).into(); \
             SVector::from([q_log2 - q_log1, q_log1, q_log3])",
        ],
    );
    let moving = "hamel = 1; joint some { config R: SO3, p: R2; basis wx, wy, wz of so3; velocity in child; \
                  H = pose(R, [p.x, p.y, 0]); }";
    assert_contains(
        &emitted(&derived(moving)),
        &[
            "let r_moved = so3::times_exp(&part(q, 0), &part(phi, 0)); \
             let p_moved = real::times_exp::<T, 2>(&part(q, 9), &part(phi, 3)); \
             stacked(&[r_moved.as_slice(), p_moved.as_slice()])",
            "put(&mut nearest, 0, &so3::nearest(&part(q, 0)));",
            "put_block(&mut differential, 0, &so3::differential(&part(phi, 0)));",
            "let r_rate = so3::rate(&part(q, 0), &part(v, 0));",
        ],
    );
}

#[test]
fn ranges_and_requirements_are_checked() {
    let mut crank = derived(CRANK);
    assert_contains(
        &emitted(&crank),
        &[
            "ParameterInfo::new(\"outer\", \"m\", \"Radius.\"), ParameterInfo::new(\"inner\", \"1\", \"\")",
            "if outer == 0.0 {",
            "if inner == 0.0 {",
            "In m. It is other than 0.",
        ],
    );
    crank.spec.parameters[1].range = Interval {
        lower: end(0, 1, false),
        upper: end(5, 2, true),
    };
    let [outer, inner] = [0, 1].map(|n| Expr::symbol(&crank.spec.parameters[n].symbol));
    crank.spec.requirements.push(declared(Requirement {
        value: &outer - &(&Expr::integer(2) * &inner),
        text: "outer > 2 * inner".into(),
    }));
    let text = emitted(&crank);
    assert_contains(
        &text,
        &[
            "ParameterInfo::new(\"inner\", \"1\", \"\").above(0.0).at_most(2.5)",
            "It is greater than 0 and at most 2.5.",
            "They must meet `outer > 2 * inner`.",
            "type T = f64;",
            "check_requirement(\"crank\", \"outer > 2 * inner\", two.mul_add(-inner, outer), &PARAMETERS, values)?;",
        ],
    );
    assert!(
        !text.contains("if inner == 0.0"),
        "its range excludes 0: {text}"
    );
}

#[test]
fn no_type_and_no_variable_is_called_like_an_import() {
    let is_type = |name: &str| name.starts_with(char::is_uppercase);
    let imported: Vec<&str> = imports()
        .iter()
        .flat_map(|(_, names)| *names)
        .copied()
        .collect();
    assert!(imported.len() > 10, "{imported:?}");
    // Paths begin with modules, which variables cannot hide; `dot` is a word of the language.
    let others = ["dot", "real", "s1", "s2", "s3", "se2", "se3", "so2", "so3"];
    for name in imported.into_iter().filter(|name| !others.contains(name)) {
        if is_type(name) {
            let words = name.char_indices().flat_map(|(i, c)| {
                let between = (i > 0 && c.is_uppercase()).then_some('_');
                between.into_iter().chain(c.to_lowercase())
            });
            assert_ne!(type_name(&words.collect::<String>()), name);
        } else {
            let joint = derived(&format!(
                "hamel = 1; joint some({name}: m) {{ config q: R1; H = trans_x({name} * q); }}"
            ));
            let parameter = &joint.spec.parameters[0].symbol;
            assert_eq!(joint.names().get(parameter), format!("{name}_parameter"));
        }
    }
}

#[test]
fn variables_of_build_keep_clear_of_its_argument_and_of_constants() {
    let text = emitted(&derived(
        "hamel = 1; joint some(values: m, erase: m, two: m, three_halves: m) {\n\
         require 2 * values > 3/2 * erase + two + three_halves;\n\
         config q: R1; H = rot_z(q) * trans_x(values + erase + two + three_halves); }",
    ));
    assert_contains(
        &text,
        &[
            "let [values_parameter, erase, two_parameter, three_halves] = ::hamel::registry::check_parameters( \"some\", &PARAMETERS, values, )?;",
            "let two = T::from_f64(2.0);",
            "let three_halves_2 = T::from_f64(1.5);",
            "SomeJoint::new(values_parameter, erase, two_parameter, three_halves)",
        ],
    );
}

#[test]
fn the_runtime_stands_where_a_build_says() {
    let joint = derived(BALL);
    let at = |path: &str| {
        let runtime = path.parse().expect("a path");
        file(&joint, "joint-specs/test.joint", &runtime).expect("the emitted tokens are Rust")
    };
    assert!(
        at("::hamel") == file(&joint, "joint-specs/test.joint", &Runtime::default()).expect("Rust")
    );
    for (path, written) in [
        ("hamel_runtime", "::hamel_runtime::joint"),
        ("mechanics::hamel", "::mechanics::hamel::joint"),
        ("crate::hamel", "use crate::hamel::joint"),
    ] {
        let text = at(path);
        assert!(text.contains(written), "{path}: {text}");
        assert!(!text.contains(" ::hamel::"), "{path}");
    }
    for wrong in ["", "a b", "self::hamel", "super::hamel", "a::<b>", "3"] {
        assert!(wrong.parse::<Runtime>().is_err(), "{wrong}");
    }
}
