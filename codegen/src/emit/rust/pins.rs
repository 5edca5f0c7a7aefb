//! The constant `PINS`. What is used of the runtime here is written with its path: a joint may have the name of any of it.

use crate::derived::Derived;
use crate::expand::{PinDrive, Source};
use crate::model::Pin;
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// The constant; the trait's default where there are no pins.
pub fn constant(derived: &Derived) -> Option<TokenStream> {
    let pins = &derived.spec.pins;
    let own = pins.iter().zip(&derived.pin_drives);
    let own = own.map(|(declared, drives)| pin(&declared.value, drives));
    let own: Vec<TokenStream> = own.collect();
    (!own.is_empty()).then(|| quote! { const PINS: &'static [::hamel::joint::Pin] = &[#(#own),*]; })
}

fn pin(pin: &Pin, drives: &[PinDrive]) -> TokenStream {
    let name = &pin.name;
    let [first, second] = pin.ends.each_ref().map(|end| match end.body {
        Some(body) => {
            let body = Literal::usize_unsuffixed(body);
            quote! { Some(#body) }
        }
        None => quote! { None },
    });
    let turning = match (pin.about, pin.along) {
        (Some(_), _) => quote! { AboutAxis },
        (None, Some(_)) => quote! { Not },
        (None, None) => quote! { Freely },
    };
    let slides = pin.along.is_some();
    let drives = drives.iter().map(drive);
    quote! {
        ::hamel::joint::Pin {
            name: #name,
            bodies: [#first, #second],
            turning: ::hamel::joint::Turning::#turning,
            slides: #slides,
            drives: &[#(#drives),*],
        }
    }
}

fn drive(drive: &PinDrive) -> TokenStream {
    let source = match drive.source {
        Source::Freedom(place) => {
            let place = Literal::usize_unsuffixed(place);
            quote! { Freedom(#place) }
        }
        Source::Port(place) => {
            let place = Literal::usize_unsuffixed(place);
            quote! { Port(#place) }
        }
    };
    let (turns, reversed) = (drive.turns, drive.reversed);
    quote! {
        ::hamel::joint::PinDrive {
            source: ::hamel::joint::DriveSource::#source,
            turns: #turns,
            reversed: #reversed,
        }
    }
}
