//! Loops over pairs of joints in Rust: tables, and a call of the runtime.

use crate::pairs::{Product, Tables};
use hamel_codegen::emit::rust::comment;
use hamel_compiled::{Carrying, Pairing};
use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

/// The rows of a function, made of the numbers in `results`.
pub fn rows(tables: &Tables) -> TokenStream {
    let [rows, width] = tables.size.map(Literal::usize_unsuffixed);
    let method = format_ident!("{}", tables.product.name());
    let matrix = quote! { let mut matrix = [[n(0.0); #rows]; #rows]; };
    let call = match tables.product {
        Product::Mass => quote! { PAIRS.#method(&results, rows.as_flattened_mut()); },
        Product::InverseMass => quote! {
            #matrix
            PAIRS.#method(&results, matrix.as_flattened_mut(), rows.as_flattened_mut());
        },
        Product::Inverse => quote! { PAIRS.#method(&results, rows.as_flattened_mut(), #width); },
        Product::Forward => quote! {
            #matrix
            PAIRS.#method(&results, matrix.as_flattened_mut(), rows.as_flattened_mut(), #width);
        },
        Product::SecondInverse => {
            quote! { PAIRS.#method(&results, rows.as_flattened_mut(), #width); }
        }
        Product::SecondForward => {
            let room = Literal::usize_unsuffixed(tables.room());
            quote! {
                let mut matrix = [n(0.0); #room];
                PAIRS.#method(&results, &mut matrix, rows.as_flattened_mut(), #width);
            }
        }
    };
    let constants = constants(tables);
    let heading = comment("each pair of joints on one way to the root:");
    quote! {
        #heading
        #constants
        let mut rows = [[n(0.0); #width]; #rows];
        #call
        rows
    }
}

fn constants(tables: &Tables) -> TokenStream {
    let joints = tables.joints.iter().map(pairing);
    let bodies = tables.bodies.iter().map(carrying);
    let above = tables.ranges().into_iter().map(|ranges| {
        let ranges = ranges.iter().map(|range| numbers(range));
        quote! { &[#(#ranges),*] }
    });
    let [entries, masses, bends, followed] = [
        &tables.entries,
        &tables.masses,
        &tables.bends,
        &tables.followed,
    ]
    .map(|table| table.iter().map(|row| numbers(row)).collect::<Vec<_>>());
    let columns = tables.columns.iter().map(|row| numbers(row));
    let held = tables.held.iter().map(|row| numbers(row));
    let filled = tables.filled.iter().map(|row| {
        let words = row.iter().map(|&word| Literal::u64_unsuffixed(word));
        quote! { &[#(#words),*] }
    });
    let below = tables.below.iter().map(|row| {
        let row = numbers(row);
        quote! { &#row }
    });
    let mirrored = optional(tables.mirrored);
    quote! {
        const PAIRS: ::hamel::compiled::Pairs<'static> = ::hamel::compiled::Pairs {
            joints: &[#(#joints),*],
            bodies: &[#(#bodies),*],
            above: &[#(#above),*],
            entries: &[#(#entries),*],
            masses: &[#(#masses),*],
            bends: &[#(#bends),*],
            held: &[#(#held),*],
            columns: &[#(#columns),*],
            followed: &[#(#followed),*],
            filled: &[#(#filled),*],
            below: &[#(#below),*],
            mirrored: #mirrored,
        };
    }
}

fn pairing(joint: &Pairing) -> TokenStream {
    let (speeds, freedoms) = (numbers(&joint.speeds), numbers(&joint.freedoms));
    let (parent, shown) = (
        optional(joint.parent),
        Literal::usize_unsuffixed(joint.shown),
    );
    quote! {
        ::hamel::compiled::Pairing { speeds: #speeds, freedoms: #freedoms, parent: #parent, shown: #shown }
    }
}

fn carrying(body: &Carrying) -> TokenStream {
    let [joint, seen] = [body.joint, body.seen].map(Literal::usize_unsuffixed);
    let parent = optional(body.parent);
    quote! { ::hamel::compiled::Carrying { joint: #joint, parent: #parent, seen: #seen } }
}

fn numbers(row: &[usize]) -> TokenStream {
    let row = row.iter().map(|&number| Literal::usize_unsuffixed(number));
    quote! { [#(#row),*] }
}

fn optional(number: Option<usize>) -> TokenStream {
    match number.map(Literal::usize_unsuffixed) {
        Some(number) => quote! { Some(#number) },
        None => quote! { None },
    }
}
