//! No input makes the reader of specs panic, hang or point outside the text.

use hamel_codegen::spec::{self, code};
use std::time::{Duration, Instant};

const CART: &str = include_str!("../../joint-specs/cart.joint");
const PLANAR_EUCLIDEAN: &str = include_str!("../../joint-specs/planar_euclidean.joint");
const DECLARED: &str = "hamel = 1;
/// Everything that a declared manifold has.
joint on_sphere(radius: 1 > 0 <= 5, height: 1 in 0..=1/2) {
    require radius > 2 * height;
    config  n: R3, R: SO3;
    relation dot(n, n) = radius * radius;
    relation R[3, 1] = n.x * n.y / radius;
    home  = [0, 0, radius], I(3);
    basis   u = e1 of so3;
    local   a, b;
    /// The equator.
    except  n.z = 0;
    Phi   = radius * (n + [phi.a, phi.b, 0]) / norm(n + [phi.a, phi.b, 0]), R * exp(phi.R) * exp(tilde([0, phi.a, 0]));
    H     = pose(R, n + [0, 0, atan(height * n.x)]);
}
";
const HEAD: &str = "hamel = 1;\njoint long {\n    config q: R1;\n";

/// Far above what any input takes on a slow machine, far below what an unbounded one would.
const PATIENCE: Duration = Duration::from_secs(20);

/// Reads the text and shows what is wrong with it; returns the codes of the errors.
fn codes(source: &str) -> Vec<&'static str> {
    let start = Instant::now();
    let result = spec::parse(source, "input.joint");
    assert!(
        start.elapsed() < PATIENCE,
        "{:?} for {:.200}",
        start.elapsed(),
        source
    );
    let Err(errors) = result else { return vec![] };
    for error in &errors.errors {
        let span = error.span.clone();
        assert!(
            source.get(span.clone()).is_some(),
            "{span:?} is no range of characters of {source:.200}: {error:?}"
        );
    }
    assert!(
        !errors.errors.is_empty(),
        "rejected without an error: {source:.200}"
    );
    assert!(!errors.render().is_empty());
    errors.errors.iter().map(|error| error.code).collect()
}

/// A spec whose H displaces by the expression.
fn displaced(expression: &str) -> String {
    format!("{HEAD}    H = trans_z({expression});\n}}\n")
}

/// `count` lets, each made from the one before by `step`.
fn lets(count: usize, step: impl Fn(&str) -> String) -> String {
    let mut text = format!("{HEAD}    let a0 = q;\n");
    for n in 1..=count {
        text += &format!("    let a{n} = {};\n", step(&format!("a{}", n - 1)));
    }
    text + &format!("    H = trans_z(a{count});\n}}\n")
}

#[test]
fn a_source_has_a_bounded_size() {
    assert_eq!(
        codes(&format!("{CART}{}", " ".repeat(64 * 1024))),
        [code::SIZE]
    );
    assert_eq!(codes(&format!("{CART}{}", " ".repeat(60 * 1024))), [""; 0]);
}

#[test]
fn deep_text_is_refused() {
    for (open, close) in [("(", ")"), ("[", "]"), ("rot_z(", ")"), ("{", "}")] {
        let text = displaced(&format!("{}q{}", open.repeat(8000), close.repeat(8000)));
        assert_eq!(codes(&text), [code::BRACKETS]);
    }
    assert_eq!(
        codes(&displaced(&format!("{}q", "(".repeat(30_000)))),
        [code::BRACKETS]
    );
    assert_eq!(
        codes(&displaced(&format!("q{}", ".x".repeat(30_000)))),
        [code::EXPECTED]
    );
    assert_eq!(
        codes(&displaced(&format!("q{}", "[1]".repeat(20_000)))),
        [code::EXPECTED]
    );
    assert_eq!(
        codes(&displaced(&format!("q{}", " + q".repeat(15_000)))),
        [code::TOO_LARGE]
    );
}

#[test]
fn long_text_that_is_right_is_read() {
    assert_eq!(
        codes(&displaced(&format!("{}q", "-".repeat(60_000)))),
        [""; 0]
    );
    assert_eq!(
        codes(&displaced(&format!("q{}", " + q".repeat(255)))),
        [""; 0]
    );
    assert_eq!(codes(&lets(2000, |a| format!("{a} + 1"))), [""; 0]);
    assert_eq!(
        codes(&displaced(&format!(
            "{}q{}",
            "(".repeat(61),
            ")".repeat(61)
        ))),
        [""; 0]
    );
}

/// Whether the text is refused for the size of its values alone.
fn is_too_large(source: &str) -> bool {
    let codes = codes(source);
    !codes.is_empty() && codes.iter().all(|code| *code == code::TOO_LARGE)
}

#[test]
fn values_that_would_explode_are_refused() {
    let growing: [fn(&str) -> String; 12] = [
        |a| format!("{a} * {a}"),
        |a| format!("{a} * {a} + 1"),
        |a| format!("sin({a}) + cos({a})"),
        |a| format!("sin({a}) * cos(2 * {a})"),
        |a| format!("cos(16 * {a}) + sin(15 * {a})"),
        |a| format!("exp({a})"),
        |a| format!("tanh({a}) * {a}"),
        |a| format!("1 / (1 + {a})"),
        |a| format!("atan2({a}, 1 + {a})"),
        |a| format!("pow({a} + 1, 16)"),
        |a| format!("sqrt({a} + q)"),
        |a| format!("{a} * 1234567890123456789012345678901234567890"),
    ];
    for step in growing {
        assert!(is_too_large(&lets(40, step)), "{}", step("a"));
    }
    let fractions: Vec<String> = (1000..1250).map(|n| format!("1/{}", 2 * n + 1)).collect();
    assert!(is_too_large(&displaced(&format!(
        "q * ({})",
        fractions.join(" + ")
    ))));
}

#[test]
fn matrices_that_would_explode_are_refused() {
    let entries = ["q + sin(q) + cos(q) + exp(q)"; 12].join(", ");
    let square = [entries.as_str(); 12].join("; ");
    let mut text = format!("{HEAD}    let ma = [{square}];\n");
    for (before, after) in ('a'..'t').zip('b'..='t') {
        text += &format!("    let m{after} = m{before} * m{before};\n");
    }
    assert!(is_too_large(&(text + "    H = trans_z(mt[1, 1]);\n}\n")));
    let wide = vec!["q"; 13].join(", ");
    assert!(is_too_large(&displaced(&format!(
        "dot([{wide}], [{wide}])"
    ))));
    let poses = vec!["rot_x(q + 1) * rot_y(2 * q) * trans_x(q)"; 20].join(" * ");
    assert!(is_too_large(&format!("{HEAD}    H = {poses};\n}}\n")));
}

#[test]
fn characters_of_all_kinds_are_survived() {
    for text in [
        "",
        "\0",
        "\u{feff}",
        "hamel",
        "hamel = 1;",
        "hamel = 1; joint",
        "/*",
        "/*/",
        "///",
        "//!",
        "🦀",
        "é",
        "'a",
        "r#\"",
        "\r",
        "S\u{304}",
    ] {
        assert!(!codes(text).is_empty(), "{text:?} is accepted");
    }
    assert_eq!(codes(&format!("\u{feff}{CART}")), [""; 0]);
    assert_eq!(codes(&CART.replace('\n', "\r\n")), [""; 0]);
    assert_eq!(codes(&CART.replace("// Aᵀ v = 0", "// \0 é 🦀 (")), [""; 0]);
}

/// A linear congruential generator: the mutations are the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}

const SCRAPS: &[&str] = &[
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ";",
    ",",
    "=",
    "-",
    "*",
    "/",
    "^",
    ".",
    ":",
    "0",
    "1.5e3",
    "1e99",
    "q",
    "Q",
    "phi",
    "Phi = ",
    "H = ",
    "X = ",
    "A",
    "S_bar = ",
    "exp(",
    "tilde(",
    "of se2",
    "in child",
    "basis a of r1;",
    "let a = ",
    "SO3",
    "R9",
    "é",
    "ϕ",
    "\0",
    "///",
    "/*",
    "*/",
    "\n",
    " ",
    "I(3)",
    "O(0, 2)",
    "pow(q, -1/2)",
    "theta",
    "local ",
    "Q.x",
    "[1, 2; 3]",
    "R2",
    "R12",
    "relation ",
    "relation Q * Q = 1;",
    "except ",
    "home = ",
    "require ",
    "> 0",
    "< ",
    "in 0..",
    "..=",
    "pow(n.x, 9)",
    " * n.y * n.y",
    "asin(",
];

fn mutated(source: &str, random: &mut Random) -> String {
    let mut characters: Vec<char> = source.chars().collect();
    for _ in 0..=random.below(3) {
        let at = random.below(characters.len());
        match random.below(3) {
            0 => _ = characters.drain(at..(at + 1 + random.below(12)).min(characters.len())),
            1 => _ = characters.splice(at..at, SCRAPS[random.below(SCRAPS.len())].chars()),
            _ => {
                let end = (at + 1 + random.below(20)).min(characters.len());
                let copy: Vec<char> = characters[at..end].to_vec();
                let to = random.below(characters.len());
                _ = characters.splice(to..to, copy);
            }
        }
    }
    characters.into_iter().collect()
}

#[test]
fn a_declared_manifold_is_read() {
    assert_eq!(codes(DECLARED), [""; 0]);
}

/// Random relations: sums of a few terms of low degree, whose Gröbner bases are often beyond the bound.
#[test]
fn relations_without_end_are_refused_in_time() {
    let mut random = Random(7);
    let mut refused = 0;
    for _ in 0..60 {
        let size = 2 + random.below(7);
        let mut text = format!("hamel = 1;\njoint dense {{\n    config q: R{size};\n");
        for _ in 0..1 + random.below(size) {
            let mut terms = vec![];
            for _ in 0..2 + random.below(4) {
                let factors: Vec<String> = (0..1 + random.below(3))
                    .map(|_| {
                        format!(
                            "pow(q[{}], {})",
                            1 + random.below(size),
                            1 + random.below(5)
                        )
                    })
                    .collect();
                terms.push(format!("{} * {}", 1 + random.below(9), factors.join(" * ")));
            }
            text += &format!("    relation {} = 0;\n", terms.join(" - "));
        }
        let declared =
            "    home = O(1, 1);\n    local a;\n    Phi = q;\n    H = trans_z(q[1]);\n}\n";
        let alone = "    home = O(1, 1);\n    H = trans_z(q[1]);\n}\n";
        let seen = [declared, alone].map(|rest| {
            let text = format!("{text}{rest}");
            let start = Instant::now();
            let found = codes(&text);
            assert!(start.elapsed() < PATIENCE, "{:?}: {text}", start.elapsed());
            found
        });
        // Where relations alone say how q moves, their basis is not needed.
        refused += usize::from(seen[0].contains(&code::TOO_LARGE));
    }
    assert!(refused > 5, "{refused} of them were beyond the bound");
}

#[test]
fn mutations_of_specs_are_survived() {
    let mut random = Random(1);
    for source in [CART, PLANAR_EUCLIDEAN, DECLARED] {
        for _ in 0..1500 {
            codes(&mutated(source, &mut random));
        }
    }
}

/// Advice that compares every unknown name with every known one would take the square of their number, and of their length.
#[test]
fn many_names_and_long_ones_are_compared_within_bounds() {
    let joint = |statements: &str| {
        format!("hamel = 1;\njoint j {{ config q: R1; {statements} H = rot_z(q); }}\n")
    };
    let many = (1..3000).map(|i| format!("let a{i} = a{}x;", i - 1));
    let many: String = std::iter::once("let a0 = q;".into()).chain(many).collect();
    let errors = spec::parse(&joint(&many), "j.joint").expect_err("names are missing");
    let advised = |help: &Option<String>| {
        help.as_deref()
            .is_some_and(|h| h.starts_with("did you mean"))
    };
    assert_eq!(errors.errors.len(), 2999);
    assert!(
        errors
            .errors
            .iter()
            .take(50)
            .all(|error| advised(&error.help))
    );
    assert!(
        !errors
            .errors
            .iter()
            .skip(50)
            .any(|error| advised(&error.help))
    );

    let (a, b) = ("a".repeat(30_000), "b".repeat(30_000));
    let long = format!("let {a} = 1; let x = {b};");
    let errors = spec::parse(&joint(&long), "j.joint").expect_err("a name is missing");
    assert_eq!(errors.errors.len(), 1);
}
