//! The curves of a joint, as constants beside it.

use super::docs;
use super::tokens::{curve_name, ident};
use crate::expr::curve::{Curve, Outside};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// One constant for each curve.
pub fn constants(curves: &[Curve]) -> TokenStream {
    let constants = curves.iter().map(|curve| {
        let docs = docs::outer(&[format!(
            "The curve `{}` of the spec: {}.",
            curve.name(),
            curve.in_words()
        )]);
        constant(*curve, &curve_name(*curve), &docs)
    });
    quote! { #(#constants)* }
}

/// The constant of one curve; its type and `Outside` are in scope.
pub fn constant(curve: Curve, name: &str, docs: &TokenStream) -> TokenStream {
    let name = ident(name);
    let table = curve.table();
    let knots = table.knots.iter().map(|knot| number(*knot));
    let numbers = table.coefficients.iter().map(|entry| number(*entry));
    let outside = ident(match table.outside {
        Outside::Undefined => "Undefined",
        Outside::Periodic => "Periodic",
        Outside::Straight => "Straight",
        Outside::Polynomial => "Polynomial",
    });
    quote! {
        #docs
        #[allow(clippy::approx_constant, reason = "knots in radians are multiples of π where those of the spec are in degrees")]
        static #name: Curve = Curve::new(&[#(#knots),*], &[#(#numbers),*], Outside::#outside);
    }
}

/// A finite double, with its sign.
fn number(value: f64) -> TokenStream {
    let size = Literal::f64_unsuffixed(value.abs());
    match value.is_sign_negative() {
        true => quote! { -#size },
        false => quote! { #size },
    }
}
