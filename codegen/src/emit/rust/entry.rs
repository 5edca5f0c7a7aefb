//! The registry entry of a joint, and the text of its spec.

use super::docs;
use super::limits;
use super::tokens::ident;
use super::type_ident;
use crate::derived::Derived;
use crate::emit::report::summary;
use crate::formula::Names;
use crate::text::is_visible;
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// `ENTRY`, `SPEC` and the table of parameters.
pub fn tokens(derived: &Derived) -> TokenStream {
    let spec = &derived.spec;
    let name = &spec.name.value;
    let summary = summary(&spec.docs, name);
    let build = build(derived);
    let infos = spec.parameters.iter().map(|parameter| {
        let (name, unit, description) = (
            parameter.symbol.name(),
            &parameter.unit,
            parameter.docs.trim(),
        );
        let limits = limits::methods(&parameter.range);
        quote! { ParameterInfo::new(#name, #unit, #description) #limits }
    });
    let count = Literal::usize_unsuffixed(spec.parameters.len());
    let (table, parameters) = match spec.parameters.is_empty() {
        true => (None, quote! { &[] }),
        false => (
            Some(quote! { const PARAMETERS: [ParameterInfo; #count] = [#(#infos),*]; }),
            quote! { &PARAMETERS },
        ),
    };
    let source = raw_string(&spec.whole_source());
    let entry_docs = docs::outer(&["How a scene finds this joint by name."]);
    let spec_docs = docs::outer(&["The spec that this joint was generated from."]);
    quote! {
        #table
        #entry_docs
        pub const ENTRY: JointEntry = JointEntry {
            name: #name,
            summary: #summary,
            parameters: #parameters,
            build: #build,
        };
        #spec_docs
        pub const SPEC: &str = #source;
    }
}

fn build(derived: &Derived) -> TokenStream {
    let name = &derived.spec.name.value;
    let type_name = type_ident(derived);
    let parameters = &derived.spec.parameters;
    if parameters.is_empty() {
        return quote! {
            |values| {
                ::hamel::registry::check_parameters(#name, &[], values)?;
                Ok(::hamel::erased::erase(#type_name))
            }
        };
    }
    let names = Names::of_parameters(&derived.spec.parameters);
    let fields: Vec<_> = parameters
        .iter()
        .map(|parameter| ident(names.get(&parameter.symbol)))
        .collect();
    let checks = limits::checks(derived, &names);
    quote! {
        |values| {
            let [#(#fields),*] = ::hamel::registry::check_parameters(#name, &PARAMETERS, values)?;
            #checks
            Ok(::hamel::erased::erase(#type_name::new(#(#fields),*)))
        }
    }
}

/// The text as a raw string literal, so that a reader sees the spec as it was written. A text of which a reader would not see all is escaped
/// instead: a raw literal cannot hold a carriage return, and the compiler denies characters that turn the direction of writing.
fn raw_string(text: &str) -> Literal {
    if !is_visible(text) {
        return Literal::string(text);
    }
    let longest = text
        .split('"')
        .skip(1)
        .map(|rest| rest.chars().take_while(|c| *c == '#').count() + 1)
        .max();
    let signs = "#".repeat(longest.unwrap_or(0).max(1));
    format!("r{signs}\"{text}\"{signs}")
        .parse()
        .unwrap_or_else(|_| Literal::string(text))
}
