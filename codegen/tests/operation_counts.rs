//! The operations that a kernel's documentation states are those that its emitted code holds.

use hamel_codegen::{derive, emit};
use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use std::fs;
use std::path::Path;

/// Additions, multiplications, of these fused, divisions, calls.
type Counts = [usize; 5];

/// Functions that count as calls, those of curves among them; those of one angle, sine and cosine, are one.
const CALLS: [&str; 12] = [
    "sin_cos",
    "sqrt",
    "exp",
    "ln",
    "atan2",
    "stumpff",
    "dexp_inverse",
    "rotation_vector",
    "quaternion_vector",
    "nearest_rotation",
    "at",
    "derivative",
];

/// A parameter as divisor, shared sums, functions of one angle, and a column of relations.
const HARDER: [&str; 3] = [
    "hamel = 1; joint ellipsoid(a: m, b: m, c: m) { config Q: SO3; basis e1, e2, e3 of so3; velocity in child;
       H = pose(Q, [a*a*Q[1,3], b*b*Q[2,3], c*c*Q[3,3]] / norm([a*Q[1,3], b*Q[2,3], c*Q[3,3]])); }",
    "hamel = 1; joint helix(r: m, lead: m) { config s: R1; H = rot_z(s) * trans([r, 0, lead * s / (2 * pi)]); }",
    "hamel = 1; joint s3ball { config Q: S3; basis e1, e2, e3 of so3; velocity in child; H = pose(rot(Q), [0, 0, 0]); }",
];

#[test]
fn stated_operations_are_those_of_the_code() {
    let mut kernels = 0;
    for source in library().iter().map(String::as_str).chain(HARDER) {
        let derived = derive(source, "test").unwrap_or_else(|errors| panic!("{errors}"));
        let text = emit::rust::file(&derived, "test.joint", &emit::rust::Runtime::default())
            .expect("the emitted tokens are Rust");
        let file = syn::parse_file(&text).expect("the emitted text is Rust");
        for method in methods(&file) {
            let Some(stated) = stated(method).filter(|_| !calls_group(&method.block)) else {
                continue;
            };
            let name = format!("{}::{}", derived.spec.name.value, method.sig.ident);
            assert_eq!(counted(&method.block), stated, "{name}");
            kernels += 1;
        }
    }
    // At least 5 kernels a joint are formulas of their own.
    assert!(
        kernels >= 5 * (library().len() + HARDER.len()),
        "{kernels} kernels are too few"
    );
}

#[test]
fn sums_shared_between_entries_keep_long_kernels_small() {
    let derived = derive(HARDER[0], "ellipsoid.joint").unwrap_or_else(|errors| panic!("{errors}"));
    let report = emit::Report::new(&derived);
    let total: usize = report.counts.iter().map(|row| row.operations.total()).sum();
    // Entries factored one by one take 8860 operations; sums that are shared and named take 1200 or so.
    assert!(total < 1500, "{total} operations");
}

fn library() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../joint-specs");
    let files = fs::read_dir(folder).expect("the library is there");
    let specs = files.map(|file| file.expect("can be listed").path());
    let specs = specs.filter(|path| path.extension().is_some_and(|end| end == "joint"));
    specs
        .map(|path| fs::read_to_string(path).expect("can be read"))
        .collect()
}

fn methods(file: &syn::File) -> impl Iterator<Item = &syn::ImplItemFn> {
    let items = file.items.iter().filter_map(|item| match item {
        syn::Item::Impl(block) => Some(&block.items),
        _ => None,
    });
    items.flatten().filter_map(|item| match item {
        syn::ImplItem::Fn(method) => Some(method),
        _ => None,
    })
}

/// What the documentation says behind `Operations:`; nothing where it does not.
fn stated(method: &syn::ImplItemFn) -> Option<Counts> {
    let docs: String = method
        .attrs
        .iter()
        .map(|attribute| attribute.to_token_stream().to_string())
        .collect();
    let (_, text) = docs.split_once("Operations: ")?;
    let (text, _) = text.split_once('.')?;
    let names = [
        "addition",
        "multiplication",
        "of each fused",
        "division",
        "function call",
    ];
    Some(names.map(|name| {
        let before = text
            .split(name)
            .next()
            .filter(|before| before.len() < text.len());
        let number = before.and_then(|before| before.trim().rsplit([' ', '(']).next());
        number.map_or(0, |number| {
            number.parse().expect("a number stands before each name")
        })
    }))
}

/// Whether the block adds whole vectors, or calls functions of the runtime's groups: `tests/src/operations` counts what they do.
fn calls_group(block: &syn::Block) -> bool {
    let groups = ["real", "s1", "s2", "s3", "so2", "so3", "se2", "se3"];
    let text = block.to_token_stream().to_string();
    let of_vectors = ["{ q + phi }", "{ target - q }"].contains(&text.as_str());
    of_vectors
        || groups
            .iter()
            .any(|group| text.contains(&format!("{group} :: ")))
}

/// The operations of `dot([a, b], [x, y])` except for those in its entries: n products, of which all but one are fused with a sum.
fn count_dot(arguments: &TokenStream, counts: &mut Counts) {
    let first = arguments.clone().into_iter().next();
    if let Some(TokenTree::Group(entries)) = first {
        let is_comma =
            |token: &TokenTree| matches!(token, TokenTree::Punct(p) if p.as_char() == ',');
        let commas = entries.stream().into_iter().filter(is_comma).count();
        counts[0] += commas;
        counts[1] += commas + 1;
        counts[2] += commas;
    }
}

fn counted(block: &syn::Block) -> Counts {
    let mut counts = [0; 5];
    let relations = block.stmts.iter().find_map(relations).unwrap_or(0);
    count(block.to_token_stream(), relations, &mut counts);
    counts
}

/// The length of the array that `relations` names.
fn relations(statement: &syn::Stmt) -> Option<usize> {
    let syn::Stmt::Local(local) = statement else {
        return None;
    };
    if let syn::Pat::Type(typed) = &local.pat {
        let syn::Type::Array(array) = typed.ty.as_ref() else {
            return None;
        };
        let count = array.len.to_token_stream().to_string().parse().ok();
        let is_it = typed.pat.to_token_stream().to_string() == "relations";
        return count.filter(|_| is_it);
    }
    let syn::Expr::Array(array) = local.init.as_ref()?.expr.as_ref() else {
        return None;
    };
    (local.pat.to_token_stream().to_string() == "relations").then_some(array.elems.len())
}

/// Counts operators between operands, and calls; the closure of `fold` runs once for each relation.
fn count(tokens: TokenStream, relations: usize, counts: &mut Counts) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let is_operand = |token: Option<&TokenTree>| match token {
        Some(TokenTree::Ident(_) | TokenTree::Literal(_) | TokenTree::Group(_)) => true,
        Some(TokenTree::Punct(_)) | None => false,
    };
    for (i, token) in tokens.iter().enumerate() {
        let before = i.checked_sub(1).and_then(|i| tokens.get(i));
        let after = tokens.get(i + 1);
        match token {
            TokenTree::Ident(name) if name == "mul_add" => (0..3).for_each(|k| counts[k] += 1),
            TokenTree::Ident(name)
                if CALLS.iter().any(|call| name == call)
                    && matches!(after, Some(TokenTree::Group(_))) =>
            {
                counts[4] += 1
            }
            TokenTree::Punct(sign) if is_operand(before) => match sign.as_char() {
                '+' => counts[0] += 1,
                '-' => counts[0] += 1,
                '*' => counts[1] += 1,
                '/' => counts[3] += 1,
                _ => {}
            },
            TokenTree::Group(group) => {
                let mut inner = [0; 5];
                let function = before.map(ToString::to_string).unwrap_or_default();
                if function == "dot" {
                    count_dot(&group.stream(), &mut inner);
                }
                // Constants are folded by the compiler.
                if function != "from_f64" {
                    count(group.stream(), relations, &mut inner);
                }
                let times = if function == "fold" { relations } else { 1 };
                (0..5).for_each(|k| counts[k] += times * inner[k]);
            }
            _ => {}
        }
    }
}
