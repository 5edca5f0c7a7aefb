//! Statements by kind: which may stand once, and where they stand.

use super::super::ast::{
    Basis, Curve, Equation, File, Name, Node, Pin, Port, Requirement, StatementKind, Target,
};
use super::super::code;
use crate::diagnostic::Diagnostic;
use std::collections::BTreeMap;
use std::ops::Range;

/// A statement's content and its bytes.
pub(super) struct At<'a, T: ?Sized> {
    pub value: &'a T,
    pub span: &'a Range<usize>,
}

// Derived, these would ask that `T` be copied.
impl<T: ?Sized> Clone for At<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: ?Sized> Copy for At<'_, T> {}

/// All statements of a joint.
#[derive(Default)]
pub(super) struct Once<'a> {
    pub config: Option<At<'a, [(Name, Name)]>>,
    pub local: Option<At<'a, [Name]>>,
    pub velocity: Option<At<'a, bool>>,
    pub speeds: Option<At<'a, [Name]>>,
    pub bodies: Option<At<'a, [Name]>>,
    /// H of each of them.
    pub body_poses: Vec<(&'a Name, At<'a, [Node]>)>,
    pub bases: Vec<At<'a, Basis>>,
    pub ports: Vec<At<'a, Port>>,
    pub pins: Vec<At<'a, Pin>>,
    pub lets: Vec<(&'a Name, &'a Node)>,
    pub curves: Vec<At<'a, Curve>>,
    pub relations: Vec<At<'a, Equation>>,
    pub exceptions: Vec<At<'a, Equation>>,
    pub requirements: Vec<At<'a, Requirement>>,
    /// Claims and reasons.
    pub unproved: Vec<(&'a Name, &'a Name)>,
    targets: BTreeMap<Target, At<'a, [Node]>>,
}

impl<'a> Once<'a> {
    pub fn target(&self, target: Target) -> Option<At<'a, [Node]>> {
        self.targets.get(&target).copied()
    }

    /// How many bodies the joint carries.
    pub fn body_count(&self) -> usize {
        self.bodies.map_or(1, |bodies| bodies.value.len())
    }

    /// From the first relation to the last.
    pub fn relations_span(&self) -> Option<Range<usize>> {
        let (first, last) = (self.relations.first()?, self.relations.last()?);
        Some(first.span.start..last.span.end)
    }
}

/// Sorts the statements; those that stand twice are errors.
pub(super) fn collect<'a>(source: &str, file: &'a File, errors: &mut Vec<Diagnostic>) -> Once<'a> {
    let mut once = Once::default();
    for statement in &file.statements {
        let span = &statement.span;
        let (word, first) = match &statement.kind {
            StatementKind::Config(value) => {
                ("config", replace(&mut once.config, value.as_slice(), span))
            }
            StatementKind::Local(value) => {
                ("local", replace(&mut once.local, value.as_slice(), span))
            }
            StatementKind::Velocity { child } => {
                ("velocity", replace(&mut once.velocity, child, span))
            }
            StatementKind::Speeds(value) => {
                ("speeds", replace(&mut once.speeds, value.as_slice(), span))
            }
            StatementKind::Bodies(value) => {
                ("bodies", replace(&mut once.bodies, value.as_slice(), span))
            }
            StatementKind::BodyPose(body, values) => {
                let mut known = once.body_poses.iter();
                let known = known.find(|(other, _)| other.text == body.text);
                match known.map(|(_, at)| at.span) {
                    Some(first) => {
                        let word = format!("H.{}", body.text);
                        errors.push(twice(source, &word, first, span));
                    }
                    None => {
                        let value = values.as_slice();
                        once.body_poses.push((body, At { value, span }));
                    }
                }
                continue;
            }
            StatementKind::Basis(value) => {
                once.bases.push(At { value, span });
                continue;
            }
            StatementKind::Port(value) => {
                once.ports.push(At { value, span });
                continue;
            }
            StatementKind::Pin(value) => {
                once.pins.push(At { value, span });
                continue;
            }
            StatementKind::Let(name, value) => {
                once.lets.push((name, value));
                continue;
            }
            StatementKind::Curve(value) => {
                once.curves.push(At { value, span });
                continue;
            }
            StatementKind::Relation(value) => {
                once.relations.push(At { value, span });
                continue;
            }
            StatementKind::Except(value) => {
                once.exceptions.push(At { value, span });
                continue;
            }
            StatementKind::Require(value) => {
                once.requirements.push(At { value, span });
                continue;
            }
            StatementKind::Unproved(claim, reason) => {
                once.unproved.push((claim, reason));
                continue;
            }
            StatementKind::Assign(target, values) => {
                let first = once.targets.get(target).map(|at| at.span);
                once.targets.entry(*target).or_insert(At {
                    value: values.as_slice(),
                    span,
                });
                (target.name(), first)
            }
        };
        if let Some(first) = first {
            errors.push(twice(source, word, first, span));
        }
    }
    once
}

/// Keeps the first; returns where that is, if this is the second.
fn replace<'a, T: ?Sized>(
    slot: &mut Option<At<'a, T>>,
    value: &'a T,
    span: &'a Range<usize>,
) -> Option<&'a Range<usize>> {
    let first = slot.as_ref().map(|at| at.span);
    if slot.is_none() {
        *slot = Some(At { value, span });
    }
    first
}

fn twice(source: &str, word: &str, first: &Range<usize>, span: &Range<usize>) -> Diagnostic {
    let error = Diagnostic::new(
        code::DUPLICATE_STATEMENT,
        span.clone(),
        format!("`{word}` is declared twice"),
    );
    error
        .label("declared again here")
        .note(format!("first declared in line {}", line(source, first)))
}

/// The line in which a span starts, counted from 1.
pub(super) fn line(source: &str, span: &Range<usize>) -> usize {
    1 + source[..span.start].matches('\n').count()
}
