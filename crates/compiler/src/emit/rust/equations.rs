//! The constant of a module by which the runtime finds its functions.

use crate::emit::Function;
use crate::functions::Kind;
use crate::model::Model;
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

/// Whether the runtime takes the function for many states.
pub fn is_batched(function: &Function) -> bool {
    let mut kinds = Kind::ALL.iter().filter(|kind| kind.is_batched());
    kinds.any(|kind| kind.name() == function.name)
}

/// The constant by which the runtime finds the functions.
pub fn equations(model: &Model, functions: &[Function], lanes: bool) -> TokenStream {
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
    // A row without numbers is no row.
    let rows = |kind| some(of(kind).map(rows_of_state));
    let (forward_slopes, inverse_slopes) = (
        rows(Kind::ForwardDerivatives),
        rows(Kind::InverseDerivatives),
    );
    let lanes = lanes && model.sizes().iter().all(|&size| size > 0);
    let many = |kind| some(of(kind).filter(|_| lanes).map(many_states));
    let (forward_lanes, inverse_lanes) = (many(Kind::ForwardDynamics), many(Kind::InverseDynamics));
    let batched = functions
        .iter()
        .filter(|function| lanes && is_batched(function));
    let of_state = batched.map(of_state);
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
            in_lanes: ::hamel::compiled::InLanes {
                forward_dynamics: #forward_lanes,
                inverse_dynamics: #inverse_lanes,
            },
            #hamiltonian
        };
        #(#of_state)*
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
    let name = Ident::new(function.name, Span::call_site());
    let count = Literal::usize_unsuffixed(function.results());
    let entries = match function.columns {
        None => quote! { as_slice },
        Some(_) => quote! { as_flattened },
    };
    quote! {
        |q, v, u, results| {
            if let (Some(q), Some(v), Some(u), Some(results)) =
                (q.first_chunk(), v.first_chunk(), u.first_chunk(), results.get_mut(..#count))
            {
                results.copy_from_slice(#name::<f64>(q, v, u).#entries());
            }
        }
    }
}

fn many_states(function: &Function) -> TokenStream {
    let (kind, sizes) = (in_lanes(function), argument_sizes(function));
    quote! { ::hamel::compiled::many_states::<#kind, #(#sizes),*> }
}

/// A function as a type, for the loop over states.
fn of_state(function: &Function) -> TokenStream {
    let (name, kind) = (
        Ident::new(function.name, Span::call_site()),
        in_lanes(function),
    );
    let sizes = argument_sizes(function);
    let [q, v, u] = [0, 1, 2].map(|i| sizes.get(i));
    let docs = format!(" `{}` in a loop over states.", function.name);
    quote! {
        #[doc = #docs]
        struct #kind;
        impl ::hamel::compiled::OfState<#(#sizes),*> for #kind {
            #[inline(always)]
            fn value<T: Scalar>(q: &[T; #q], v: &[T; #v], u: &[T; #u]) -> [T; #v] {
                #name(q, v, u)
            }
        }
    }
}

fn argument_sizes(function: &Function) -> Vec<Literal> {
    let sizes = function.arguments.iter();
    sizes
        .map(|&(_, size)| Literal::usize_unsuffixed(size))
        .collect()
}

/// The name of a function as a type.
fn in_lanes(function: &Function) -> Ident {
    let words = function.name.split('_').map(|word| {
        let (first, rest) = word.split_at(1);
        first.to_ascii_uppercase() + rest
    });
    Ident::new(&words.collect::<String>(), Span::call_site())
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
