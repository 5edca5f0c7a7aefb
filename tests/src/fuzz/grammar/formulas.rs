//! Random formulas: smooth functions, positive ones, zeros that are identities.

use chacha20::ChaCha8Rng;
use rand::RngExt;

pub fn pick<'a>(random: &mut ChaCha8Rng, choices: &[&'a str]) -> &'a str {
    choices[random.random_range(0..choices.len())]
}

/// An exact number that is not 0.
pub fn number(random: &mut ChaCha8Rng) -> String {
    let size = pick(random, &["0.5", "1", "2", "3", "0.25", "1.5", "0.1", "7"]);
    match random.random_bool(0.25) {
        true => format!("(-{size})"),
        false => size.into(),
    }
}

/// A smooth function of a variable, defined everywhere.
pub fn smooth(random: &mut ChaCha8Rng, x: &str) -> String {
    let shape = pick(
        random,
        &[
            "sin({})",
            "cos({})",
            "{} * {}",
            "pow({}, 3)",
            "exp({})",
            "exp(-{} * {})",
            "tanh({})",
            "sinh({})",
            "cosh({})",
            "sqrt(1 + {} * {})",
            "log(2 + {} * {})",
            "1 / (1 + {} * {})",
            "atan({})",
            "sin(2 * {})",
            "cos({} / 2)",
            "{}",
            "{} * sin({})",
            "exp({}) / (1 + exp({}))",
            "log(1 + exp({}))",
            "{} / sqrt(1 + {} * {})",
        ],
    );
    let inner = match random.random_bool(0.2) {
        true => format!("({} * {x})", number(random)),
        false => x.to_owned(),
    };
    format!(
        "{} * {}",
        number(random),
        bracketed(&shape.replace("{}", &inner))
    )
}

fn bracketed(text: &str) -> String {
    format!("({text})")
}

/// A function that is positive everywhere.
pub fn positive(random: &mut ChaCha8Rng, x: &str) -> String {
    pick(
        random,
        &[
            "1",
            "2",
            "(1 + {} * {})",
            "exp({})",
            "(2 + sin({}))",
            "cosh({})",
            "sqrt(1 + {} * {})",
            "(3 + tanh({}))",
            "1 / (1 + {} * {})",
            "(1 + exp({}))",
            "exp(-{} * {})",
            "(5 - 3 * cos({}))",
            "(1 + pow({}, 4))",
        ],
    )
    .replace("{}", x)
}

/// 0 by an identity.
pub fn nothing(random: &mut ChaCha8Rng, x: &str) -> String {
    pick(
        random,
        &[
            "sin({}) * sin({}) + cos({}) * cos({}) - 1",
            "cosh({}) * cosh({}) - sinh({}) * sinh({}) - 1",
            "exp({}) * exp(-{}) - 1",
            "exp(2 * {}) - exp({}) * exp({})",
            "exp(5) * exp(23) - exp(28)",
            "sqrt(1 + {} * {}) * sqrt(1 + {} * {}) - 1 - {} * {}",
            "1 / sqrt(1 + {} * {}) * (1 / sqrt(1 + {} * {})) - 1 / (1 + {} * {})",
            "sin(2 * {}) - 2 * sin({}) * cos({})",
            "exp({} + 1) - exp(1) * exp({})",
            "sqrt(2) * sqrt(3) - sqrt(6)",
            "tanh({}) * cosh({}) - sinh({})",
            "sqrt(4 + 4 * {} * {}) - 2 * sqrt(1 + {} * {})",
        ],
    )
    .replace("{}", x)
}
