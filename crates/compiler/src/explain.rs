//! What was left out of a scene's equations, why, and what that saved.

use super::functions::{Chosen, Kind, Loops, compile, compile_with};
use super::graph::{Argument, Sym, record};
use super::joint::Joint;
use super::model::{Body, Inertia, Model};
use super::prune::{Fixed, Link, Pruning, prune};
use std::fmt::Write;

/// Names of the ten parameters of an inertia.
const PARAMETERS: [&str; 10] = [
    "m", "mc_x", "mc_y", "mc_z", "∫x²dm", "∫y²dm", "∫z²dm", "∫xydm", "∫xzdm", "∫yzdm",
];

/// The account, as text.
pub fn explain(model: &Model, kinds: &[Kind]) -> String {
    let bare = prune(model, Pruning::NONE);
    let framed = prune(
        model,
        Pruning {
            frames: true,
            inertias: false,
        },
    );
    let pruned = prune(model, Pruning::ALL);
    let mut text = format!("{}: {} bodies\n", model.name, model.bodies.len());
    for (index, body) in model.bodies.iter().enumerate() {
        text += &of_body(model, body, [&bare[index], &framed[index], &pruned[index]]);
    }
    for &kind in kinds {
        if let Err(not) = compile(model, kind, Loops::default()) {
            let _ = writeln!(text, "\n{not}");
            continue;
        }
        let chosen = [&bare, &framed, &pruned]
            .map(|links| compile_with(model, links, kind, Loops::default()));
        text += &of_function(kind, &chosen);
        text += &of_loops(model, &chosen[2]);
    }
    text
}

fn of_body(model: &Model, body: &Body, [bare, framed, pruned]: [&Link; 3]) -> String {
    let mut text = format!(
        "\n{} (joint `{}`, {})\n",
        body.name, body.joint_name, body.joint.derived.spec.name.value
    );
    if bare.placement != framed.placement || bare.after != framed.after {
        let _ = writeln!(
            text,
            "  frame moved: placement {} instead of {}",
            placement(&framed.placement),
            placement(&bare.placement)
        );
    }
    let gone = left_out(&framed.inertia, &pruned.inertia);
    if !gone.is_empty() {
        let to = body
            .parent
            .map_or("dropped at the world".to_owned(), |parent| {
                format!("moved to `{}`", model.bodies[parent].name)
            });
        let others = match body.leads() && body.joint.more.is_empty() {
            true => "",
            false => " and to the joint's other bodies",
        };
        let _ = writeln!(
            text,
            "  inertia that does not affect the joint: {} = 0, {to}{others}",
            gone.join(", ")
        );
    }
    if let Some(reason) = without_bias(body) {
        let _ = writeln!(text, "  {reason}");
    }
    text
}

/// Parameters that were not 0 and are.
fn left_out(before: &Inertia, after: &Inertia) -> Vec<&'static str> {
    let pairs = before.parameters().into_iter().zip(after.parameters());
    let gone = pairs
        .zip(PARAMETERS)
        .filter(|((before, after), _)| *before != 0.0 && *after == 0.0);
    gone.map(|(_, name)| name).collect()
}

fn placement(steps: &[Fixed]) -> String {
    let one = |step: &Fixed| match step {
        Fixed::Shift(by) => format!("({}, {}, {}) m", by.x, by.y, by.z),
        Fixed::Turn(axis, cos, sin) => {
            format!(
                "{:.6}° about {}",
                sin.atan2(*cos).to_degrees(),
                ["x", "y", "z"][*axis]
            )
        }
    };
    match steps {
        [] => "none".to_owned(),
        steps => steps.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

/// What holds of a joint's own velocity terms.
fn without_bias(body: &Body) -> Option<&'static str> {
    let shape = body.joint.derived.shape;
    let (vanishes, _) = record(|| {
        let inputs = |argument, count: usize| -> Vec<Sym> {
            (0..count).map(|i| Sym::input(argument, i)).collect()
        };
        let q = inputs(Argument::Configuration, shape.configuration);
        let speeds = inputs(Argument::Speeds, shape.speeds);
        let bias = Joint::new(&body.joint, &body.parameters, &q, &speeds).bias_acceleration();
        bias == super::spatial::Twist::zero()
    });
    let nonholonomic = shape.constraints > 0;
    match (vanishes, nonholonomic) {
        (true, false) => Some("no velocity terms of its own (c = 0), no nonholonomic part"),
        (true, true) => Some("no velocity terms of its own (c = 0)"),
        (false, false) => Some("no nonholonomic part"),
        (false, true) => None,
    }
}

/// What is looped over.
fn of_loops(model: &Model, chosen: &Chosen) -> String {
    let function = &chosen.function;
    let Some(plan) = &function.plan else {
        return String::new();
    };
    let mut text = format!(
        "  {:>7} of {} operations are written: the rest is turns of loops\n",
        function.written(),
        function.operations().flops()
    );
    for group in plan.groups.iter().filter(|group| group.len() > 1) {
        let name = |block: &usize| {
            let section = plan.blocks.blocks[*block].section as usize;
            model.bodies.get(section).map_or("?", |body| &body.name)
        };
        let ends = group.first().zip(group.last());
        let (first, last) = ends.map_or(("?", "?"), |(first, last)| (name(first), name(last)));
        let nodes = plan.blocks.blocks[group[0]].nodes.len();
        let _ = writeln!(
            text,
            "  {:>7} turns of {nodes} values, from `{first}` to `{last}`",
            group.len()
        );
    }
    text
}

fn of_function(kind: Kind, [bare, framed, pruned]: &[Chosen; 3]) -> String {
    let flops = |chosen: &Chosen| chosen.function.operations().flops();
    let mut text = format!(
        "\n{}: {} ({})\n",
        kind.name(),
        pruned.function.operations(),
        pruned.way
    );
    for (way, operations) in &pruned.tried {
        let _ = writeln!(text, "  {operations:>7}  by {way}");
    }
    let saved = |before: usize, after: usize, what: &str| {
        let share = 100.0 * (1.0 - after as f64 / before.max(1) as f64);
        format!("  {before:>7} → {after}: {what} saves {share:.1} %\n")
    };
    text += &saved(flops(bare), flops(framed), "moving frames");
    text += &saved(
        flops(framed),
        flops(pruned),
        "leaving out inertias that do not affect joints",
    );
    text
}
