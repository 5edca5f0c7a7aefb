//! The module that lists all joints: re-exports, registry entries, specs, and a macro for tests.

use super::example;
use super::joint::sizes;
use super::tokens::ident;
use super::{Runtime, WriteError, docs, header, nested, text, type_ident};
use crate::derived::Derived;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

/// How the joints are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Index {
    /// `mod.rs` beside one file per joint, in the crate's module `joints`; exports `for_each_joint!` and `for_each_body!`.
    Files,
    /// One file with a module for each joint, for `include!`.
    Nested,
}

/// The index of the joints, in alphabetic order; `label` names the folder of specs.
///
/// # Errors
/// As [`super::file`]; and where no parameters meet the requirements of a joint that these macros are to build.
pub fn index(
    joints: &[Derived],
    label: &str,
    layout: Index,
    runtime: &Runtime,
) -> Result<String, WriteError> {
    let mut joints: Vec<&Derived> = joints.iter().collect();
    joints.sort_by(|a, b| a.spec.name.value.cmp(&b.spec.name.value));
    let modules: Vec<Ident> = joints
        .iter()
        .map(|joint| ident(&joint.spec.name.value))
        .collect();
    let types: Vec<Ident> = joints.iter().map(|joint| type_ident(joint)).collect();
    let head = match layout {
        Index::Files => {
            let docs = " The joint library: one module a joint, generated from its spec.";
            quote! { #![doc = #docs] #(pub mod #modules;)* }
        }
        Index::Nested => joints.iter().map(|joint| nested(joint)).collect(),
    };
    let macros = match layout {
        Index::Files => Some(macros(&joints)?),
        Index::Nested => None,
    };
    let entries = docs::outer(&["Registry entries of all joints, in alphabetic order."]);
    let specs = docs::outer(&["Name and text of every spec, in alphabetic order."]);
    let names = joints.iter().map(|joint| &joint.spec.name.value);
    let tokens = quote! {
        #head
        #(pub use self::#modules::#types;)*
        #entries
        pub const ENTRIES: &[::hamel::registry::JointEntry] = &[#(self::#modules::ENTRY),*];
        #specs
        pub const SPECS: &[(&::core::primitive::str, &::core::primitive::str)] = &[#((#names, self::#modules::SPEC)),*];
        #macros
    };
    text(
        "the index of all joints",
        &header(label),
        runtime.placed(tokens),
    )
}

/// The macros that hand every joint, and every further body of a joint, to another macro.
fn macros(joints: &[&Derived]) -> Result<TokenStream, WriteError> {
    let of_joints = docs::outer(&[
        "Calls the macro `$callback` once for each joint with",
        "`(module, Type, expression, N, K, S, C)`: the expression builds the joint with parameters that it allows, no two alike.",
    ]);
    let of_bodies = docs::outer(&[
        "Calls the macro `$callback` once for each body that a joint carries after its first with",
        "`(joint_body, Type, expression, B, N, K, S, C)`, of which all but the first and B, the body's place, are as in `for_each_joint!`.",
    ]);
    let (mut joint_calls, mut body_calls) = (vec![], vec![]);
    for joint in joints {
        let (module, name) = (ident(&joint.spec.name.value), type_ident(joint));
        let [n, k, s, c] = sizes(joint);
        let values = example::parameters(&joint.spec).ok_or_else(|| no_parameters(joint))?;
        let value = match joint.spec.parameters.is_empty() {
            true => quote! { $crate::joints::#name },
            false => quote! { $crate::joints::#name::new(#(#values),*) },
        };
        joint_calls
            .push(quote! { $callback!(#module, $crate::joints::#name, #value, #n, #k, #s, #c); });
        for own in &joint.more {
            let body = Literal::usize_unsuffixed(own.body);
            let module = format_ident!("{module}_{}", own.body_name().unwrap_or_default());
            body_calls.push(
                quote! { $callback!(#module, $crate::joints::#name, #value, #body, #n, #k, #s, #c); },
            );
        }
    }
    Ok(quote! {
        #of_joints
        #[macro_export]
        macro_rules! for_each_joint {
            ($callback:path) => { #(#joint_calls)* };
        }
        #of_bodies
        #[macro_export]
        macro_rules! for_each_body {
            ($callback:path) => { #(#body_calls)* };
        }
    })
}

fn no_parameters(joint: &Derived) -> WriteError {
    let requirements = joint.spec.requirements.iter();
    WriteError::NoParameters {
        joint: joint.spec.name.value.clone(),
        requirements: requirements
            .map(|requirement| format!("`{}`", requirement.value.text))
            .collect(),
    }
}
