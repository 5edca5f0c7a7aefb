//! Loops over pairs of joints in Rust: tables, and a call of the runtime.

use crate::pairs::{Product, Tables};
use hamel_codegen::emit::rust::comment;
use hamel_compiled::{Carrying, Meeting, Pairing, Places};
use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

/// Assigns the rows of a function, made of the numbers in `results`.
pub fn rows(tables: &Tables) -> TokenStream {
    let width = Literal::usize_unsuffixed(tables.size[1]);
    let method = format_ident!("{}", tables.product.name());
    let room = Literal::usize_unsuffixed(tables.room_of_one());
    let room = quote! { let mut room = ::hamel::compiled::Aligned([n(0.0); #room]); };
    let zeros = quote! { rows.as_flattened_mut().fill(n(0.0)); };
    let call = match tables.product {
        Product::Mass | Product::Inverse => quote! {
            #zeros
            PAIRS.#method(&results, rows.as_flattened_mut());
        },
        Product::InverseMass => quote! {
            #room
            PAIRS.#method(&results, &mut room.0, rows.as_flattened_mut());
        },
        Product::Forward | Product::SecondForward => quote! {
            #room
            PAIRS.#method(&results, &mut room.0, rows.as_flattened_mut(), #width);
        },
        Product::SecondInverse => quote! {
            #zeros
            PAIRS.#method(&results, rows.as_flattened_mut(), #width);
        },
    };
    let constants = constants(tables);
    let heading = comment("each pair of joints on one way to the root:");
    quote! {
        #heading
        #constants
        #call
    }
}

/// The rows of eight states side by side, made of the numbers in `results`, so many.
pub fn rows_in_lanes(tables: &Tables, numbers: usize) -> TokenStream {
    let constants = constants(tables);
    let strips = strips(tables, numbers);
    let width = Literal::usize_unsuffixed(tables.size[1]);
    let room = Literal::usize_unsuffixed(tables.room_of_lanes());
    let room = quote! {
        const STRIPS: &[::hamel::compiled::Strip<'static>] = &[#(#strips),*];
        let mut room = [::hamel::compiled::Lanes([0.0; ::hamel::compiled::LANES]); #room];
    };
    let call = match tables.product {
        Product::Mass => quote! { PAIRS.mass_in_lanes(simd, &results, rows); },
        Product::Inverse => quote! { PAIRS.inverse_in_lanes(simd, &results, rows); },
        Product::InverseMass => quote! {
            #room
            PAIRS.inverse_mass_in_lanes(simd, STRIPS, &results, &mut room, rows);
        },
        // Second derivatives are of one state.
        Product::Forward | Product::SecondInverse | Product::SecondForward => quote! {
            #room
            PAIRS.forward_in_lanes(simd, STRIPS, &results, &mut room, (rows, #width));
        },
    };
    quote! {
        #constants
        #call
    }
}

fn strips(tables: &Tables, numbers: usize) -> Vec<TokenStream> {
    let strips = tables.strips(numbers).into_iter();
    let strips = strips.map(|strip| {
        let (columns, rows) = (self::numbers(&strip.columns), strip.rows.iter());
        let rows = rows.map(|range| self::numbers(range));
        let end = Literal::usize_unsuffixed(strip.end);
        quote! { ::hamel::compiled::Strip { columns: #columns, rows: &[#(#rows),*], end: #end } }
    });
    strips.collect()
}

fn constants(tables: &Tables) -> TokenStream {
    let (joints, bodies) = match tables.product.has_bends() {
        true => (&tables.joints[..], &tables.bodies[..]),
        false => (&[][..], &[][..]),
    };
    let joints = joints.iter().map(pairing);
    let bodies = bodies.iter().map(carrying);
    let places = places(&tables.places);
    let [slopes, moved] =
        [&tables.slopes, &tables.moved].map(|all| all.iter().map(meeting).collect::<Vec<_>>());
    let [above, below] = [&tables.ranges(), &tables.below].map(|all| {
        let all = all.iter().map(|ranges| {
            let ranges = ranges.iter().map(|range| numbers(range));
            quote! { &[#(#ranges),*] }
        });
        all.collect::<Vec<_>>()
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
    let mirrored = optional(tables.mirrored);
    quote! {
        const PAIRS: ::hamel::compiled::Pairs<'static> = ::hamel::compiled::Pairs {
            places: #places,
            joints: &[#(#joints),*],
            bodies: &[#(#bodies),*],
            slopes: &[#(#slopes),*],
            moved: &[#(#moved),*],
            above: &[#(#above),*],
            below: &[#(#below),*],
            entries: &[#(#entries),*],
            masses: &[#(#masses),*],
            bends: &[#(#bends),*],
            held: &[#(#held),*],
            columns: &[#(#columns),*],
            followed: &[#(#followed),*],
            mirrored: #mirrored,
        };
    }
}

fn places(places: &Places) -> TokenStream {
    let sizes = numbers(&places.sizes);
    let [
        layers,
        columns,
        variations,
        raised,
        momenta,
        momentum,
        drifts,
        by_rate,
        by_drift,
    ] = [
        places.layers,
        places.columns,
        places.variations,
        places.raised,
        places.momenta,
        places.momentum,
        places.drifts,
        places.by_rate,
        places.by_drift,
    ]
    .map(Literal::usize_unsuffixed);
    quote! {
        ::hamel::compiled::Places {
            sizes: #sizes,
            layers: #layers,
            columns: #columns,
            variations: #variations,
            raised: #raised,
            momenta: #momenta,
            momentum: #momentum,
            drifts: #drifts,
            by_rate: #by_rate,
            by_drift: #by_drift,
        }
    }
}

fn meeting(meeting: &Meeting) -> TokenStream {
    let [row, own, others] =
        [meeting.row, meeting.own, meeting.others].map(Literal::usize_unsuffixed);
    let columns = numbers(&meeting.columns);
    let is_momentum = meeting.is_momentum;
    quote! {
        ::hamel::compiled::Meeting { row: #row, columns: #columns, own: #own, others: #others, is_momentum: #is_momentum }
    }
}

fn pairing(joint: &Pairing) -> TokenStream {
    let (speeds, freedoms) = (numbers(&joint.speeds), numbers(&joint.freedoms));
    let parent = optional(joint.parent);
    quote! {
        ::hamel::compiled::Pairing { speeds: #speeds, freedoms: #freedoms, parent: #parent }
    }
}

fn carrying(body: &Carrying) -> TokenStream {
    let [joint, layer] = [body.joint, body.layer].map(Literal::usize_unsuffixed);
    let parent = optional(body.parent);
    quote! { ::hamel::compiled::Carrying { joint: #joint, parent: #parent, layer: #layer } }
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
