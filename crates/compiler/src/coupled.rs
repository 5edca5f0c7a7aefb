//! Joints of links that move together, as mimic joints, sums of coordinates and loops make them: a spec says what belongs to their coordinates and ports, a [`Linkage`] is their kernels.
//!
//! In the spec every link hangs on the joint's parent, and all coordinates move by themselves. What a body inherits of the links that it hangs on are products of their motions, and what ties ask for are systems of
//! equations, which are written on the graph: expanded, as a spec is, they would have hundreds of terms.

use super::linkage::{Linkage, Whole};
use super::products::JointType;
use hamel_runtime::joint::{Link, LinkMotion, Tie};
use hamel_scene::{Coupling, Located};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::rc::Rc;

/// A spec with the values of its parameters.
pub(super) struct Spec {
    /// The text.
    text: String,
    /// Names and values, in the order of the text.
    pub(super) parameters: Vec<(Located<String>, f64)>,
}

/// What has been derived from specs, by their texts: couplings that differ in numbers alone have one.
#[derive(Default)]
pub(super) struct Types(BTreeMap<String, JointType>);

impl Types {
    /// The type of a coupling.
    ///
    /// # Errors
    /// Why it is not derived.
    pub(super) fn of(&mut self, coupling: &Coupling) -> Result<Rc<JointType>, String> {
        let spec = spec(coupling);
        let mut joint = match self.0.get(&spec.text) {
            Some(known) => known.clone(),
            None => {
                let derived =
                    hamel_codegen::derive(&spec.text, &format!("{}.joint", name(coupling)));
                let derived = derived.map_err(|errors| errors.to_string())?;
                let joint = JointType::new(derived).map_err(|error| error.task.to_string())?;
                self.0.insert(spec.text, joint.clone());
                joint
            }
        };
        let runtime = coupling.joint().map_err(|fault| fault.to_string())?;
        let mut home = vec![0.0; coupling.coordinates()];
        runtime.home(&mut home);
        let whole = Rc::new(Whole::new(coupling, home));
        joint.hang(Linkage::new(coupling, 0, &whole));
        let more = joint.more.iter_mut().enumerate();
        more.for_each(|(index, own)| {
            Rc::make_mut(own).hang(Linkage::new(coupling, index + 1, &whole));
        });
        Ok(Rc::new(joint))
    }
}

/// The spec of a coupling whose links all hang on the parent.
pub(super) fn spec(coupling: &Coupling) -> Spec {
    let mut writer = Writer::default();
    let (mut motions, mut poses, mut ports) = (String::new(), String::new(), String::new());
    for (index, (link, port)) in coupling.links.iter().zip(coupling.ports).enumerate() {
        let number = index + 1;
        let value = writer.value(number, link, coupling);
        _ = writeln!(motions, "    let place_{number} = {value};");
        let motion = match link.motion {
            LinkMotion::Turn => "rot_z",
            LinkMotion::Slide => "trans_z",
        };
        _ = writeln!(poses, "    H.link_{number} = {motion}(place_{number});");
        let unit = port.unit;
        let value = match port.wraps {
            true => format!("[cos(place_{number}), sin(place_{number})]"),
            false => format!("place_{number}"),
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
    let name = name(coupling);
    let text = format!(
        "hamel = 1;\n\n/// Links that follow one another.\njoint {name}({}) {{\n    config {};\n    bodies {};\n{motions}{poses}{ports}}}\n",
        writer.declared,
        coordinates.join(", "),
        bodies.join(", "),
    );
    Spec {
        text,
        parameters: writer.parameters,
    }
}

/// What the joint's type is called, as by the runtime.
fn name(coupling: &Coupling) -> &'static str {
    match coupling.ties.is_empty() {
        true => "coupled",
        false => "linkage",
    }
}

/// What a coordinate is called: as the runtime does it, y where it follows by ties.
fn coordinate(k: usize, coupling: &Coupling) -> String {
    let following: usize = coupling.ties.iter().map(Tie::count).sum();
    match coupling.coordinates().saturating_sub(following) {
        independent if k >= independent => format!("y_{}", k - independent + 1),
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
        let located = Located::new(name.clone(), 0..0);
        self.parameters.push((located, value));
        name
    }

    /// y of a link.
    fn value(&mut self, number: usize, link: &Link, coupling: &Coupling) -> String {
        let q = coordinate(link.coordinate, coupling);
        let mut same = coupling.links.iter();
        let first = same.find(|other| other.coordinate == link.coordinate);
        let leader = first.map_or(link.motion, |first| first.motion);
        let turned = match link.ratio {
            1.0 if leader == link.motion => q,
            -1.0 if leader == link.motion => format!("-{q}"),
            ratio => {
                let name = format!("ratio_{number}");
                let meaning = "Its motion per motion of what it follows.";
                let unit = match (leader, link.motion) {
                    (LinkMotion::Turn, LinkMotion::Slide) => "m/rad",
                    (LinkMotion::Slide, LinkMotion::Turn) => "rad/m",
                    _ => "1",
                };
                let name = self.parameter(name, unit, meaning, ratio);
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
        let meaning = "Its place where what it follows is at 0.";
        let offset = format!("offset_{number}");
        let offset = self.parameter(offset, unit, meaning, link.offset);
        format!("{turned} + {offset}")
    }
}
