//! The claims about pins: that both points are one, and that bodies move there as is said.

use super::{Attempt, Prover, refuted};
use crate::diagnostic::Diagnostic;
use crate::expand::pins::{difference, direction, in_parent, point, slip};
use crate::expr::Expr;
use crate::matrix::Matrix;
use crate::model::{Axis, Declared, Pin};
use crate::spec::code;

/// Entries of a residual for one pin and one degree of freedom: of turning and of sliding.
const ENTRIES: usize = 6;

impl Prover<'_> {
    /// Both points of each pin are one.
    pub(super) fn pins_meet(&self) -> Attempt {
        let spec = &self.joint.spec;
        if spec.pins.is_empty() {
            return Ok(None);
        }
        let apart = spec.pins.iter().flat_map(|pin| {
            let [first, second] = pin.value.ends.each_ref().map(|end| point(spec, end));
            difference(&first, &second)
        });
        let apart = apart.map(|entry| entry.without_arcsines());
        let residual = Matrix::column_vector(apart.collect());
        let statement = self.where_it_holds("both points of each pin are one");
        self.identity("pins_meet", &statement, &residual, |residual| {
            let (pin, entries) = first_of(&spec.pins, residual.entries(), 3);
            let name = &pin.value.name;
            let message = format!("the points of pin `{name}` are apart");
            let entries: Vec<String> = entries.iter().map(Expr::to_string).collect();
            refuted(code::PIN, &pin.span, &message, "not one point").note(format!(
                "the first less the second is [{}], in the frame that the joint hangs on",
                entries.join(", ")
            ))
        })
    }

    /// The bodies of each pin turn and slide as it says, and in no other way.
    pub(super) fn pins_hold(&self) -> Attempt {
        let (spec, freedoms) = (&self.joint.spec, self.x.shape.freedoms);
        if spec.pins.is_empty() {
            return Ok(None);
        }
        let of_pin = |pin: &Declared<Pin>| {
            let pin = pin.value.clone();
            (0..freedoms).flat_map(move |k| self.other_motion(&pin, k))
        };
        let residual = spec.pins.iter().flat_map(of_pin);
        let residual = residual.map(|entry| entry.without_arcsines());
        let residual = Matrix::column_vector(residual.collect());
        let statement = self.where_it_holds("bodies turn and slide at each pin as it says");
        self.identity("pins_hold", &statement, &residual, |residual| {
            let (pin, entries) = first_of(&spec.pins, residual.entries(), ENTRIES * freedoms);
            let turning = |n: usize| n % ENTRIES < 3;
            let open = entries.iter().position(|entry| !entry.is_zero());
            moves_otherwise(pin, open.is_some_and(turning))
        })
    }

    /// What of the motion of the first body relative to the second, along ϕ_k, is none of those that the pin allows: 0.
    fn other_motion(&self, pin: &Pin, k: usize) -> Vec<Expr> {
        let spec = &self.joint.spec;
        let across = |axis: Axis, vector: Vec<Expr>| {
            let axis = in_parent(spec, &pin.ends[1], &direction(axis));
            Matrix::tilde(&axis)
                .times(&Matrix::column_vector(vector))
                .column(0)
        };
        let turning = match (pin.about, pin.along) {
            (None, None) => vec![Expr::zero(); 3],
            (Some(axis), _) => across(axis, self.turning(pin, k)),
            (None, Some(_)) => self.turning(pin, k),
        };
        let slip = slip(spec, pin, &self.x.motion, k);
        let sliding = match pin.along {
            Some(axis) => across(axis, slip),
            None => slip,
        };
        [turning, sliding].concat()
    }

    /// The angular velocity of the first body relative to the second, along ϕ_k, in the frame that the joint hangs on.
    fn turning(&self, pin: &Pin, k: usize) -> Vec<Expr> {
        let [first, second] = pin.ends.each_ref().map(|end| match end.body {
            Some(body) => {
                let rows = 6 * body..6 * body + 3;
                let own = rows.map(|row| self.x.jacobian.base.at(row, k).clone());
                own.collect()
            }
            None => vec![Expr::zero(); 3],
        });
        difference(&first, &second)
    }
}

fn moves_otherwise(pin: &Declared<Pin>, turns: bool) -> Diagnostic {
    let letter = |axis| match axis {
        Axis::X => 'x',
        Axis::Y => 'y',
        Axis::Z => 'z',
    };
    let Pin {
        name, about, along, ..
    } = &pin.value;
    let (message, help) = match (turns, about, along) {
        (true, Some(axis), _) => (
            format!(
                "the bodies of pin `{name}` do not turn about {} alone",
                letter(*axis)
            ),
            "name the axis of the second body about which the first turns; without `about` and `along` they turn freely",
        ),
        (true, ..) => (
            format!("the bodies of pin `{name}` turn"),
            "say about which axis of the second body, as `about z`",
        ),
        (false, _, Some(axis)) => (
            format!(
                "the point of pin `{name}` does not slide along {} alone",
                letter(*axis)
            ),
            "name the axis of the second body along which the first slides",
        ),
        (false, ..) => (
            format!("the point of pin `{name}` moves in its bodies"),
            "give a point that is fixed in both bodies; or say along which axis of the second body the first slides, as `along x`",
        ),
    };
    refuted(code::PIN, &pin.span, &message, "moves otherwise").help(help)
}

/// The first pin of whose entries one is not 0, with its entries.
fn first_of<'p>(
    pins: &'p [Declared<Pin>],
    entries: &'p [Expr],
    each: usize,
) -> (&'p Declared<Pin>, &'p [Expr]) {
    let open = entries.iter().position(|entry| !entry.is_zero());
    let place = open.unwrap_or_default() / each.max(1);
    (&pins[place], &entries[each * place..each * (place + 1)])
}
