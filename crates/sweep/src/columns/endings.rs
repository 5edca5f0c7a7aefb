//! Names, units and meanings of a joint's coordinates and speeds.

use super::coordinates::{Factor, Kind};
use hamel::joint::{Unit, Units};
use hamel::mechanism::Body;

/// A column before it has its place: name without owner and unit, unit, meaning.
#[derive(Clone, Debug)]
pub struct Ending {
    /// Without owner and unit.
    pub name: String,
    /// SI unit; `1` for a number without one, empty where the spec does not determine it.
    pub unit: &'static str,
    /// What it is.
    pub meaning: String,
}

/// Of all parts of Q. The name of a part is left out where there is no other, unless it is all that there is to say.
pub fn coordinate_endings(factors: &[Factor], units: &Units) -> Vec<Ending> {
    let endings = factors.iter().flat_map(|factor| {
        let stem = factor.stem.trim_end_matches('_');
        let quantities = factor.kind.quantities();
        let scalar = || {
            let unit = units.coordinate(factor.first);
            vec![ending("q", factor.stem.clone(), unit, meaning(unit))]
        };
        match quantities {
            [] => scalar(),
            [(_, unit)] if !stem.is_empty() => {
                vec![ending("q", stem.to_owned(), *unit, meaning(*unit))]
            }
            quantities => {
                let named = quantities.iter().map(|(name, unit)| {
                    let name = match factors {
                        [_] => (*name).to_owned(),
                        _ if stem.is_empty() => (*name).to_owned(),
                        _ => format!("{stem}_{name}"),
                    };
                    let meaning = match (factor.kind, unit) {
                        (Kind::S2, _) => "unit vector in Q",
                        (_, &Unit::NUMBER) => {
                            "attitude in Q as unit quaternion, scalar last and not negative"
                        }
                        (_, unit) => meaning(*unit),
                    };
                    ending("q", name, *unit, meaning)
                });
                named.collect()
            }
        }
    });
    endings.collect()
}

/// Of a coordinate.
fn meaning(unit: Unit) -> &'static str {
    match unit {
        Unit::ANGLE => "angle of the joint, not reduced to a turn",
        Unit::LENGTH => "displacement of the joint",
        _ => "stored scalar of Q",
    }
}

/// Of all speeds of the joint under `body`.
pub fn speed_endings(body: &Body, units: &Units) -> Vec<Ending> {
    let speeds = body.joint().speeds().iter().enumerate();
    let endings = speeds.map(|(place, name)| Ending {
        name: format!("v.{name}"),
        unit: units.speed(place).rate,
        meaning: String::from("speed of the joint"),
    });
    endings.collect()
}

fn ending(key: &str, name: String, unit: Unit, meaning: &str) -> Ending {
    Ending {
        name: format!("{key}.{name}"),
        unit: unit.name,
        meaning: meaning.to_owned(),
    }
}

/// A unit at the end of a name: `_m_per_s`, `_per_m2_s`.
pub fn suffix(unit: &str) -> String {
    match unit {
        "" | "1" => String::new(),
        unit => {
            let plain = unit.replace(['(', ')', '^'], "").replace(' ', "_");
            let written = plain.replace('/', "_per_");
            format!("_{}", written.strip_prefix("1_").unwrap_or(&written))
        }
    }
}
