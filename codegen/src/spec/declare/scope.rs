//! The names of a spec: each is defined once, in a form that Rust can take over, and used.

use super::super::ast::{Curve, File, Name, Node, Parameter};
use super::super::code;
use super::super::evaluate::{Evaluator, FUNCTIONS};
use super::super::names::{self, Form};
use super::super::value::Value;
use super::once::{At, Once, line};
use super::{curve, unit};
use crate::diagnostic::Diagnostic;
use crate::expr::{Expr, Role, Symbol};
use crate::manifold::{Factor, Kind};
use crate::matrix::Matrix;
use crate::model;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

/// Names claimed so far, with what they name and where.
pub(super) struct Scope<'s, 'e, 'a> {
    source: &'s str,
    pub evaluator: &'e mut Evaluator<'a>,
    claimed: BTreeMap<String, (String, Range<usize>)>,
}

impl<'s, 'e, 'a> Scope<'s, 'e, 'a> {
    pub fn new(source: &'s str, evaluator: &'e mut Evaluator<'a>) -> Self {
        Self {
            source,
            evaluator,
            claimed: BTreeMap::new(),
        }
    }

    pub fn joint(&mut self, name: &Name) {
        self.evaluator.errors.extend(names::check_joint(name));
    }

    /// Checks the form of the name, and that it is new.
    pub fn claim(&mut self, name: &Name, form: Form, owner: &str) {
        match names::check(name, form, FUNCTIONS) {
            Some(error) => self.evaluator.report(error),
            None => _ = self.claim_text(&name.text, &name.span, owner),
        }
    }

    /// Claims a name that is made from one of the spec; false where it is taken.
    pub fn claim_text(&mut self, text: &str, span: &Range<usize>, owner: &str) -> bool {
        let Some((first, place)) = self.claimed.get(text) else {
            self.claimed
                .insert(text.to_owned(), (owner.to_owned(), span.clone()));
            return true;
        };
        let message = format!("`{text}`, {owner}, is already {first}");
        let error = Diagnostic::new(code::DUPLICATE_NAME, span.clone(), message)
            .label("defined again here");
        let error = error.note(format!(
            "first defined in line {}",
            line(self.source, place)
        ));
        self.evaluator.report(error.help("choose another name"));
        false
    }

    pub fn parameters(&mut self, parameters: &[Parameter]) -> Vec<model::Parameter> {
        let mut declared = vec![];
        for (index, parameter) in parameters.iter().enumerate() {
            self.claim(&parameter.name, Form::Snake, "a parameter");
            let reserved = names::check_parameter(&parameter.name);
            self.evaluator.errors.extend(reserved);
            self.evaluator.errors.extend(unit::error(&parameter.unit));
            let range = parameter.range.as_ref();
            let range = range.map(|range| super::parameter::interval(range, self.evaluator));
            let symbol = Symbol::new(Role::Parameter, index, &parameter.name.text);
            self.evaluator.define(
                &parameter.name.text,
                Some(Value::Scalar(Expr::symbol(&symbol))),
            );
            declared.push(model::Parameter {
                symbol,
                unit: parameter.unit.text.clone(),
                docs: parameter.docs.join("\n"),
                range: range.unwrap_or_default(),
            });
        }
        declared
    }

    /// The curves, each with the knots of its file where that names one.
    pub fn curves(
        &mut self,
        curves: &[At<'_, Curve>],
        folder: Option<&Path>,
    ) -> Vec<model::DeclaredCurve> {
        let mut declared = vec![];
        for curve in curves {
            self.claim(&curve.value.name, Form::Snake, "a curve");
            let made = curve::curve(self.source, *curve, folder);
            let known = self.evaluator.settle(made);
            let name = curve.value.name.text.clone();
            let of_name = known.as_ref().map(|known| known.curve);
            self.evaluator.curves.insert(name, of_name);
            declared.extend(known);
        }
        declared
    }

    /// The factors of a `config` that is wrong, so that nothing more is said of them.
    pub fn unknown_factors(&mut self, config: Option<At<'_, [(Name, Name)]>>) {
        for (name, _) in config.map(|config| config.value).unwrap_or_default() {
            self.claim(name, Form::Any, "a factor of the configuration");
            self.evaluator.define(&name.text, None);
        }
    }

    /// The factors of `config`, and their stored scalars.
    pub fn factors(&mut self, config: Option<At<'_, [(Name, Name)]>>, factors: &[Factor]) {
        let names = config.map(|config| config.value).unwrap_or_default();
        for ((name, _), factor) in names.iter().zip(factors) {
            self.claim(name, Form::Any, "a factor of the configuration");
            self.evaluator.define(&name.text, Some(value_of(factor)));
        }
        for ((name, _), factor) in names.iter().zip(factors) {
            self.claim_scalars(name, factor);
        }
    }

    /// The stored scalars of a factor, and those of the configuration that ϕ leads to; the first that is taken stands for all.
    fn claim_scalars(&mut self, name: &Name, factor: &Factor) {
        let owner = format!("a stored scalar of `{}`", name.text);
        let of_target = format!("a stored scalar of a target of `{}`", name.text);
        let span = &name.span;
        let mut symbols = factor.coordinates.iter();
        _ = symbols.all(|symbol| {
            let is_factor = *symbol.name() == *name.text;
            (is_factor || self.claim_text(symbol.name(), span, &owner))
                && self.claim_text(&format!("{}_target", symbol.name()), span, &of_target)
        });
    }

    /// `let`s in order: each sees those above it.
    pub fn lets(&mut self, lets: &[(&Name, &Node)]) {
        self.evaluator
            .expect(lets.iter().map(|(name, _)| name.text.clone()).collect());
        for (name, node) in lets {
            let statement = format!("let {}", name.text);
            let value = self
                .evaluator
                .bounded(&statement, &node.span, |evaluator| evaluator.value(node));
            self.claim(name, Form::Snake, "an auxiliary value");
            self.claim_entries(name, value.as_ref());
            self.evaluator.define(&name.text, value);
        }
    }

    /// The names of the entries of a `let` that is no scalar; the first that is taken stands for all.
    fn claim_entries(&mut self, name: &Name, value: Option<&Value>) {
        let names = value.map(|value| value.entry_names(&name.text));
        let mut names = names.unwrap_or_default().into_iter();
        let owner = format!("an entry of `{}`", name.text);
        _ = names.all(|entry| entry == name.text || self.claim_text(&entry, &name.span, &owner));
    }

    /// All names so far.
    pub fn names(&self) -> BTreeSet<String> {
        self.claimed.keys().cloned().collect()
    }
}

/// The value of a factor's name: scalars and columns of real factors and spheres, elements of groups.
fn value_of(factor: &Factor) -> Value {
    match factor.kind {
        Kind::Real(_) => Value::matrix(Matrix::symbols(&factor.coordinates)),
        Kind::S2 => Value::Matrix(factor.matrix()),
        kind => Value::Element(kind, factor.matrix()),
    }
}

/// Parameters and `let`s that nothing uses. Where a name is undefined, that one may be a misspelling of the unused.
pub(super) fn report_unused(file: &File, statements: &Once<'_>, evaluator: &mut Evaluator<'_>) {
    let parameters = file
        .parameters
        .iter()
        .map(|parameter| (&parameter.name, "parameter"));
    let lets = statements
        .lets
        .iter()
        .map(|(name, _)| (*name, "auxiliary value"));
    let undefined = evaluator
        .errors
        .iter()
        .any(|error| error.code == code::UNDEFINED);
    if file.partial || undefined {
        return;
    }
    let used = file.used_names();
    let curves = statements.curves.iter();
    let curves = curves.map(|curve| (&curve.value.name, "curve"));
    for (name, what) in parameters
        .chain(lets)
        .chain(curves)
        .filter(|(name, _)| !used.contains(name.text.as_str()))
    {
        let error = Diagnostic::new(
            code::UNUSED,
            name.span.clone(),
            format!("{what} `{}` is never used", name.text),
        );
        evaluator.report(error.label("never used").help("use it or remove it"));
    }
}
