//! The type of a joint and its implementation of the trait.

use super::bodies;
use super::docs;
use super::functions;
use super::limits;
use super::numeric;
use super::patterns;
use super::pins;
use super::tokens::{ident, signed_literal};
use super::type_ident;
use crate::derived::{Derived, Kernel, KernelKind, Structure};
use crate::emit::method::{Method, absent, shared};
use crate::emit::report::summary;
use crate::emit::report::units;
use crate::expr::Rational;
use crate::model::VelocityFrame;
use crate::text::inline;
use crate::units::Dimension;
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// The type, its constructor and its `impl Joint`.
pub fn tokens(derived: &Derived) -> TokenStream {
    let definition = definition(derived);
    let name = type_ident(derived);
    let [n, k, s, c] = sizes(derived);
    let constants = constants(derived);
    let bodies = bodies::names(derived);
    let ports = ports(derived);
    let units = units(derived);
    let relations = relations(derived);
    let pins = pins::constant(derived);
    let functions = shared::functions(derived);
    let carried = bodies::carried(derived, &functions);
    let parameters = parameters(derived);
    let names = derived.names();
    let method = |kernel: &Kernel| {
        let method = Method::with_functions(derived, kernel, &names, &functions);
        method.tokens(&docs::kernel(derived, kernel, &method))
    };
    let (own, methods): (Vec<&Kernel>, Vec<&Kernel>) = derived
        .kernels
        .iter()
        .filter(|kernel| absent(derived, kernel).is_none())
        .partition(|kernel| numeric::is_beside_the_trait(kernel.kind));
    let (own, methods) = (own.into_iter().map(method), methods.into_iter().map(method));
    let shared = functions::tokens(derived, &functions, &names);
    let own: Vec<TokenStream> = shared.into_iter().chain(own).collect();
    let own = (!own.is_empty()).then(|| quote! { impl #name { #(#own)* } });
    quote! {
        #definition
        #own
        impl Joint<#n, #k, #s, #c> for #name {
            #constants
            #units
            #bodies
            #ports
            #relations
            #pins
            #parameters
            #(#methods)*
        }
        #carried
    }
}

/// N, K, S and C as literals.
pub fn sizes(derived: &Derived) -> [Literal; 4] {
    let shape = derived.shape;
    [
        shape.configuration,
        shape.freedoms,
        shape.speeds,
        shape.constraints,
    ]
    .map(Literal::usize_unsuffixed)
}

fn definition(derived: &Derived) -> TokenStream {
    let name = type_ident(derived);
    let spec = &derived.spec;
    let docs = docs::outer(&[inline(&summary(&spec.docs, &spec.name.value))]);
    let derives = quote! { #[derive(Clone, Copy, Debug, PartialEq)] };
    if spec.parameters.is_empty() {
        return quote! { #docs #derives pub struct #name; };
    }
    let fields: Vec<_> = spec
        .parameters
        .iter()
        .map(|parameter| ident(parameter.symbol.name()))
        .collect();
    let field_docs = spec.parameters.iter().map(|parameter| {
        let text = match parameter.docs.trim() {
            "" => format!(
                "Parameter `{}`, in {}.",
                parameter.symbol.name(),
                parameter.unit
            ),
            text => format!("{} In {}.", inline(text), parameter.unit),
        };
        let range = limits::in_words(&parameter.range);
        docs::outer(&[format!("{text} It is {range}.")])
    });
    let constructor = constructor_docs(derived);
    quote! {
        #docs #derives
        pub struct #name { #(#field_docs pub #fields: f64),* }
        impl #name {
            #constructor
            pub const fn new(#(#fields: f64),*) -> Self {
                Self { #(#fields),* }
            }
        }
    }
}

/// What the constructor, which checks nothing, leaves to its caller.
fn constructor_docs(derived: &Derived) -> TokenStream {
    let mut lines = vec!["The joint with the given parameters, in SI units.".to_owned()];
    let requirements = &derived.spec.requirements;
    if !requirements.is_empty() {
        let texts = requirements
            .iter()
            .map(|requirement| format!("`{}`", requirement.value.text));
        let texts: Vec<String> = texts.collect();
        lines.push(String::new());
        lines.push(format!("They must meet {}.", texts.join(", ")));
    }
    docs::outer(&lines)
}

/// The constants `RELATIONS` and `RELATION_UNITS`; the trait's defaults where relations alone do not give Φ.
fn relations(derived: &Derived) -> Option<TokenStream> {
    derived.spec.implicit.as_ref()?;
    let relations = derived.spec.manifold.value.declared().iter();
    let texts = relations.map(|relation| format!("{relation} = 0"));
    let units = derived.spec.units.relations.iter();
    let units = units.map(|unit| unit.as_ref().map_or_else(String::new, Dimension::in_units));
    Some(quote! {
        const RELATIONS: &'static [&'static str] = &[#(#texts),*];
        const RELATION_UNITS: &'static [&'static str] = &[#(#units),*];
    })
}

/// The constant `UNITS`.
fn units(derived: &Derived) -> TokenStream {
    let listed = |units: Vec<Option<Dimension>>| {
        let units = units.iter().map(|unit| self::unit(unit.as_ref()));
        let units: Vec<TokenStream> = units.collect();
        quote! { &[#(#units),*] }
    };
    let units = &derived.spec.units;
    let coordinates = listed(units.coordinates.clone());
    let freedoms = listed(units.freedoms.clone());
    let velocities = listed(units.velocities.clone());
    let speeds = listed(units::of_speeds(derived));
    let all = [&freedoms, &velocities, &speeds].map(ToString::to_string);
    let units = match all.iter().all(|units| *units == coordinates.to_string()) {
        true => quote! { Units::of_rates(#coordinates) },
        false => quote! { Units::new(#coordinates, #freedoms, #velocities, #speeds) },
    };
    quote! {
        const UNITS: ::hamel::joint::Units = {
            use ::hamel::joint::{Unit, Units};
            #units
        };
    }
}

fn unit(unit: Option<&Dimension>) -> TokenStream {
    let texts = unit.map(|unit| (unit.in_units(), unit.rate(), unit.effort()));
    match texts.as_ref().map(|(name, ..)| name.as_str()) {
        None => quote! { Unit::UNKNOWN },
        Some("rad") => quote! { Unit::ANGLE },
        Some("m") => quote! { Unit::LENGTH },
        Some("1") => quote! { Unit::NUMBER },
        Some(_) => {
            let (name, rate, effort) = texts.unwrap_or_default();
            quote! { Unit::new(#name, #rate, #effort) }
        }
    }
}

/// The constant `PORTS`; the trait's default where there are none. The runtime's type is written with its path: a joint may have its name.
fn ports(derived: &Derived) -> Option<TokenStream> {
    let ports = derived.spec.ports.iter().map(|port| {
        let (name, unit, wraps) = (&port.value.name, &port.value.unit, port.value.wraps());
        quote! { ::hamel::joint::Port { name: #name, unit: #unit, wraps: #wraps } }
    });
    let ports: Vec<TokenStream> = ports.collect();
    (!ports.is_empty())
        .then(|| quote! { const PORTS: &'static [::hamel::joint::Port] = &[#(#ports),*]; })
}

/// Names and values of the parameters; the trait's default where there are none.
fn parameters(derived: &Derived) -> TokenStream {
    if derived.spec.parameters.is_empty() {
        return TokenStream::new();
    }
    let names = derived
        .spec
        .parameters
        .iter()
        .map(|parameter| parameter.symbol.name().to_string());
    let fields = derived
        .spec
        .parameters
        .iter()
        .map(|parameter| ident(parameter.symbol.name()));
    quote! {
        fn parameters(&self) -> impl Iterator<Item = (&'static str, f64)> {
            [#((#names, self.#fields)),*].into_iter()
        }
    }
}

fn constants(derived: &Derived) -> TokenStream {
    let shape = derived.shape;
    let names = |names: Vec<String>| quote! { [#(#names),*] };
    let array = |constant: &str, size: usize, values: Vec<String>| {
        let (constant, size, values) = (
            ident(constant),
            Literal::usize_unsuffixed(size),
            names(values),
        );
        quote! { const #constant: [&'static str; #size] = #values; }
    };
    let spec = &derived.spec;
    let name = &spec.name.value;
    let coordinates = derived
        .arguments
        .configuration
        .iter()
        .map(|symbol| symbol.name().to_string())
        .collect();
    let freedoms = spec
        .freedoms
        .value
        .iter()
        .map(|freedom| freedom.name.clone())
        .collect();
    let coordinates = array("COORDINATES", shape.configuration, coordinates);
    let freedoms = array("FREEDOMS", shape.freedoms, freedoms);
    let speeds = array("SPEEDS", shape.speeds, derived.speed_names.clone());
    let frame = ident(match spec.velocity.value {
        VelocityFrame::Child => "Child",
        VelocityFrame::Parent => "Parent",
        VelocityFrame::Rates => "Declared",
    });
    let structures = structures(derived);
    let patterns = patterns::tokens(derived);
    let inertias = inertias(derived);
    let loci = derived.space.loci.iter().map(|locus| &locus.value.text);
    quote! {
        const NAME: &'static str = #name;
        #coordinates
        #freedoms
        #speeds
        const VELOCITY_FRAME: VelocityFrame = VelocityFrame::#frame;
        const STRUCTURES: Structures = #structures;
        #patterns
        #inertias
        const SINGULARITIES: &'static [&'static str] = &[#(#loci),*];
    }
}

/// The constant `UNIDENTIFIABLE`.
pub fn inertias(derived: &Derived) -> TokenStream {
    let inertias = derived.unidentifiable.iter().map(inertia);
    quote! { const UNIDENTIFIABLE: &'static [[f64; 10]] = &[#(#inertias),*]; }
}

fn inertia(weights: &[Rational; 10]) -> TokenStream {
    let weights = weights.iter().map(signed_literal);
    quote! { [#(#weights),*] }
}

/// The structure of each kernel that differs from the nearer one of `Structures::TRIVIAL` and `Structures::GENERAL`.
pub fn structures(derived: &Derived) -> TokenStream {
    let of_kernel = |kind| {
        let kernel = derived.kernel(kind);
        kernel.map_or(Structure::General, |kernel| kernel.structure)
    };
    let speed_map = Structure::of(std::slice::from_ref(&derived.speed_map));
    let of_kernels = TRIVIAL.map(|(field, kind, trivial)| (field, of_kernel(kind), trivial));
    let all = of_kernels
        .into_iter()
        .chain([("speed_map", speed_map, Structure::Constant)]);
    let (mut beyond, mut below) = (vec![], vec![]);
    for (field, structure, trivial) in all {
        let tokens = field_tokens(field, structure);
        if structure != trivial {
            beyond.push(tokens.clone());
        }
        if structure != Structure::General {
            below.push(tokens);
        }
    }
    match (beyond.len(), below.len()) {
        (0, _) => quote! { Structures::TRIVIAL },
        (beyond_count, below_count) if beyond_count <= below_count => {
            quote! { Structures { #(#beyond,)* ..Structures::TRIVIAL } }
        }
        (_, 0) => quote! { Structures::GENERAL },
        _ => quote! { Structures { #(#below,)* ..Structures::GENERAL } },
    }
}

/// The fields of the runtime's `Structures`, with the kernels that they tell of and their values in `Structures::TRIVIAL`.
const TRIVIAL: [(&str, KernelKind, Structure); 13] = [
    ("twist_map", KernelKind::TwistMap, Structure::Constant),
    (
        "twist_map_child",
        KernelKind::TwistMapChild,
        Structure::Constant,
    ),
    (
        "twist_map_child_gradient",
        KernelKind::TwistMapChildGradient,
        Structure::Zero,
    ),
    ("velocity_map", KernelKind::VelocityMap, Structure::Identity),
    (
        "velocity_map_gradient",
        KernelKind::VelocityMapGradient,
        Structure::Zero,
    ),
    ("gamma", KernelKind::Gamma, Structure::Zero),
    ("speed_basis", KernelKind::SpeedBasis, Structure::Identity),
    (
        "speed_basis_gradient",
        KernelKind::SpeedBasisGradient,
        Structure::Zero,
    ),
    (
        "retract_differential",
        KernelKind::RetractDifferentialInverse,
        Structure::Identity,
    ),
    ("project", KernelKind::Project, Structure::Identity),
    ("residual", KernelKind::Residual, Structure::Zero),
    (
        "bias_acceleration",
        KernelKind::BiasAcceleration,
        Structure::Zero,
    ),
    ("bias_momentum", KernelKind::BiasMomentum, Structure::Zero),
];

fn field_tokens(field: &str, structure: Structure) -> TokenStream {
    let (field, structure) = (ident(field), ident(&format!("{structure:?}")));
    quote! { #field: Structure::#structure }
}
