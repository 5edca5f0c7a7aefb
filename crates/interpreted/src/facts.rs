//! What a joint tells of itself, in texts and lists that live as long as the program, as those of joints that are compiled into it.

use hamel_codegen::derived::{Derived, KernelKind, Structure};
use hamel_codegen::emit::report::{summary, units as units_of};
use hamel_codegen::expand::{PinDrive, Source};
use hamel_codegen::matrix::Matrix;
use hamel_codegen::model::{End, Pin, VelocityFrame};
use hamel_codegen::units::Dimension;
use hamel_runtime::joint::{self, Facts, Port, Structures, Unit, Units};
use hamel_runtime::registry::{Limit, ParameterInfo};
use num_traits::ToPrimitive;
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// What differs from body to body.
#[derive(Clone, Debug)]
pub struct BodyFacts {
    /// Which kernels are trivial.
    pub structures: Structures,
    /// Basis of the inertias that do not affect the joint.
    pub unidentifiable: &'static [[f64; 10]],
    /// Whether each degree of freedom moves the body.
    pub moves: Vec<bool>,
}

impl BodyFacts {
    pub(crate) fn new(derived: &Derived) -> Self {
        let map = derived.kernel(KernelKind::TwistMapChild);
        let map = map.and_then(|kernel| kernel.outputs.first());
        let moves = |k: usize| map.is_none_or(|map| (0..6).any(|i| !map.at(i, k).is_zero()));
        let inertias = derived.unidentifiable.iter();
        let inertias =
            inertias.map(|weights| weights.each_ref().map(|weight| double(weight.to_f64())));
        Self {
            structures: structures(derived),
            unidentifiable: leaked(inertias.collect()),
            moves: (0..derived.shape.freedoms).map(moves).collect(),
        }
    }
}

/// The constants of the joint. Names of stored scalars, and those of relations, are followed by empty ones as if it stored `room` of them.
pub(crate) fn of(derived: &Derived, room: usize) -> Facts {
    let spec = &derived.spec;
    let idle = room - derived.shape.configuration;
    let padded = |texts: Vec<String>| {
        let empty = std::iter::repeat_n(String::new(), idle);
        let all: Vec<String> = texts.into_iter().chain(empty).collect();
        names(all.iter().map(String::as_str))
    };
    let configuration = derived.arguments.configuration.iter();
    let freedoms = spec.freedoms.value.iter();
    let loci = derived.space.loci.iter();
    let (mut relations, mut relation_units): (&[&str], &[&str]) = (&[], &[]);
    if spec.implicit.is_some() {
        let declared = spec.manifold.value.declared().iter();
        relations = padded(declared.map(|relation| format!("{relation} = 0")).collect());
        let units = spec.units.relations.iter();
        let units = units.map(|unit| unit.as_ref().map_or_else(String::new, Dimension::in_units));
        relation_units = padded(units.collect());
    }
    Facts {
        name: kept(&spec.name.value),
        coordinates: padded(
            configuration
                .map(|symbol| symbol.name().to_owned())
                .collect(),
        ),
        freedoms: names(freedoms.map(|freedom| freedom.name.as_str())),
        speeds: names(derived.speed_names.iter().map(String::as_str)),
        velocity_frame: match spec.velocity.value {
            VelocityFrame::Child => joint::VelocityFrame::Child,
            VelocityFrame::Parent => joint::VelocityFrame::Parent,
            VelocityFrame::Rates => joint::VelocityFrame::Declared,
        },
        structures: structures(derived),
        unidentifiable: &[],
        singularities: names(loci.map(|locus| locus.value.text.as_str())),
        relations,
        relation_units,
        pins: leaked(
            spec.pins
                .iter()
                .zip(&derived.pin_drives)
                .map(|(own, drives)| pin(&own.value, drives))
                .collect(),
        ),
    }
}

/// Which kernels are trivial.
fn structures(derived: &Derived) -> Structures {
    let of = |kind| {
        let kernel = derived.kernel(kind);
        structure(kernel.map_or(Structure::General, |kernel| kernel.structure))
    };
    Structures {
        twist_map: of(KernelKind::TwistMap),
        twist_map_child: of(KernelKind::TwistMapChild),
        twist_map_child_gradient: of(KernelKind::TwistMapChildGradient),
        velocity_map: of(KernelKind::VelocityMap),
        velocity_map_gradient: of(KernelKind::VelocityMapGradient),
        gamma: of(KernelKind::Gamma),
        speed_basis: of(KernelKind::SpeedBasis),
        speed_basis_gradient: of(KernelKind::SpeedBasisGradient),
        retract_differential: of(KernelKind::RetractDifferentialInverse),
        project: of(KernelKind::Project),
        residual: of(KernelKind::Residual),
        bias_acceleration: of(KernelKind::BiasAcceleration),
        bias_momentum: of(KernelKind::BiasMomentum),
        speed_map: structure(Structure::of(std::slice::from_ref::<Matrix>(
            &derived.speed_map,
        ))),
    }
}

const fn structure(structure: Structure) -> joint::Structure {
    match structure {
        Structure::Zero => joint::Structure::Zero,
        Structure::Identity => joint::Structure::Identity,
        Structure::Constant => joint::Structure::Constant,
        Structure::General => joint::Structure::General,
    }
}

/// What everything is measured in.
pub(crate) fn units(derived: &Derived) -> Units {
    let all = |units: &[Option<Dimension>]| {
        let units = units
            .iter()
            .map(|unit| unit.as_ref().map_or(Unit::UNKNOWN, self::unit));
        leaked(units.collect())
    };
    let units = &derived.spec.units;
    Units::new(
        all(&units.coordinates),
        all(&units.freedoms),
        all(&units.velocities),
        all(&units_of::of_speeds(derived)),
    )
}

fn unit(unit: &Dimension) -> Unit {
    match unit.in_units().as_str() {
        "rad" => Unit::ANGLE,
        "m" => Unit::LENGTH,
        "1" => Unit::NUMBER,
        name => Unit::new(kept(name), kept(&unit.rate()), kept(&unit.effort())),
    }
}

/// The ports.
pub(crate) fn ports(derived: &Derived) -> &'static [Port] {
    let ports = derived.spec.ports.iter().map(|port| Port {
        name: kept(&port.value.name),
        unit: kept(&port.value.unit),
        wraps: port.value.wraps(),
    });
    leaked(ports.collect())
}

fn pin(pin: &Pin, drives: &[PinDrive]) -> joint::Pin {
    let drive = |drive: &PinDrive| joint::PinDrive {
        source: match drive.source {
            Source::Freedom(place) => joint::DriveSource::Freedom(place),
            Source::Port(place) => joint::DriveSource::Port(place),
        },
        turns: drive.turns,
        reversed: drive.reversed,
    };
    joint::Pin {
        name: kept(&pin.name),
        bodies: pin.ends.each_ref().map(|end| end.body),
        turning: match (pin.about, pin.along) {
            (Some(_), _) => joint::Turning::AboutAxis,
            (None, Some(_)) => joint::Turning::Not,
            (None, None) => joint::Turning::Freely,
        },
        slides: pin.along.is_some(),
        drives: leaked(drives.iter().map(drive).collect()),
    }
}

/// What is said of the parameters, in order.
pub(crate) fn parameters(derived: &Derived) -> &'static [ParameterInfo] {
    let limit = |end: &End| Limit {
        value: double(end.value.to_f64()),
        included: end.included,
    };
    let info = |parameter: &hamel_codegen::model::Parameter| ParameterInfo {
        lower: parameter.range.lower.as_ref().map(limit),
        upper: parameter.range.upper.as_ref().map(limit),
        ..ParameterInfo::new(
            kept(parameter.symbol.name()),
            kept(&parameter.unit),
            kept(parameter.docs.trim()),
        )
    };
    leaked(derived.spec.parameters.iter().map(info).collect())
}

/// What the joint does, in a line.
pub(crate) fn line(derived: &Derived) -> &'static str {
    kept(&summary(&derived.spec.docs, &derived.spec.name.value))
}

fn double(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::MAX)
}

/// The texts, kept.
pub(crate) fn names<'a>(texts: impl Iterator<Item = &'a str>) -> &'static [&'static str] {
    leaked(texts.map(kept).collect())
}

/// The list, for as long as the program lives.
fn leaked<E>(list: Vec<E>) -> &'static [E] {
    list.leak()
}

/// The text for as long as the program lives, once however often it is asked for.
pub(crate) fn kept(text: &str) -> &'static str {
    static ALL: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = all.get(text) {
        return known;
    }
    let text: &'static str = String::from(text).leak();
    all.insert(text);
    text
}
