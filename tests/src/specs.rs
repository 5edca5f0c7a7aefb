//! Random valid specs: joints that hold their claims by construction, no two alike.

use chacha20::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::fmt::Write;

/// What a random joint does, with what makes its X full of rank everywhere.
#[derive(Clone, Copy)]
enum Family {
    /// A turn about an axis while sliding along any path: the turn alone has rank 1.
    Path,
    /// The graph of functions over two or three coordinates: the coordinates themselves are rows of X.
    Graph,
    /// A turn and slides that do not depend on it.
    Slides,
    /// Two turns about perpendicular axes.
    Universal,
    /// A rotation with the child away from its centre.
    Ball,
    /// A motion of the plane or of space, with a fixed placement of the child.
    Motion,
    /// A rotation about a centre that moves.
    Floating,
    /// A motion of the plane with forbidden velocities.
    Rolling,
}

const FAMILIES: [Family; 8] = [
    Family::Path,
    Family::Graph,
    Family::Slides,
    Family::Universal,
    Family::Ball,
    Family::Motion,
    Family::Floating,
    Family::Rolling,
];

/// The spec number `seed`, of a joint called `joint_<seed>`.
pub fn random(seed: u64) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let family = FAMILIES[seed as usize % FAMILIES.len()];
    let body = body(family, &mut random);
    let parameters = ["a: 1", "b: 1"].iter().filter(|p| mentions(&body, &p[..1]));
    let parameters: Vec<&str> = parameters.copied().collect();
    let head = match parameters.is_empty() {
        true => String::new(),
        false => format!("({})", parameters.join(", ")),
    };
    format!(
        "hamel = 1;\n\n/// A joint made by chance, number {seed}.\njoint joint_{seed}{head} {{\n{body}}}\n"
    )
}

/// Whether a name occurs as a word.
fn mentions(text: &str, name: &str) -> bool {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_')
        .any(|word| word == name)
}

fn pick<'a>(random: &mut ChaCha8Rng, choices: &[&'a str]) -> &'a str {
    choices[random.random_range(0..choices.len())]
}

/// A number that is not 0, exact in the language.
fn number(random: &mut ChaCha8Rng) -> String {
    let sign = if random.random_bool(0.5) { "-" } else { "" };
    format!(
        "{sign}{}.{}",
        random.random_range(1..4),
        random.random_range(0..100)
    )
}

/// A smooth function of the variable, of one or two terms.
fn function(random: &mut ChaCha8Rng, of: &str) -> String {
    let term = |random: &mut ChaCha8Rng| {
        let factor = match random.random_bool(0.5) {
            true => pick(random, &["a", "b"]).to_owned(),
            false => number(random),
        };
        let shape = pick(
            random,
            &[
                "{}",
                "{} * {}",
                "sin({})",
                "cos({})",
                "sin(2 * {})",
                "pow({}, 3)",
            ],
        );
        format!("{factor} * {}", shape.replace("{}", of))
    };
    match random.random_bool(0.5) {
        true => term(random),
        false => format!("{} + {}", term(random), term(random)),
    }
}

fn point(random: &mut ChaCha8Rng) -> String {
    format!(
        "[{}, {}, {}]",
        number(random),
        pick(random, &["a", "b", "0"]),
        number(random)
    )
}

fn body(family: Family, random: &mut ChaCha8Rng) -> String {
    let mut text = String::new();
    let mut line = |content: String| writeln!(text, "    {content}").is_ok();
    let axis = pick(random, &["x", "y", "z"]);
    match family {
        Family::Path => {
            let path = (0..3)
                .map(|_| function(random, "q"))
                .collect::<Vec<_>>()
                .join(", ");
            line("config q: R1;".into());
            line(format!(
                "H = trans([{path}]) * rot_{axis}({} * q) * trans({});",
                number(random),
                point(random)
            ));
        }
        Family::Graph => {
            line("config p: R2;".into());
            let height = format!("{} + {}", function(random, "p.x"), function(random, "p.y"));
            line(format!("let height = {height};"));
            line(format!(
                "H = pose(rot_{axis}({}), [p.x, p.y, height]);",
                number(random)
            ));
        }
        Family::Slides => {
            line("config turn: R1, s: R2;".into());
            let (x, y) = (number(random), number(random));
            line(format!(
                "H = trans([s.x + {}, s.y, {}]) * rot_z({x} * turn) * trans([0, 0, {y}]);",
                number(random),
                pick(random, &["a", "b", "1"])
            ));
        }
        Family::Universal => {
            let (first, second) = [("x", "y"), ("y", "z"), ("z", "x")][random.random_range(0..3)];
            line("config first: R1, second: R1;".into());
            line(format!(
                "H = rot_{first}({} * first) * trans({}) * rot_{second}({} * second);",
                number(random),
                point(random),
                number(random)
            ));
        }
        Family::Ball => {
            let kind = pick(random, &["SO3", "S3"]);
            line(format!("config Q: {kind};"));
            line("basis wx, wy, wz of so3;".into());
            line("velocity in child;".into());
            line(format!(
                "H = trans({}) * rot(Q) * trans({});",
                point(random),
                point(random)
            ));
        }
        Family::Motion => {
            let (kind, basis, pose) = match random.random_bool(0.5) {
                true => (
                    "SE2",
                    "turn, along, across of se2",
                    "pose(rot_z(Q), [Q.x, Q.y, 0])",
                ),
                false => ("SE3", "wx, wy, wz, vx, vy, vz of se3", "Q"),
            };
            line(format!("config Q: {kind};"));
            line(format!("basis {basis};"));
            line("velocity in child;".into());
            line(format!("H = {pose} * trans({});", point(random)));
        }
        Family::Floating => {
            line(format!(
                "config R: {}, p: R3;",
                pick(random, &["SO3", "S3"])
            ));
            line("basis wx, wy, wz of so3;".into());
            line("velocity in child;".into());
            line(format!("H = trans(p) * rot(R) * trans({});", point(random)));
        }
        Family::Rolling => {
            line("config Q: SE2;".into());
            line("basis turn, along, across of se2;".into());
            line("velocity in child;".into());
            line("H = pose(rot_z(Q), [Q.x, Q.y, 0]);".into());
            line(format!(
                "S_bar = [1, 0; 0, 1; {}, 0];",
                pick(random, &["a", "b", "1", "-2.5", "0"])
            ));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    /// Each family several times, through the whole pipeline.
    #[test]
    fn random_specs_are_valid() {
        for seed in 0..48 {
            let text = super::random(seed);
            if let Err(errors) = hamel_codegen::derive(&text, &format!("joint_{seed}.joint")) {
                panic!("{errors}\n{text}");
            }
        }
    }
}
