//! The constant of a module by which the runtime finds its functions.

use super::{into, lanes};
use crate::emit::Function;
use crate::functions::Kind;
use crate::model::Model;
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

/// The constant by which the runtime finds the functions.
pub fn equations(model: &Model, functions: &[Function], lanes: &[&Function]) -> TokenStream {
    let [configuration, freedoms, speeds] = model.sizes().map(Literal::usize_unsuffixed);
    let scene = &model.name;
    let of = |kind: Kind| {
        functions
            .iter()
            .find(|function| function.name == kind.name())
    };
    let some = |found: Option<TokenStream>| match found {
        None => quote! { None },
        Some(value) => quote! { Some(#value) },
    };
    let one = |kind| some(of(kind).map(one_state));
    let (forward, inverse) = (one(Kind::ForwardDynamics), one(Kind::InverseDynamics));
    let rows = |kind| some(of(kind).map(rows_of_state));
    let (forward_slopes, inverse_slopes) = (
        rows(Kind::ForwardDerivatives),
        rows(Kind::InverseDerivatives),
    );
    let weighted = |kind| some(of(kind).map(rows_of_weights));
    let (forward_bends, inverse_bends) = (
        weighted(Kind::ForwardSecondDerivatives),
        weighted(Kind::InverseSecondDerivatives),
    );
    let size = of(Kind::ForwardDerivatives).map_or(0, Function::results);
    let size = Literal::usize_unsuffixed(size);
    let masses = [Kind::MassMatrix, Kind::InverseMassMatrix].map(|kind| {
        let name = Ident::new(kind.name(), Span::call_site());
        let value = some(of(kind).map(rows_of_configuration));
        quote! { #name: #value, }
    });
    let in_lanes = in_lanes(lanes);
    let hamiltonian = hamiltonian_form(functions);
    quote! {
        /// These functions for the runtime, in double precision.
        pub const EQUATIONS: ::hamel::compiled::Equations = ::hamel::compiled::Equations {
            scene: #scene,
            configuration: #configuration,
            freedoms: #freedoms,
            speeds: #speeds,
            forward_dynamics: #forward,
            inverse_dynamics: #inverse,
            forward_dynamics_derivatives: #forward_slopes,
            inverse_dynamics_derivatives: #inverse_slopes,
            forward_dynamics_second_derivatives: #forward_bends,
            inverse_dynamics_second_derivatives: #inverse_bends,
            forward_slopes: #size,
            #(#masses)*
            in_lanes: #in_lanes,
            #hamiltonian
        };
    }
}

/// A function of slices that are cut to its sizes.
fn one_state(function: &Function) -> TokenStream {
    let name = Ident::new(function.name, Span::call_site());
    quote! {
        |q, v, u, results| {
            if let (Some(q), Some(v), Some(u), Some(results)) =
                (q.first_chunk(), v.first_chunk(), u.first_chunk(), results.first_chunk_mut())
            {
                *results = #name::<f64>(q, v, u);
            }
        }
    }
}

/// The same with results in rows, one after the other.
fn rows_of_state(function: &Function) -> TokenStream {
    let into = into(function);
    quote! {
        |q, v, u, results| {
            if let (Some(q), Some(v), Some(u), Some(rows)) = (
                q.first_chunk(),
                v.first_chunk(),
                u.first_chunk(),
                results.as_chunks_mut().0.first_chunk_mut(),
            ) {
                #into::<f64>(q, v, u, rows);
            }
        }
    }
}

/// The same with weights λ.
fn rows_of_weights(function: &Function) -> TokenStream {
    let into = into(function);
    quote! {
        |q, v, u, lambda, results| {
            if let (Some(q), Some(v), Some(u), Some(lambda), Some(rows)) = (
                q.first_chunk(),
                v.first_chunk(),
                u.first_chunk(),
                lambda.first_chunk(),
                results.as_chunks_mut().0.first_chunk_mut(),
            ) {
                #into::<f64>(q, v, u, lambda, rows);
            }
        }
    }
}

/// The same of Q alone.
fn rows_of_configuration(function: &Function) -> TokenStream {
    let into = into(function);
    quote! {
        |q, _, _, results| {
            if let (Some(q), Some(rows)) =
                (q.first_chunk(), results.as_chunks_mut().0.first_chunk_mut())
            {
                #into::<f64>(q, rows);
            }
        }
    }
}

/// The functions of many states.
fn in_lanes(lanes: &[&Function]) -> TokenStream {
    if lanes.is_empty() {
        return quote! { ::hamel::compiled::InLanes::NONE };
    }
    let batched = Kind::ALL.iter().filter(|kind| kind.is_batched());
    let fields = batched.map(|kind| {
        let name = Ident::new(kind.name(), Span::call_site());
        let mut found = lanes.iter().filter(|function| function.name == kind.name());
        match found.next() {
            Some(function) => {
                let many = lanes::many_states(function);
                quote! { #name: Some(#many), }
            }
            None => quote! { #name: None, },
        }
    });
    quote! { ::hamel::compiled::InLanes { #(#fields)* } }
}

/// The fields of that constant for the port-Hamiltonian form.
fn hamiltonian_form(functions: &[Function]) -> TokenStream {
    let field = |kind: Kind, value: TokenStream| {
        let name = Ident::new(kind.name(), Span::call_site());
        match functions
            .iter()
            .any(|function| function.name == kind.name())
        {
            true => quote! { #name: Some(#value), },
            false => quote! { #name: None, },
        }
    };
    let map = |kind: Kind| {
        let name = Ident::new(kind.name(), Span::call_site());
        let value = quote! {
            |q, v, out| {
                if let (Some(q), Some(v), Some(out)) =
                    (q.first_chunk(), v.first_chunk(), out.first_chunk_mut())
                {
                    *out = #name::<f64>(q, v);
                }
            }
        };
        field(kind, value)
    };
    let rates = quote! {
        |q, p, tau, speeds, rates| {
            if let (Some(q), Some(p), Some(tau), Some(speeds), Some(rates)) = (
                q.first_chunk(),
                p.first_chunk(),
                tau.first_chunk(),
                speeds.first_chunk_mut(),
                rates.first_chunk_mut(),
            ) {
                [*speeds, *rates] = momentum_rates::<f64>(q, p, tau);
            }
        }
    };
    let energy = quote! {
        |q, p| match (q.first_chunk(), p.first_chunk()) {
            (Some(q), Some(p)) => hamiltonian::<f64>(q, p)[0],
            _ => f64::NAN,
        }
    };
    let fields = [
        map(Kind::Momenta),
        map(Kind::Speeds),
        field(Kind::MomentumRates, rates),
        field(Kind::Hamiltonian, energy),
    ];
    quote! { #(#fields)* }
}
