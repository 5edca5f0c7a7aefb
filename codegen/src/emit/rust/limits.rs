//! What a joint demands of its parameters: ranges, requirements, and without a range that they are not zero.

use super::tokens::{Writer, ident, signed_literal};
use crate::derived::Derived;
use crate::expr::Rational;
use crate::formula::Names;
use crate::formula::{Program, factored};
use crate::model::{End, Interval, Parameter};
use num_traits::ToPrimitive;
use proc_macro2::TokenStream;
use quote::quote;

/// The range of a parameter as methods of its entry: `.above(0.0).at_most(2.5)`.
pub fn methods(range: &Interval) -> TokenStream {
    let limit = |end: &Option<End>, included: &str, excluded: &str| {
        end.as_ref().map(|end| {
            let method = ident(if end.included { included } else { excluded });
            let value = signed_literal(&end.value);
            quote! { .#method(#value) }
        })
    };
    let lower = limit(&range.lower, "at_least", "above");
    let upper = limit(&range.upper, "at_most", "below");
    quote! { #lower #upper }
}

/// The range in words: `greater than 0 and at most 1`, `other than 0`.
pub fn in_words(range: &Interval) -> String {
    let words = |end: &Option<End>, included: &str, excluded: &str| {
        let end = end.as_ref()?;
        let word = if end.included { included } else { excluded };
        Some(format!("{word} {}", decimal(&end.value)))
    };
    let lower = words(&range.lower, "at least", "greater than");
    let upper = words(&range.upper, "at most", "less than");
    let ends: Vec<String> = lower.into_iter().chain(upper).collect();
    match ends.is_empty() {
        true => "other than 0".to_owned(),
        false => ends.join(" and "),
    }
}

fn decimal(value: &Rational) -> String {
    value
        .to_f64()
        .map_or(value.to_string(), |value| value.to_string())
}

/// The checks of `build`, in which each parameter is a variable.
pub fn checks(derived: &Derived, names: &Names) -> TokenStream {
    let requirements = requirements(derived, names);
    // Without a range, everything was proved for every number but zero.
    let parameters = derived.spec.parameters.iter();
    let nonzero = parameters
        .filter(|parameter| parameter.range == Interval::default())
        .map(|parameter| nonzero(derived, parameter, names));
    quote! { #requirements #(#nonzero)* }
}

/// Each requirement as a check of its margin, a polynomial in the parameters.
fn requirements(derived: &Derived, names: &Names) -> TokenStream {
    let joint = &derived.spec.name.value;
    let requirements = &derived.spec.requirements;
    if requirements.is_empty() {
        return TokenStream::new();
    }
    let nothing = Program {
        bindings: vec![],
        outputs: vec![],
    };
    let writer = Writer::new(names, &nothing);
    let checks: Vec<TokenStream> = requirements
        .iter()
        .map(|requirement| {
            let text = &requirement.value.text;
            let margin = writer.formula(&factored(&requirement.value.value).polished());
            quote! { ::hamel::registry::check_requirement(#joint, #text, #margin, &PARAMETERS, values)?; }
        })
        .collect();
    let constants = writer.constants();
    // The formulas are written for any scalar; here it is that of the parameters.
    let scalar = (!constants.is_empty()).then(|| quote! { type T = f64; });
    quote! { #scalar #constants #(#checks)* }
}

fn nonzero(derived: &Derived, parameter: &Parameter, names: &Names) -> TokenStream {
    let joint = &derived.spec.name.value;
    let (text, field) = (parameter.symbol.name(), ident(names.get(&parameter.symbol)));
    quote! {
        if #field == 0.0 {
            return Err(ParameterError::OutOfRange {
                joint: #joint,
                parameter: #text,
                value: #field,
                requirement: "other than 0",
            });
        }
    }
}
