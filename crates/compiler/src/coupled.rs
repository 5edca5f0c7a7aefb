//! Joints that mimic joints couple, as specs: what the runtime computes by products of its links' motions is derived here as of any other joint,
//! and simplified with the scene.

use super::products::JointType;
use hamel_runtime::joint::{Link, LinkMotion};
use hamel_runtime::spatial::Pose;
use hamel_scene::{Coupling, Located};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;
use std::rc::Rc;

/// How far an angle may be from a whole number of quarter turns to be one: some roundings of rotation matrices.
const QUARTER: f64 = 1e-15;

/// A spec with the values of its parameters.
pub(super) struct Spec {
    /// The text.
    text: String,
    /// Names and values, in the order of the text.
    pub(super) parameters: Vec<(Located<String>, f64)>,
}

/// The joint types of couplings, by their texts: those that differ in numbers alone are one.
#[derive(Default)]
pub(super) struct Types(BTreeMap<String, Rc<JointType>>);

impl Types {
    /// The type of a spec.
    ///
    /// # Errors
    /// Why the spec is not derived: too much work for as many links.
    pub(super) fn derive(&mut self, spec: &Spec) -> Result<Rc<JointType>, String> {
        if let Some(known) = self.0.get(&spec.text) {
            return Ok(Rc::clone(known));
        }
        let derived = hamel_codegen::derive_in(&spec.text, "coupled.joint", None);
        let derived = derived.map_err(|errors| errors.to_string())?;
        let joint = JointType::new(derived);
        let joint = Rc::new(joint.map_err(|error| error.task.to_string())?);
        self.0.insert(spec.text.clone(), Rc::clone(&joint));
        Ok(joint)
    }
}

/// The spec of a coupling.
pub(super) fn spec(coupling: &Coupling) -> Spec {
    let mut writer = Writer::default();
    let (mut motions, mut poses, mut ports) = (String::new(), String::new(), String::new());
    for (index, (link, port)) in coupling.links.iter().zip(coupling.ports).enumerate() {
        let number = index + 1;
        let value = writer.value(number, link, coupling);
        _ = writeln!(motions, "    let y_{number} = {value};");
        _ = writeln!(
            poses,
            "    H.link_{number} = {};",
            writer.pose(index, coupling)
        );
        let unit = port.unit;
        let value = match port.wraps {
            true => format!("[cos(y_{number}), sin(y_{number})]"),
            false => format!("y_{number}"),
        };
        _ = writeln!(
            ports,
            "    /// Of link {number}.\n    port port_{number}: {unit} = {value};"
        );
    }
    let coordinates =
        (0..coupling.coordinates()).map(|k| format!("{}: R1", coordinate(k, coupling)));
    let coordinates: Vec<String> = coordinates.collect();
    let bodies = (1..=coupling.links.len()).map(|number| format!("link_{number}"));
    let bodies: Vec<String> = bodies.collect();
    let text = format!(
        "hamel = 1;\n\n/// Links that follow one another.\njoint coupled({}) {{\n    config {};\n    bodies {};\n{motions}{poses}{ports}}}\n",
        writer.declared,
        coordinates.join(", "),
        bodies.join(", "),
    );
    Spec {
        text,
        parameters: writer.parameters,
    }
}

/// What a coordinate is called.
fn coordinate(k: usize, coupling: &Coupling) -> String {
    match coupling.coordinates() {
        1 => String::from("q"),
        _ => format!("q_{}", k + 1),
    }
}

/// Parameters, as the text meets them.
#[derive(Default)]
struct Writer {
    declared: String,
    parameters: Vec<(Located<String>, f64)>,
}

impl Writer {
    /// The name of a parameter of this value.
    fn parameter(&mut self, name: String, unit: &str, meaning: &str, value: f64) -> String {
        _ = write!(self.declared, "\n    /// {meaning}\n    {name}: {unit},");
        self.parameters
            .push((Located::new(name.clone(), 0..0), value));
        name
    }

    /// y of a link.
    fn value(&mut self, number: usize, link: &Link, coupling: &Coupling) -> String {
        let q = coordinate(link.coordinate, coupling);
        let turned = match link.ratio {
            1.0 => q,
            -1.0 => format!("-{q}"),
            ratio => {
                let name = format!("ratio_{number}");
                let name = self.parameter(
                    name,
                    "1",
                    "Its motion per motion of what it follows.",
                    ratio,
                );
                format!("{name} * {q}")
            }
        };
        if link.offset == 0.0 {
            return turned;
        }
        let unit = match link.motion {
            LinkMotion::Turn => "rad",
            LinkMotion::Slide => "m",
        };
        let offset = format!("offset_{number}");
        let offset = self.parameter(
            offset,
            unit,
            "Its place where what it follows is at 0.",
            link.offset,
        );
        format!("{turned} + {offset}")
    }

    /// H of a link's body.
    fn pose(&mut self, index: usize, coupling: &Coupling) -> String {
        let mut path = vec![];
        let mut at = Some(index);
        while let Some((place, link)) = at.and_then(|at| Some((at, coupling.links.get(at)?))) {
            path.push((place, link));
            at = link.before;
        }
        let mut factors = vec![];
        for (place, link) in path.into_iter().rev() {
            let number = place + 1;
            factors.extend(self.frame(number, &link.frame));
            factors.push(match link.motion {
                LinkMotion::Turn => format!("rot_z(y_{number})"),
                LinkMotion::Slide => format!("trans_z(y_{number})"),
            });
        }
        factors.join(" * ")
    }

    /// A fixed pose as factors: a translation, and turns about z, x and z.
    fn frame(&mut self, number: usize, frame: &Pose<f64>) -> Vec<String> {
        let mut factors = vec![];
        if frame.translation != Vector3::zeros() {
            let axes = ["x", "y", "z"].into_iter().zip(&frame.translation);
            let entries = axes.map(|(axis, &value)| match value {
                0.0 => String::from("0"),
                value => self.known(
                    format!("{axis}_{number}"),
                    "m",
                    "Where its joint is.",
                    value,
                ),
            });
            let entries: Vec<String> = entries.collect();
            factors.push(format!("trans([{}])", entries.join(", ")));
        }
        let [turn, tilt, spin] = turns(&frame.rotation);
        for (axis, name, angle) in [
            ("z", "turn", turn),
            ("x", "tilt", tilt),
            ("z", "spin", spin),
        ] {
            let quarters = (angle / FRAC_PI_2).round();
            let is_whole = (angle - quarters * FRAC_PI_2).abs() <= QUARTER;
            factors.extend(match quarters {
                0.0 if is_whole => None,
                quarters if is_whole => Some(format!("rot_{axis}({quarters} * pi / 2)")),
                _ => {
                    let name = self.known(
                        format!("{name}_{number}"),
                        "rad",
                        "How its joint's axis stands.",
                        angle,
                    );
                    Some(format!("rot_{axis}({name})"))
                }
            });
        }
        factors
    }

    /// A parameter that several bodies have, declared once.
    fn known(&mut self, name: String, unit: &str, meaning: &str, value: f64) -> String {
        let is_known = self.parameters.iter().any(|(own, _)| own.value == name);
        match is_known {
            true => name,
            false => self.parameter(name, unit, meaning, value),
        }
    }
}

/// The angles of `R = R_z(a) R_x(b) R_z(c)`.
fn turns(rotation: &Matrix3<f64>) -> [f64; 3] {
    let (x, y, z) = (rotation[(0, 2)], rotation[(1, 2)], rotation[(2, 2)]);
    let across = x.hypot(y);
    // Of an axis that stays, or turns round, the first angle is free.
    let turn = match across <= QUARTER {
        true => 0.0,
        false => x.atan2(-y),
    };
    let tilt = across.atan2(z);
    let about = |axis, angle: f64| Rotation3::from_axis_angle(&axis, -angle);
    let rest = about(Vector3::x_axis(), tilt) * about(Vector3::z_axis(), turn) * rotation;
    [turn, tilt, rest[(1, 0)].atan2(rest[(0, 0)])]
}

#[cfg(test)]
mod tests {
    use super::turns;
    use nalgebra::{Matrix3, Rotation3, Vector3};

    #[test]
    fn three_turns_make_the_rotation() {
        let some = [
            [0.3, -0.2, 0.9],
            [0.0; 3],
            [3.14, 1e-9, 0.0],
            [1e-17, 0.0, 2.0],
        ];
        let (x, z) = (Vector3::x_axis(), Vector3::z_axis());
        let half = Rotation3::from_axis_angle(&x, std::f64::consts::PI);
        let all = some.map(|vector| Rotation3::new(Vector3::from(vector)));
        for rotation in all.into_iter().chain([half]) {
            let rotation: Matrix3<f64> = rotation.into_inner();
            let [turn, tilt, spin] = turns(&rotation);
            let found = Rotation3::from_axis_angle(&z, turn)
                * Rotation3::from_axis_angle(&x, tilt)
                * Rotation3::from_axis_angle(&z, spin);
            let away = (found.into_inner() - rotation).amax();
            assert!(away < 4e-16 * 3.0, "{rotation}: {away:e}");
        }
    }
}
