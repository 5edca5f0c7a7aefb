//! `[[loop]]` and `[[coupling]]`: what holds bodies together beyond the tree that they are. They are read before the tree, whose order depends on them, with the names of their bodies.

use super::{elements, placement, rotation};
use crate::coupling::Tie;
use crate::description::{Closing, CouplingDescription, LoopDescription, LoopEnd};
use crate::diagnostics::Diagnostic;
use crate::parse::WORLD;
use crate::read::{Fields, Sink};
use crate::source::Located;
use hamel_runtime::shown::Number;
use hamel_runtime::spatial::Pose;
use nalgebra::Vector3;
use std::collections::HashMap;

/// What could be read of loops and couplings.
#[derive(Debug, Default)]
pub(crate) struct TieDrafts {
    loops: Vec<Draft<LoopDescription>>,
    couplings: Vec<Draft<CouplingDescription>>,
}

impl TieDrafts {
    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.loops.is_empty() && self.couplings.is_empty()
    }
}

/// All of a tie except its bodies, of which the names are known.
#[derive(Debug)]
struct Draft<D> {
    tie: D,
    ends: [Located<String>; 2],
}

/// Reads both lists.
pub(super) fn ties(fields: &mut Fields<'_>, sink: &mut Sink) -> TieDrafts {
    let drafts = TieDrafts {
        loops: elements::each(fields, "loop", closed, sink),
        couplings: elements::each(fields, "coupling", coupling, sink),
    };
    let mut known: HashMap<&str, &Located<String>> = HashMap::new();
    for name in drafts.names() {
        let first = *known.entry(&name.value).or_insert(name);
        if first.span != name.span {
            let message = format!("two loops or couplings are called `{}`", name.value);
            let error = Diagnostic::new(name.span.clone(), message).label("the second one");
            sink.push(error.context(first.span.clone(), "the first one"));
        }
    }
    drafts
}

fn closed(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<Draft<LoopDescription>> {
    let name = elements::name(fields, "loop", sink);
    let closing = fields.required("type", sink);
    let closing = closing.and_then(|closing| closing.choice(&Closing::NAMES, sink));
    let axis = match fields.optional("axis") {
        None => Some(Pose::identity()),
        Some(axis) => axis
            .vector(sink)
            .and_then(|axis| turned(&axis, fields, sink)),
    };
    let ends = ["predecessor", "successor"].map(|key| end(fields, key, sink));
    let independent = independent(fields, sink);
    let ([Some((first, at)), Some((second, other))], axis) = (ends, axis?) else {
        return None;
    };
    Some(Draft {
        tie: LoopDescription {
            name: name?,
            closing: Closing::of(closing?)?,
            ends: [at, other].map(|at| LoopEnd {
                body: None,
                at: at * axis,
            }),
            independent: independent?,
        },
        ends: [first, second],
    })
}

/// The rotation that turns z onto the axis.
fn turned(axis: &Located<Vector3<f64>>, fields: &Fields<'_>, sink: &mut Sink) -> Option<Pose<f64>> {
    let path = format!("{}`axis`", fields.owner());
    let axis = Located::new(axis.value, axis.span.clone());
    rotation::from_axis(&path, axis, sink).map(Pose::from_rotation)
}

/// The joints that are to move independently.
fn independent(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<Vec<Located<String>>> {
    let Some(list) = fields.optional("independent") else {
        return Some(Vec::new());
    };
    let items = list.items("entry", "a list of names of joints", sink)?;
    items.iter().map(|item| item.text(sink)).collect()
}

/// The body, and the frame there.
fn end(
    fields: &mut Fields<'_>,
    key: &'static str,
    sink: &mut Sink,
) -> Option<(Located<String>, Pose<f64>)> {
    let mut fields = fields.required(key, sink)?.table(sink)?;
    let body = fields.required("body", sink);
    let body = body.and_then(|body| body.text(sink));
    let at = match fields.optional("at") {
        Some(at) => placement::pose(&at, sink).map(|at| at.value),
        None => Some(Pose::identity()),
    };
    fields.finish(sink);
    Some((body?, at?))
}

fn coupling(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<Draft<CouplingDescription>> {
    let name = elements::name(fields, "coupling", sink);
    let ends = ["predecessor", "successor"].map(|key| {
        let end = fields.required(key, sink);
        end.and_then(|end| end.text(sink))
    });
    let mut number = |key, default| match fields.optional(key) {
        Some(value) => value.number(sink).map(|number| number.value),
        None => Some(default),
    };
    let (ratio, offset) = (number("ratio", 1.0), number("offset", 0.0));
    let independent = independent(fields, sink);
    let [first, second] = ends;
    Some(Draft {
        tie: CouplingDescription {
            name: name?,
            ends: [None; 2],
            ratio: ratio?,
            offset: offset?,
            independent: independent?,
        },
        ends: [first?, second?],
    })
}

impl TieDrafts {
    fn names(&self) -> impl Iterator<Item = &Located<String>> {
        let loops = self.loops.iter().map(|draft| &draft.tie.name);
        loops.chain(self.couplings.iter().map(|draft| &draft.tie.name))
    }

    /// The drafts with their bodies, by places that `place` finds by name. What is not found is an error.
    pub(super) fn found(
        &mut self,
        place: impl Fn(&str) -> Option<usize>,
        known: &[&str],
        sink: &mut Sink,
    ) -> Option<()> {
        let mut find = |kind: &str, name: &Located<String>, end: &Located<String>| {
            if end.value == WORLD {
                return Some(None);
            }
            if let Some(place) = place(&end.value) {
                return Some(Some(place));
            }
            let message = format!(
                "{kind} `{}`: {:?} is not a body of the scene",
                name.value, end.value
            );
            sink.unknown(
                Diagnostic::new(end.span.clone(), message),
                &end.value,
                known,
                "a body is",
            );
            None
        };
        let mut complete = true;
        for draft in &mut self.loops {
            for (end, body) in draft.tie.ends.iter_mut().zip(&draft.ends) {
                match find("loop", &draft.tie.name, body) {
                    Some(found) => end.body = found,
                    None => complete = false,
                }
            }
        }
        for draft in &mut self.couplings {
            for (end, body) in draft.tie.ends.iter_mut().zip(&draft.ends) {
                match find("coupling", &draft.tie.name, body) {
                    Some(found) => *end = found,
                    None => complete = false,
                }
            }
        }
        complete.then_some(())
    }

    /// As couplings look at them, with bodies as places in the file.
    pub(super) fn ties(&self) -> Vec<Tie<'_>> {
        let loops = self.loops.iter().map(|draft| Tie::of_loop(&draft.tie));
        let couplings = self.couplings.iter();
        let couplings = couplings.map(|draft| Tie::of_coupling(&draft.tie));
        loops.chain(couplings).collect()
    }

    /// Both lists, with bodies by what `rank` makes of their places.
    pub(crate) fn ranked(
        self,
        rank: impl Fn(usize) -> usize,
    ) -> (Vec<LoopDescription>, Vec<CouplingDescription>) {
        let loops = self.loops.into_iter().map(|draft| {
            let mut tie = draft.tie;
            tie.ends
                .iter_mut()
                .for_each(|end| end.body = end.body.map(&rank));
            tie
        });
        let couplings = self.couplings.into_iter().map(|draft| {
            let mut tie = draft.tie;
            tie.ends = tie.ends.map(|end| end.map(&rank));
            tie
        });
        (loops.collect(), couplings.collect())
    }
}

/// Why the ratio of a coupling cannot be.
pub(crate) fn no_ratio(coupling: &Located<String>, ratio: f64) -> Option<Diagnostic> {
    (ratio == 0.0 || !ratio.is_finite()).then(|| {
        let message = format!(
            "coupling `{}`: its ratio is {:?}: it must be finite and not 0",
            coupling.value,
            Number(ratio)
        );
        Diagnostic::new(coupling.span.clone(), message)
    })
}
