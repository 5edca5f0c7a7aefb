//! The library's kernels are short and in the words of its specs: the generated files are read as they are committed.

use hamel_codegen::spec;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use syn::spanned::Spanned;

/// Most lines of a kernel's body.
const LONGEST_BODY: usize = 60;

/// Most locals of a kernel that are called by a letter and an index.
const MOST_LETTERS: usize = 6;

/// Most lines of a joint, of each body beyond its first, and of a joint on average.
const LONGEST_JOINT: usize = 650;
const FURTHER_BODY: usize = 130;
const AVERAGE_JOINT: usize = 400;

/// Locals that no spec names: numbers, arguments of kernels, results of the runtime's functions.
const VOCABULARY: &[&str] = &[
    "zero",
    "one",
    "two",
    "three",
    "four",
    "half",
    "third",
    "quarter",
    "pi",
    "nearest",
    "differential",
    "local_rate",
    "start",
    "moved",
    "tangent",
    "tangent_there",
    "rotation",
    "relations",
    "sum",
    "along",
    "back",
    "normal",
    "per_determinant",
    "rates",
    "slope",
    "twists",
];

/// What stands before or after a known name: `v_turn`, `sin_roll`, `radius_squared`.
const PREFIXES: &[&str] = &[
    "phi_", "v_", "p_", "speed_", "sin_", "cos_", "inverse_", "half_", "two_",
];
const SUFFIXES: &[&str] = &[
    "_squared",
    "_target",
    "_moved",
    "_local",
    "_rate",
    "_parameter",
    "_angle",
    "_theta",
];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The names of a spec: parameters, factors, stored scalars, degrees of freedom, speeds, `let`s and their entries.
fn names_of(joint: &str) -> BTreeSet<String> {
    let path = repository().join(format!("joint-specs/{joint}.joint"));
    let source = std::fs::read_to_string(&path).expect("the spec of a generated joint");
    let spec = spec::parse(&source, "library.joint").expect("a spec of the library");
    let mut names = BTreeSet::from(["q".to_owned()]);
    names.extend(spec.parameters.iter().map(|p| p.symbol.name().to_string()));
    for factor in spec.manifold.value.factors() {
        names.insert(factor.name.to_ascii_lowercase());
        names.extend(factor.coordinates.iter().map(|q| q.name().to_string()));
    }
    names.extend(
        spec.freedoms
            .value
            .iter()
            .map(|freedom| freedom.name.clone()),
    );
    names.extend(spec.speed_names.into_iter().flat_map(|names| names.value));
    names.extend(
        spec.worded
            .named
            .iter()
            .map(|named| named.symbol.name().to_string()),
    );
    names
}

/// Whether a local is a name of the spec, a derivative of one, an entry of a stored matrix, or made of these.
fn is_known(local: &str, names: &BTreeSet<String>) -> bool {
    let is_index = |rest: &str| rest.len() <= 2 && rest.chars().all(|c| c.is_ascii_digit());
    let is_entry = names
        .iter()
        .any(|name| local.strip_prefix(name.as_str()).is_some_and(is_index));
    let is_wrench = local.strip_prefix('h').is_some_and(is_index);
    let by_prefix = PREFIXES
        .iter()
        .filter_map(|prefix| local.strip_prefix(prefix));
    let by_suffix = SUFFIXES
        .iter()
        .filter_map(|suffix| local.strip_suffix(suffix));
    let made_of = |rest: &str| rest != local && is_known(rest, names);
    let is_product = local
        .match_indices('_')
        .any(|(at, _)| names.contains(&local[..at]) && names.contains(&local[at + 1..]));
    names.contains(local)
        || VOCABULARY.contains(&local)
        || is_entry
        || is_wrench
        || is_product
        || is_derivative(local, names)
        || is_rate_by(local, names)
        || is_of_relations(local)
        || by_prefix.chain(by_suffix).any(made_of)
}

/// `b_by_left`, the rate of b by that of a direction that the spec names, and `b_by_left_right`, its derivative; by `along` where none is named. `r_2` is the second
/// direction of R; `relation_1_by_b` is a derivative of a relation.
fn is_rate_by(local: &str, names: &BTreeSet<String>) -> bool {
    let Some((of, by)) = local.split_once("_by_") else {
        return false;
    };
    let is_number = |word: &str| word.chars().all(|c| c.is_ascii_digit());
    let is_name = |word: &str| names.iter().any(|name| name.eq_ignore_ascii_case(word));
    let is_direction = |word: &str| word == "along" || is_name(word) || is_number(word);
    let of_what = of.split('_').all(is_direction) || is_of_relations(of);
    of_what && by.split('_').all(is_direction)
}

/// Entries of the linear systems of relations by their numbers, `relation_1_beside_2`, `back_1`; those of a displacement, `xi2`.
fn is_of_relations(local: &str) -> bool {
    let is_number = |word: &str| word.chars().all(|c| c.is_ascii_digit());
    let is_word = |word: &str| ["relation", "beside", "back"].contains(&word) || is_number(word);
    local.split('_').all(is_word) || local.strip_prefix("xi").is_some_and(is_number)
}

/// `d_lean_d_wx`, `d2_lean_d_wx_d_wy`.
fn is_derivative(local: &str, names: &BTreeSet<String>) -> bool {
    let Some((_, rest)) = local.split_once('_').filter(|(d, _)| d.starts_with('d')) else {
        return false;
    };
    let mut parts = rest.split("_d_");
    let of = parts.next().is_some_and(|of| is_known(of, names));
    of && parts.all(|along| names.contains(along))
}

/// The names that a pattern binds.
fn bound(pattern: &syn::Pat) -> Vec<String> {
    match pattern {
        syn::Pat::Ident(name) => vec![name.ident.to_string()],
        syn::Pat::Type(typed) => bound(&typed.pat),
        syn::Pat::Slice(slice) => slice.elems.iter().flat_map(bound).collect(),
        syn::Pat::Tuple(tuple) => tuple.elems.iter().flat_map(bound).collect(),
        _ => vec![],
    }
}

/// The locals of a body.
fn locals(block: &syn::Block) -> Vec<String> {
    let statements = block.stmts.iter();
    let patterns = statements.filter_map(|statement| match statement {
        syn::Stmt::Local(local) => Some(&local.pat),
        _ => None,
    });
    patterns.flat_map(bound).collect()
}

/// The functions of a file: their names, lines of their bodies, and locals.
fn kernels(text: &str) -> Vec<(String, usize, Vec<String>)> {
    let file = syn::parse_file(text).expect("generated code is Rust");
    let functions = file.items.into_iter().filter_map(|item| match item {
        syn::Item::Impl(block) => Some(block.items),
        _ => None,
    });
    let functions = functions.flatten().filter_map(|item| match item {
        syn::ImplItem::Fn(function) => Some(function),
        _ => None,
    });
    let described = functions.map(|function| {
        let span = function.block.span();
        let lines = (span.end().line - span.start().line).saturating_sub(1);
        (
            function.sig.ident.to_string(),
            lines,
            locals(&function.block),
        )
    });
    described.collect()
}

/// What is wrong with a generated joint.
fn faults(joint: &str, text: &str) -> Vec<String> {
    let names = names_of(joint);
    let mut faults = vec![];
    for (kernel, lines, locals) in kernels(text) {
        if lines > LONGEST_BODY {
            faults.push(format!("{joint}::{kernel} has {lines} lines"));
        }
        let others: BTreeSet<&String> = locals
            .iter()
            .filter(|name| !is_known(name, &names))
            .collect();
        let is_letter = |name: &str| {
            name.strip_prefix('t')
                .is_some_and(|n| n.parse::<u8>().is_ok())
        };
        let strange: Vec<&&String> = others.iter().filter(|name| !is_letter(name)).collect();
        if !strange.is_empty() || others.len() > MOST_LETTERS {
            faults.push(format!("{joint}::{kernel} has the locals {others:?}"));
        }
    }
    faults
}

#[test]
fn kernels_of_the_library_are_short_and_in_the_words_of_its_specs() {
    let folder = repository().join("generated/src/joints");
    let (mut all, mut count, mut wrong) = (0, 0, vec![]);
    for entry in std::fs::read_dir(folder).expect("the generated joints") {
        let path = entry.expect("a readable folder").path();
        let joint = path
            .file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        if joint == "mod" {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("a generated joint");
        let lines = text.lines().count();
        let further = text.matches("Carries<").count();
        if lines > LONGEST_JOINT + further * FURTHER_BODY {
            wrong.push(format!("{joint} has {lines} lines"));
        }
        wrong.extend(faults(&joint, &text));
        (all, count) = (all + lines, count + 1);
    }
    if all > AVERAGE_JOINT * count {
        wrong.push(format!("{count} joints have {all} lines"));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The test can fail: a kernel with a name from nowhere, and one with too many lines.
#[test]
fn names_from_nowhere_and_long_bodies_are_found() {
    let lines = "let zero = 0;\n".repeat(61);
    let text =
        format!("impl Ball {{ fn pose() {{ let product_of_q11 = 1; }} fn local() {{\n{lines}}} }}");
    let found = faults("ball", &text);
    assert_eq!(found.len(), 2, "{found:?}");
}
