//! `bodies` and H: one pose for each body that the joint carries.

use super::super::ast::{File, Name, Target};
use super::super::evaluate::Evaluator;
use super::super::limits::MOST_BODIES;
use super::super::{code, names};
use super::matrices;
use super::once::{At, Once, line};
use crate::diagnostic::Diagnostic;
use crate::model::{Declared, PoseExpr};

/// The bodies of a joint.
pub(super) struct Bodies {
    /// Their names, where the spec gives some.
    pub names: Vec<String>,
    /// H of each.
    pub poses: Vec<Declared<PoseExpr>>,
}

/// The bodies, if each has a pose; every error in `bodies`, `H` and `H.name` is reported.
pub(super) fn bodies(
    source: &str,
    file: &File,
    statements: &Once<'_>,
    evaluator: &mut Evaluator<'_>,
) -> Option<Bodies> {
    let poses = poses(statements, evaluator);
    match statements.bodies {
        Some(bodies) => check_names(source, bodies.value, evaluator),
        None => nameless(file, statements, evaluator),
    }
    if let Some(bodies) = statements.bodies {
        check_poses(file, bodies.value, statements, evaluator);
    }
    let poses = poses?;
    let names: Vec<String> = (statements.bodies.map(|bodies| bodies.value))
        .unwrap_or_default()
        .iter()
        .map(|name| name.text.clone())
        .collect();
    (poses.len() == statements.body_count()).then_some(Bodies { names, poses })
}

/// H of each body that has one, in the order of `bodies`; `None` where one is wrong. All are evaluated, for the errors in them.
pub(super) fn poses(
    statements: &Once<'_>,
    evaluator: &mut Evaluator<'_>,
) -> Option<Vec<Declared<PoseExpr>>> {
    let names = statements.bodies.map(|bodies| bodies.value);
    let place = |body: &Name| {
        let mut names = names.unwrap_or_default().iter();
        names.position(|name| name.text == body.text)
    };
    let mut named: Vec<_> = statements.body_poses.iter().collect();
    named.sort_by_key(|(body, _)| place(body).unwrap_or(usize::MAX));
    let alone = statements.target(Target::Pose);
    let alone = alone.map(|statement| ("H".to_owned(), statement));
    let named = named
        .into_iter()
        .map(|(body, statement)| (format!("H.{}", body.text), *statement));
    let poses: Vec<Option<Declared<PoseExpr>>> = alone
        .into_iter()
        .chain(named)
        .map(|(name, statement)| {
            let value = matrices::pose(&name, statement, evaluator)?;
            let span = statement.span.clone();
            Some(Declared { value, span })
        })
        .collect();
    poses.into_iter().collect()
}

/// Form and number of the names, and that no two are alike.
fn check_names(source: &str, names: &[Name], evaluator: &mut Evaluator<'_>) {
    for (n, name) in names.iter().enumerate() {
        evaluator.errors.extend(names::check_unspoken(name));
        if let Some(first) = names[..n].iter().find(|other| other.text == name.text) {
            let message = format!("body `{}` is named twice", name.text);
            let error = Diagnostic::new(code::DUPLICATE_NAME, name.span.clone(), message)
                .label("named again here");
            let first = line(source, &first.span);
            evaluator.report(error.note(format!("first named in line {first}")));
        }
    }
    if let Some(beyond) = names.get(MOST_BODIES) {
        let count = names.len();
        let message = format!("{count} bodies, a joint carries at most {MOST_BODIES}");
        let error = Diagnostic::new(code::FREEDOMS, beyond.span.clone(), message);
        evaluator.report(error.label("one too many"));
    }
}

/// A joint without `bodies` has one H.
fn nameless(file: &File, statements: &Once<'_>, evaluator: &mut Evaluator<'_>) {
    for (body, statement) in &statements.body_poses {
        let message = format!(
            "`H.{}` is of one of several bodies, which no `bodies` names",
            body.text
        );
        let error = Diagnostic::new(code::BODIES, statement.span.clone(), message);
        evaluator.report(error.label("of which body?").help(format!(
            "name the bodies, `bodies {};`, or write `H = …;`",
            all_named(statements)
        )));
    }
    let has_pose = statements.target(Target::Pose).is_some() || !statements.body_poses.is_empty();
    if !has_pose && !file.partial {
        let name = &file.name;
        let message = format!("joint `{}` declares no H", name.text);
        let error = Diagnostic::new(code::MISSING, name.span.clone(), message);
        evaluator.report(
            error
                .label("H is missing")
                .help("add `H = …;`, the pose of the child in the parent as a function of Q"),
        );
    }
}

fn all_named(statements: &Once<'_>) -> String {
    let poses = statements.body_poses.iter();
    let names: Vec<&str> = poses.map(|(body, _)| body.text.as_str()).collect();
    names.join(", ")
}

/// Each body has one pose, and each pose a body.
fn check_poses(file: &File, names: &[Name], statements: &Once<'_>, evaluator: &mut Evaluator<'_>) {
    if let Some(At { span, .. }) = statements.target(Target::Pose) {
        let message = "`H` beside `bodies` does not say of which body";
        let error = Diagnostic::new(code::BODIES, span.clone(), message).label("of which body?");
        let first = names.first().map_or("", |name| name.text.as_str());
        evaluator.report(error.help(format!(
            "write `H.{first} = …;` and its like, or remove `bodies`"
        )));
    }
    let known = || names.iter().map(|name| name.text.as_str());
    for (body, _) in &statements.body_poses {
        if known().any(|name| name == body.text) {
            continue;
        }
        let message = format!("`{}` is not among the bodies", body.text);
        let error =
            Diagnostic::new(code::UNDEFINED, body.span.clone(), message).label("no such body");
        let list = || format!("the bodies are {}", known().collect::<Vec<_>>().join(", "));
        let advice = names::suggestion(&body.text, known());
        evaluator.report(error.help(advice.unwrap_or_else(list)));
    }
    let has_pose = |name: &&Name| {
        let mut poses = statements.body_poses.iter();
        poses.any(|(body, _)| body.text == name.text)
    };
    for name in names.iter().filter(|name| !has_pose(name)) {
        if file.partial {
            continue;
        }
        let message = format!("body `{}` has no H", name.text);
        let error = Diagnostic::new(code::MISSING, name.span.clone(), message);
        evaluator.report(error.label("H is missing").help(format!(
            "add `H.{} = …;`, its pose in the parent as a function of Q",
            name.text
        )));
    }
}
