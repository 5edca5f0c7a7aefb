//! Lines and formulas in Rust.

use super::super::lines::{Formula, Line, Loop, Place};
use super::super::{array, list};
use crate::alike::Read;
use crate::packs::WIDTH;
use hamel_codegen::derived::Primitive;
use hamel_codegen::emit::rust::comment;
use hamel_codegen::expr::Function as Known;
use hamel_codegen::expr::curve::Curve;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

/// A line as text.
pub fn line(line: &Line) -> TokenStream {
    match line {
        Line::Heading(heading) => {
            let operations = heading.operations;
            comment(&format!(
                "{}: {} ({operations})",
                heading.body, heading.topic
            ))
        }
        Line::Value(name, formula) => {
            let (name, value) = (format_ident!("{name}"), value(formula));
            quote! { let #name = #value; }
        }
        Line::SinCosAll(all) => {
            let sines = all.iter().map(|(sin, ..)| format_ident!("{sin}"));
            let cosines = all.iter().map(|(_, cos, _)| format_ident!("{cos}"));
            let angles = all.iter().map(|(.., angle)| value(angle));
            quote! {
                let (sines, cosines) = T::sin_cos_all(&[#(#angles),*]);
                let [#(#sines),*] = sines;
                let [#(#cosines),*] = cosines;
            }
        }
        Line::SinCos(sin, cos, angle) => {
            let (sin, cos, angle) = (
                format_ident!("{sin}"),
                format_ident!("{cos}"),
                factor(angle),
            );
            quote! { let (#sin, #cos) = #angle.sin_cos(); }
        }
        Line::Angles(angles) => {
            let angles = angles.iter().map(value);
            quote! { let (sines, cosines) = T::sin_cos_all(&[#(#angles),*]); }
        }
        Line::Row(row) => {
            let name = format_ident!("{}", array(row.values.len()));
            let (place, values) = (index(row.place), row.values.iter().map(value));
            quote! { #name[#place] = [#(#values),*]; }
        }
        Line::Result(place, formula) => {
            let (place, value) = (index(*place), value(formula));
            quote! { results[#place] = #value; }
        }
        Line::Loop(looped) => turns(looped),
        Line::Extracted(names, formula) => {
            let rest = (names.len() < WIDTH).then(|| quote! { .. });
            let names = names.iter().map(|name| format_ident!("{name}"));
            let value = factor(formula);
            quote! { let [#(#names,)* #rest] = #value.to_array(); }
        }
    }
}

/// A loop over like bodies, with its tables.
fn turns(looped: &Loop) -> TokenStream {
    let count = Literal::usize_unsuffixed(looped.bodies.len());
    let heading = comment(&format!("each of {}:", list(&looped.bodies)));
    let table = |what: &str| format_ident!("{}_{what}", looped.name.to_uppercase());
    let numbers = table_of(&looped.numbers, |number| {
        let literal = Literal::f64_unsuffixed(number.abs());
        if number.is_sign_negative() {
            quote! { -#literal }
        } else {
            quote! { #literal }
        }
    });
    let numbers = numbers.map(|(width, rows)| {
        let name = table("NUMBERS");
        (
            quote! { const #name: [[f64; #width]; #count] = [#(#rows),*]; },
            quote! { let numbers = &#name[i]; },
        )
    });
    let places = table_of(&looped.places, |place| {
        let literal = Literal::usize_unsuffixed(*place);
        quote! { #literal }
    });
    let places = places.map(|(width, rows)| {
        let name = table("PLACES");
        (
            quote! { const #name: [[usize; #width]; #count] = [#(#rows),*]; },
            quote! { let places = &#name[i]; },
        )
    });
    let (constants, bindings): (Vec<_>, Vec<_>) = numbers.into_iter().chain(places).unzip();
    let sources = looped.sources.iter().map(|(name, width, place)| {
        let (name, array, place) = (
            format_ident!("{name}"),
            format_ident!("{}", array(*width)),
            index(*place),
        );
        quote! { let #name = &#array[#place]; }
    });
    let lines = looped.lines.iter().map(line);
    quote! {
        #heading
        #(#constants)*
        for i in 0..#count {
            #(#bindings)*
            #(#sources)*
            #(#lines)*
        }
    }
}

/// Width and rows of a table; none where it has no columns.
fn table_of<T>(
    rows: &[Vec<T>],
    entry: impl Fn(&T) -> TokenStream,
) -> Option<(Literal, Vec<TokenStream>)> {
    let width = rows.first().map_or(0, Vec::len);
    let row = |row: &Vec<T>| {
        let entries = row.iter().map(&entry);
        quote! { [#(#entries),*] }
    };
    (width > 0).then(|| {
        (
            Literal::usize_unsuffixed(width),
            rows.iter().map(row).collect(),
        )
    })
}

/// An index as text.
fn index(place: Place) -> TokenStream {
    let number = |number: i64| {
        let literal = Literal::i64_unsuffixed(number.abs());
        (number != 0).then_some((number < 0, literal))
    };
    let (base, offset) = match place {
        Place::Known(place) => {
            let place = Literal::usize_unsuffixed(place);
            return quote! { #place };
        }
        Place::Along { start, step } if step < 0 => {
            // Positive at every turn, where `start` is the largest.
            let (start, step) = (
                Literal::i64_unsuffixed(start),
                Literal::i64_unsuffixed(-step),
            );
            return quote! { #start - #step * i };
        }
        Place::Along { start, step } => {
            let literal = Literal::i64_unsuffixed(step);
            let base = if step == 1 {
                quote! { i }
            } else {
                quote! { #literal * i }
            };
            (base, number(start))
        }
        Place::Listed { column, offset } => {
            let column = Literal::usize_unsuffixed(column);
            (quote! { places[#column] }, number(offset))
        }
    };
    match offset {
        None => base,
        Some((false, offset)) => quote! { #base + #offset },
        Some((true, offset)) => quote! { #base - #offset },
    }
}

/// A formula where nothing stands beside it.
pub fn value(formula: &Formula) -> TokenStream {
    match formula {
        Formula::Number(number) => {
            let literal = Literal::f64_unsuffixed(number.abs());
            match number.is_sign_negative() {
                true => quote! { n(-#literal) },
                false => quote! { n(#literal) },
            }
        }
        Formula::Column(column) => {
            let column = Literal::usize_unsuffixed(*column);
            quote! { n(numbers[#column]) }
        }
        Formula::Input(array, place) => {
            let name = match array {
                Read::Argument(argument) => argument.name(),
                Read::Sines => "sines",
                Read::Cosines => "cosines",
            };
            let (name, index) = (format_ident!("{name}"), index(*place));
            quote! { #name[#index] }
        }
        Formula::Lane(array, place) => {
            let (array, place) = (format_ident!("{array}"), Literal::usize_unsuffixed(*place));
            quote! { n(#array[#place].0[lane]) }
        }
        Formula::Source(name, entry) => {
            let (name, entry) = (format_ident!("{name}"), Literal::usize_unsuffixed(*entry));
            quote! { #name[#entry] }
        }
        Formula::Row(width, row, entry) => {
            let name = format_ident!("{}", array(*width));
            let (row, entry) = (
                Literal::usize_unsuffixed(*row),
                Literal::usize_unsuffixed(*entry),
            );
            quote! { #name[#row][#entry] }
        }
        Formula::Name(name) => {
            let name = format_ident!("{name}");
            quote! { #name }
        }
        Formula::Sum(terms) => sum(terms),
        Formula::Product(a, b) => {
            let (a, b) = (factor(a), factor(b));
            quote! { #a * #b }
        }
        Formula::Quotient(a, b) => {
            let (a, b) = (factor(a), factor(b));
            quote! { #a / #b }
        }
        Formula::Negative(inner) => {
            let inner = factor(inner);
            quote! { -#inner }
        }
        Formula::Call(function, arguments) => call(*function, arguments),
        Formula::Several(function, arguments) => several(*function, arguments),
        Formula::Gathered(numbers) => match numbers.as_slice() {
            [first, rest @ ..] if rest.iter().all(|number| number == first) => {
                let (first, width) = (value(first), Literal::usize_unsuffixed(WIDTH));
                quote! { four([#first; #width]) }
            }
            numbers => {
                let numbers = numbers.iter().map(value);
                quote! { four([#(#numbers),*]) }
            }
        },
        Formula::Part(of, result) => {
            let (of, result) = (value(of), Literal::usize_unsuffixed(*result));
            quote! { #of[#result] }
        }
    }
}

/// A formula as a factor, or as what a method is called on.
fn factor(formula: &Formula) -> TokenStream {
    let plain = value(formula);
    match formula {
        Formula::Call(..) => plain,
        formula if !formula.computes() => plain,
        _ => quote! { (#plain) },
    }
}

/// Terms that are products are added by multiply–adds.
fn sum(terms: &[(bool, Formula)]) -> TokenStream {
    let mut terms = Formula::in_order(terms).into_iter();
    let Some((minus, first)) = terms.next() else {
        return quote! { n(0.0) };
    };
    let start = match minus {
        true => {
            let first = factor(first);
            quote! { -#first }
        }
        false => value(first),
    };
    terms.fold(start, |sum, (minus, term)| match (term, minus) {
        (Formula::Product(a, b), minus) => {
            let (a, b) = (factor(a), value(b));
            let a = if *minus {
                quote! { (-#a) }
            } else {
                a
            };
            quote! { #a.mul_add(#b, #sum) }
        }
        (term, true) => {
            let term = factor(term);
            quote! { #sum - #term }
        }
        (term, false) => {
            let term = factor(term);
            quote! { #sum + #term }
        }
    })
}

/// The constant of a curve.
pub fn curve_ident(curve: Curve) -> Ident {
    format_ident!("CURVE_{}", curve.distinct_name().to_ascii_uppercase())
}

fn call(function: Known, arguments: &[Formula]) -> TokenStream {
    let mut arguments = arguments.iter();
    let of = arguments.next().map(factor).unwrap_or_default();
    let rest: Vec<TokenStream> = arguments.map(value).collect();
    match function {
        Known::Sin => quote! { #of.sin_cos().0 },
        Known::Cos => quote! { #of.sin_cos().1 },
        Known::Exp => quote! { #of.exp() },
        Known::Sinh => quote! { #of.sinh() },
        Known::Cosh => quote! { #of.cosh() },
        Known::Sech => quote! { #of.sech() },
        Known::Tanh => quote! { #of.tanh() },
        Known::LnCosh => quote! { #of.ln_cosh() },
        Known::Ln => quote! { #of.ln() },
        Known::Ln1p => quote! { #of.ln_1p_scaled(#(#rest),*) },
        Known::Larger => quote! { #of.larger(#(#rest),*) },
        Known::Sqrt => quote! { #of.sqrt() },
        Known::Atan2 => quote! { #of.atan2(#(#rest),*) },
        Known::Stumpff(order) => {
            let order = Literal::u8_unsuffixed(order);
            quote! { #of.stumpff(#order) }
        }
        Known::DexpInverse(order) => {
            let order = Literal::u8_unsuffixed(order);
            quote! { #of.dexp_inverse(#order) }
        }
        Known::Curve(curve, order) => {
            let (name, order) = (curve_ident(curve), Literal::u8_unsuffixed(order));
            quote! { #name.derivative(#of, #order) }
        }
        // Folded when the graph was made.
        Known::Pi | Known::Recip | Known::Group => of,
    }
}

/// What is indexed by the number of a result; matrices are given and read row by row.
fn several(function: Primitive, arguments: &[Formula]) -> TokenStream {
    let arguments = arguments.iter().map(value);
    match function {
        Primitive::RotationVector => quote! {
            T::rotation_vector(&::hamel::nalgebra::Matrix3::new(#(#arguments),*))
        },
        Primitive::QuaternionVector => quote! { T::quaternion_vector([#(#arguments),*]) },
        Primitive::NearestRotation => quote! {
            ::hamel::spatial::nearest_rotation(&::hamel::nalgebra::Matrix3::new(#(#arguments),*)).transpose()
        },
    }
}
