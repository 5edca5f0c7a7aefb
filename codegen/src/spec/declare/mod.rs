//! Tree to joint: what each statement declares, checked against the others.

mod basis;
mod bodies;
mod config;
mod curve;
mod division;
mod equation;
mod freedoms;
mod home;
mod implicit;
mod loci;
mod matrices;
mod once;
mod parameter;
mod period;
mod pins;
mod ports;
mod relations;
mod retract;
mod scope;
mod stored;
mod table;
mod unit;
mod unproved;
mod words;

use self::bodies::Bodies;
use self::freedoms::Freedoms;
use self::once::Once;
use self::scope::Scope;
use super::ast::File;
use super::evaluate::Evaluator;
use super::{code, limits, units};
use crate::diagnostic::Diagnostic;
use crate::expr::budget;
use crate::expr::curve::Curve;
use crate::manifold::Manifold;
use crate::model::{Declared, JointSpec, VelocityFrame, Worded};
use crate::units::Units;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The joint that the file declares; `None` where something essential is wrong. Reasons are among the errors.
pub(super) fn joint(
    (source, folder): (&str, Option<&Path>),
    file: &File,
    errors: &mut Vec<Diagnostic>,
) -> Option<JointSpec> {
    let statements = once::collect(source, file, errors);
    let manifold = config::manifold(file, &statements, errors);
    let before = errors.len();
    let result = budget::scope(limits::FILE_BUDGET, || {
        let mut evaluator = Evaluator::new(errors);
        evaluator.lenient = file.partial || statements.config.is_none();
        match &manifold {
            Some(manifold) => declare(
                (source, folder),
                file,
                &statements,
                manifold,
                &mut evaluator,
            ),
            None => {
                without_manifold((source, folder), file, &statements, &mut evaluator);
                None
            }
        }
    });
    if result.is_err() && errors.len() == before {
        let error = Diagnostic::new(
            code::TOO_LARGE,
            file.name.span.clone(),
            "the joint needs too many products of terms",
        );
        errors.push(error.label("too much work"));
    }
    result.ok().flatten()
}

/// Looks for the errors that can be told while the configuration is not known.
fn without_manifold(
    (source, folder): (&str, Option<&Path>),
    file: &File,
    statements: &Once<'_>,
    evaluator: &mut Evaluator<'_>,
) {
    let mut scope = Scope::new(source, evaluator);
    scope.joint(&file.name);
    scope.parameters(&file.parameters);
    scope.curves(&statements.curves, folder);
    scope.unknown_factors(statements.config);
    scope.lets(&statements.lets);
    bodies::bodies(source, file, statements, evaluator);
    ports::evaluate_only(source, statements, evaluator);
    pins::evaluate_only(source, statements, evaluator);
    matrices::evaluate_only(statements, evaluator);
    scope::report_unused(file, statements, evaluator);
}

/// What the matrices of a joint are checked against.
struct Context<'a> {
    file: &'a File,
    statements: &'a Once<'a>,
    manifold: &'a Declared<Manifold>,
    /// Names of parameters, factors, stored scalars, `let`s and their entries.
    names: BTreeSet<String>,
    curves: BTreeMap<String, Option<Curve>>,
}

fn declare(
    (source, folder): (&str, Option<&Path>),
    file: &File,
    statements: &Once<'_>,
    manifold: &Declared<Manifold>,
    evaluator: &mut Evaluator<'_>,
) -> Option<JointSpec> {
    let mut scope = Scope::new(source, evaluator);
    scope.joint(&file.name);
    let parameters = scope.parameters(&file.parameters);
    let curves = scope.curves(&statements.curves, folder);
    scope.factors(statements.config, manifold.value.factors());
    scope.lets(&statements.lets);
    let names = scope.names();
    let (manifold, relation_spans) = relations::constrained(statements, manifold, scope.evaluator);
    let context = Context {
        file,
        statements,
        manifold: &manifold,
        names,
        curves: scope.evaluator.curves.clone(),
    };
    let home = home::home(&context, scope.evaluator);
    let declared_home = home.declared.as_ref().filter(|_| !home.is_guess);
    let declared_home = declared_home.map(|home| home.value.as_slice());
    let loci = loci::loci(&context, declared_home, source, scope.evaluator);
    let requirements = parameter::requirements(statements, source, scope.evaluator);
    let freedoms = freedoms::freedoms(&context, &mut scope);
    let velocity = freedoms
        .as_ref()
        .map(|freedoms| freedoms::velocity(&context, freedoms, evaluator));
    let retract = freedoms
        .as_ref()
        .and_then(|freedoms| retract::retract(&context, freedoms, evaluator));
    let bodies = bodies::bodies(source, file, statements, evaluator);
    let ports = ports::ports(&context, source, evaluator);
    let pins = pins::pins(source, statements, evaluator);
    let matrices = match &freedoms {
        Some(freedoms) => Some(matrices::matrices(&context, &freedoms.names(), evaluator)),
        None => {
            matrices::evaluate_only(statements, evaluator);
            None
        }
    };
    scope::report_unused(file, statements, evaluator);
    let (freedoms, matrices): (Freedoms, _) = (freedoms?, matrices?);
    let worded = match evaluator.errors.is_empty() {
        true => words::worded(&context, source, &freedoms.names()),
        false => Worded::default(),
    };
    let Bodies { names, poses } = bodies?;
    let mut poses = poses.into_iter();
    let mut spec = JointSpec {
        name: Declared {
            value: file.name.text.clone(),
            span: file.name.span.clone(),
        },
        docs: file.docs.clone(),
        source: source.to_owned(),
        parameters,
        requirements,
        manifold,
        relation_spans,
        units: Units::default(),
        loci,
        home_is_guess: home.is_guess,
        home: home.declared,
        freedoms: freedoms.list,
        velocity: velocity?,
        bodies: names,
        pose: poses.next()?,
        more: poses.collect(),
        ports,
        pins,
        retract,
        implicit: freedoms.implicit,
        twist_map: matrices.twist_map,
        constraint: matrices.constraint,
        speed_basis: matrices.speed_basis,
        speed_names: matrices.speed_names,
        worded,
        unproved: unproved::unproved(&statements.unproved, evaluator),
        curves,
        calls: std::mem::take(&mut evaluator.calls),
    };
    evaluator
        .errors
        .extend(division::errors(&spec, statements.relations_span()));
    // Values that are made beyond the budget are zero.
    if !budget::is_exhausted() {
        match units::of_spec(&spec) {
            Ok(units) => spec.units = units,
            Err(errors) => evaluator.errors.extend(errors),
        }
    }
    Some(spec)
}

impl Freedoms {
    fn names(&self) -> Vec<&str> {
        self.list
            .value
            .iter()
            .map(|freedom| freedom.name.as_str())
            .collect()
    }

    fn frame_needed(&self, manifold: &Manifold) -> bool {
        let group = |factor: usize| {
            !matches!(
                manifold.factors()[factor].kind,
                crate::manifold::Kind::Real(_)
            )
        };
        !self.local && self.list.value.iter().any(|freedom| group(freedom.factor))
    }
}

/// `VelocityFrame` of a statement.
fn frame(child: bool) -> VelocityFrame {
    match child {
        true => VelocityFrame::Child,
        false => VelocityFrame::Parent,
    }
}
