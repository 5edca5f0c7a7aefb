//! Columns of the forces within joints: the multipliers of their relations, and what bodies exert on each other at pins.

use super::{Columns, Ending, Moment};
use hamel::dynamics::PinForce;
use hamel::joint::{Pin, Turning};
use hamel::mechanism::Body;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;

/// What is said of the forces, each once.
pub(super) type Notes = Rc<RefCell<BTreeSet<String>>>;

/// Names of the components of a force or a moment.
const AXES: [char; 3] = ['x', 'y', 'z'];

impl<'a> Columns<'a> {
    /// Of one joint: nothing where it has neither relations nor pins.
    pub(super) fn forces(&mut self, index: usize, body: &'a Body) {
        if !body.joint().relations().is_empty() {
            self.relation_forces(index, body);
        }
        if !body.joint().pins().is_empty() {
            self.pin_forces(index, body);
        }
    }

    /// λ of each relation of a joint; NaN where the relations do not determine how Q moves.
    fn relation_forces(&mut self, index: usize, body: &'a Body) {
        let joint = body.joint();
        let relations = joint.relations();
        let units = joint.relation_units().iter().copied();
        let units = units.chain(std::iter::repeat(""));
        let endings = relations.iter().zip(units).zip(1..);
        let endings = endings.map(|((relation, unit), number)| Ending {
            name: format!("lambda.{number}"),
            unit: multiplier_unit(unit),
            meaning: format!("multiplier of the relation `{relation}`"),
        });
        let notes = Rc::clone(&self.notes);
        self.add("lambda", endings.collect(), move |moment, row| {
            let (q, speeds) = (moment.configuration, moment.speeds);
            let found = moment
                .carried
                .map(|carried| carried.relation_forces(index, q, speeds));
            match found {
                Some(Ok(forces)) => row.extend(forces),
                other => {
                    notes
                        .borrow_mut()
                        .extend(other.and_then(Result::err).map(|e| e.to_string()));
                    row.extend(vec![f64::NAN; relations.len()]);
                }
            }
        });
    }

    /// Force and moment at each pin of a joint; NaN where they are not determined.
    fn pin_forces(&mut self, index: usize, body: &'a Body) {
        let pins = body.joint().pins();
        let endings = pins.iter().flat_map(|pin| pin_endings(body, pin));
        let notes = Rc::clone(&self.notes);
        self.add("pin", endings.collect(), move |moment, row| {
            let (told, note) = told_at_pins(index, body, moment);
            notes.borrow_mut().extend(note);
            for (pin, own) in pins.iter().zip(told) {
                row.extend(&own.force);
                if carries_moments(pin) {
                    row.extend(&own.moment);
                }
            }
        });
    }
}

const fn carries_moments(pin: &Pin) -> bool {
    !matches!(pin.turning, Turning::Freely)
}

fn pin_endings(body: &Body, pin: &Pin) -> Vec<Ending> {
    let bodies = body.joint().bodies();
    let [first, second] = pin.bodies.map(|place| {
        let place = place.and_then(|place| bodies.get(place));
        place.copied().unwrap_or("the parent")
    });
    let ending = |letter: char, what: &str, unit| {
        AXES.map(|axis| Ending {
            name: format!("pin.{}.{letter}{axis}", pin.name),
            unit,
            meaning: format!(
                "{what} of {second} on {first} at the pin, axes of the frame that the joint hangs on"
            ),
        })
    };
    let forces = ending('f', "force", "N").into_iter();
    let moments = ending('m', "moment", "N m").into_iter();
    forces
        .chain(moments.filter(|_| carries_moments(pin)))
        .collect()
}

/// The forces at all pins of a joint, and what there is to say of them.
fn told_at_pins(index: usize, body: &Body, moment: &Moment<'_>) -> (Vec<PinForce>, Option<String>) {
    let (q, speeds) = (moment.configuration, moment.speeds);
    let pins = body.joint().pins();
    match moment
        .carried
        .map(|carried| carried.pin_forces(index, q, speeds))
    {
        Some(Ok(told)) => {
            let note = undetermined(body, pins, &told);
            (told, note)
        }
        other => {
            let nothing = PinForce {
                force: nalgebra::Vector3::repeat(f64::NAN),
                moment: nalgebra::Vector3::repeat(f64::NAN),
            };
            let cause = other.and_then(Result::err).map(|cause| cause.to_string());
            (vec![nothing; pins.len()], cause)
        }
    }
}

/// The components that the equations of motion do not determine, by name.
fn undetermined(body: &Body, pins: &[Pin], told: &[PinForce]) -> Option<String> {
    let of_pin = |(pin, own): (&Pin, &PinForce)| {
        let parts = [('f', own.force), ('m', own.moment)];
        let parts = parts.into_iter().flat_map(|(letter, part)| {
            let entries = AXES
                .into_iter()
                .zip(part.iter().copied().collect::<Vec<_>>());
            let open = entries.filter(|(_, entry)| entry.is_nan());
            open.map(move |(axis, _)| format!("{letter}{axis}"))
        });
        let parts: Vec<String> = parts.collect();
        (!parts.is_empty()).then(|| format!("{} of `{}`", parts.join(", "), pin.name))
    };
    let parts: Vec<String> = pins.iter().zip(told).filter_map(of_pin).collect();
    (!parts.is_empty()).then(|| {
        format!(
            "the equations of motion do not determine all that the pins of joint `{}` carry: {}",
            body.joint_name(),
            parts.join("; ")
        )
    })
}

/// J over the unit of a relation; empty where that is not known.
fn multiplier_unit(relation: &str) -> &'static str {
    match relation {
        "m" => "N",
        "1" => "N m",
        "m^2" => "N/m",
        _ => "",
    }
}
