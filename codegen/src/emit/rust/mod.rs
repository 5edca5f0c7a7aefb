//! Rust source of a joint: one module with its type, its kernels and its registry entry.

mod bodies;
mod comment;
mod curves;
mod docs;
mod entry;
mod example;
mod functions;
mod group;
mod index;
mod joint;
mod limits;
mod lines;
mod method;
mod numeric;
mod patterns;
mod pins;
mod program;
mod result;
mod runtime;
mod spacing;
#[cfg(test)]
mod tests;
mod tokens;

pub use comment::comment;
pub use curves::constant as curve_constant;
pub use index::{Index, index};
pub use runtime::{Runtime, RuntimeError};

use super::header;
use super::types::type_name;
use crate::derived::Derived;
use proc_macro2::{Ident, Literal, TokenStream, TokenTree};
use quote::quote;
use std::collections::BTreeSet;
use tokens::ident;

/// Version of the runtime's trait `Joint` that is emitted.
pub const KERNEL_INTERFACE: u32 = 7;

/// The file of one joint, a module of its own. `label` names the spec: `joint-specs/ball.joint`.
///
/// # Errors
/// Tokens that are no Rust: a fault of this crate, reported with the name of the joint.
pub fn file(derived: &Derived, label: &str, runtime: &Runtime) -> Result<String, WriteError> {
    let items = runtime.placed(items(derived));
    text(&derived.spec.name.value, &header(label), items)
}

/// The module of one joint with its braces, for a file that holds several.
pub fn nested(derived: &Derived) -> TokenStream {
    let module = ident(&derived.spec.name.value);
    let items = items(derived);
    quote! { pub mod #module { #items } }
}

fn items(derived: &Derived) -> TokenStream {
    let docs = docs::module(derived);
    let curves = curves::constants(&derived.spec.curves());
    let joint = joint::tokens(derived);
    let entry = entry::tokens(derived);
    let uses = uses(&quote! { #curves #joint #entry });
    let version = Literal::u32_unsuffixed(KERNEL_INTERFACE);
    quote! {
        #docs
        #uses
        const _: () = ::hamel::joint::assert_kernel_interface(#version);
        #curves
        #joint
        #entry
    }
}

/// What an emitted file may import, by module. Functions that `build` calls are not among them: a parameter may have their names.
fn imports() -> [(TokenStream, &'static [&'static str]); 7] {
    [
        (quote! { ::hamel::curve }, &["Curve", "Outside"]),
        (
            quote! { ::hamel::group },
            &[
                "part",
                "put",
                "put_block",
                "real",
                "s1",
                "s2",
                "s3",
                "se2",
                "se3",
                "so2",
                "so3",
                "stacked",
            ],
        ),
        (
            quote! { ::hamel::joint },
            &[
                "Joint",
                "Patterns",
                "Structure",
                "Structures",
                "VelocityFrame",
                "from_rows",
                "rows_at",
            ],
        ),
        (quote! { ::hamel::nalgebra }, &["SMatrix", "SVector"]),
        (
            quote! { ::hamel::registry },
            &["JointEntry", "ParameterError", "ParameterInfo"],
        ),
        (quote! { ::hamel::scalar }, &["Scalar", "dot"]),
        (quote! { ::hamel::spatial }, &["Pose", "nearest_rotation"]),
    ]
}

/// Imports of the names that occur.
fn uses(tokens: &TokenStream) -> TokenStream {
    let mut found = BTreeSet::new();
    collect_identifiers(tokens.clone(), &mut found);
    let lines = imports().into_iter().filter_map(|(path, names)| {
        let used: Vec<_> = names
            .iter()
            .filter(|name| found.contains(**name))
            .map(|name| ident(name))
            .collect();
        match used.as_slice() {
            [] => None,
            [one] => Some(quote! { use #path::#one; }),
            several => Some(quote! { use #path::{#(#several),*}; }),
        }
    });
    quote! { #(#lines)* }
}

fn collect_identifiers(tokens: TokenStream, found: &mut BTreeSet<String>) {
    for token in tokens {
        match token {
            TokenTree::Ident(ident) => {
                found.insert(ident.to_string());
            }
            TokenTree::Group(group) => collect_identifiers(group.stream(), found),
            _ => {}
        }
    }
}

/// Formatted text with its header; `joint` names what it is of in errors.
///
/// # Errors
/// Tokens that are no Rust.
pub fn text(joint: &str, header: &str, items: TokenStream) -> Result<String, WriteError> {
    let parsed = syn::parse2::<syn::File>(items);
    let file = parsed.map_err(|error| WriteError::Malformed {
        joint: joint.to_owned(),
        reason: error.to_string(),
    })?;
    Ok(format!("// {header}\n{}", spacing::spaced(&file)))
}

/// Why a file cannot be written.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum WriteError {
    /// Emitted tokens that are no Rust: a fault of this crate.
    Malformed {
        /// The joint.
        joint: String,
        /// What the parser says.
        reason: String,
    },
    /// No values of the parameters were found that meet all requirements of a joint, which `for_each_joint!` is to build.
    NoParameters {
        /// The joint.
        joint: String,
        /// Its requirements, as the spec writes them.
        requirements: Vec<String>,
    },
}

impl std::fmt::Display for WriteError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Malformed { joint, reason } => write!(
                f,
                "the code emitted for `{joint}` is no Rust ({reason}): please report this spec"
            ),
            Self::NoParameters {
                joint,
                requirements,
            } => write!(
                f,
                "no values of the parameters of `{joint}` were found that meet {}: narrow their ranges",
                requirements.join(", ")
            ),
        }
    }
}

impl std::error::Error for WriteError {}

/// The identifier of a joint's type.
fn type_ident(derived: &Derived) -> Ident {
    ident(&type_name(&derived.spec.name.value))
}
