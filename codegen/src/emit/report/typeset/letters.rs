//! Names as mathematicians write them: `theta` is θ, `l2` is l₂, `r_outer` has an index.

use super::Math;

/// Greek letters: name in a spec, sign, and name in LaTeX.
const GREEK: &[(&str, char, &str)] = &[
    ("alpha", 'α', r"\alpha"),
    ("beta", 'β', r"\beta"),
    ("gamma", 'γ', r"\gamma"),
    ("delta", 'δ', r"\delta"),
    ("epsilon", 'ε', r"\varepsilon"),
    ("zeta", 'ζ', r"\zeta"),
    ("eta", 'η', r"\eta"),
    ("theta", 'θ', r"\theta"),
    ("kappa", 'κ', r"\kappa"),
    ("lambda", 'λ', r"\lambda"),
    ("mu", 'μ', r"\mu"),
    ("nu", 'ν', r"\nu"),
    ("xi", 'ξ', r"\xi"),
    ("pi", 'π', r"\pi"),
    ("rho", 'ρ', r"\rho"),
    ("sigma", 'σ', r"\sigma"),
    ("tau", 'τ', r"\tau"),
    ("phi", 'ϕ', r"\phi"),
    ("chi", 'χ', r"\chi"),
    ("psi", 'ψ', r"\psi"),
    ("omega", 'ω', r"\omega"),
    ("Phi", 'Φ', r"\Phi"),
];

/// The name of a parameter, factor or intermediate value.
pub fn named(name: &str) -> Math {
    let (stem, index) = match name.split_once('_') {
        Some((stem, index)) if !stem.is_empty() && !index.is_empty() => (stem, index),
        _ => name.split_at(name.trim_end_matches(|c: char| c.is_ascii_digit()).len()),
    };
    match (stem, index) {
        (_, "") => word(name),
        ("", _) => Math::Word(name.to_owned()),
        (stem, index) => word(stem).with_index(word(index)),
    }
}

/// A name without an index.
fn word(name: &str) -> Math {
    if let Some((_, letter, _)) = GREEK.iter().find(|(known, ..)| *known == name) {
        return Math::Letter(*letter);
    }
    let mut letters = name.chars();
    match (letters.next(), letters.next(), name.parse()) {
        (_, _, Ok(number)) => Math::integer(number),
        (Some(only), None, _) => Math::Letter(only),
        _ => Math::Word(name.to_owned()),
    }
}

/// The macro of a letter that has one.
pub(super) fn latex_name(letter: char) -> Option<&'static str> {
    let known = GREEK.iter().find(|(_, greek, _)| *greek == letter);
    known.map(|(_, _, latex)| *latex)
}
