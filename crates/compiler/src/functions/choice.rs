//! Which recursion computes a function, and what of it is left to loops: fewest operations where it is short, else the shortest code.

use super::least::least;
use super::ways::{PairedWay, Run};
use super::{Chosen, Kind, LONGEST, Loops};
use crate::alike::Plan;
use crate::emit::{Function, argument_size};
use crate::equations::{Paired, Tree};
use crate::graph::{Graph, Sym, Value, record, record_alike};
use crate::model::Model;
use crate::pairs::Tables;
use crate::prune::Link;

/// Operations of a function from which on like bodies are looped over, if that halves what is written.
///
/// Below, one body after the other is faster: looped forward dynamics of 3200 operations (anymal) took 1.33 times as long, of 7000 (eight ball joints)
/// 1.28 times and of 8700 (g1) 1.20 times.
const LOOPED: usize = 10_000;

/// Operations of a function from which on pairs of joints are left to loops.
///
/// Below, straight code is faster: derivatives of forward dynamics of anymal (17 900 operations) took 0.49 times as long as with loops, those of inverse
/// dynamics of g1 (22 900) 0.54 times, where limbs are side by side, and of eight ball joints (22 800) 1.06 times; and the Rust compiler took all in seconds.
pub(super) const PAIRED: usize = 30_000;

/// The same of M̄⁻¹, most of which is solving.
pub(super) const PAIRED_SOON: usize = 10_000;

/// A function with links that are known, however long, without packs.
pub(super) fn choose(model: &Model, links: &[Link], kind: Kind, loops: Loops) -> Chosen {
    let pairwise = kind.pairwise(model);
    if loops == Loops::Never || pairwise.is_empty() {
        return body_by_body(model, links, kind, loops);
    }
    let mut tried = vec![];
    if loops != Loops::Always && least(model, kind) <= LONGEST {
        let straight = body_by_body(model, links, kind, Loops::Never);
        if straight.function.operations().flops() < kind.paired() {
            return straight;
        }
        tried.extend(straight.tried);
    }
    let mut ways: Vec<(&'static str, Function)> = vec![];
    for &way in &pairwise {
        // What is solved in loops alone has all pairs written: for as long as that is short.
        if ways.is_empty() || !tried.is_empty() {
            ways.push((way.0, pair_by_pair(model, links, (kind, way), loops)));
        }
    }
    let flops = |function: &Function| function.operations().flops();
    tried.extend(ways.iter().map(|(name, function)| (*name, flops(function))));
    let is_short = |(_, function): &(&str, Function)| function.written() < LOOPED;
    let place = match loops {
        Loops::Always => 0,
        _ => ways.iter().rposition(is_short).unwrap_or(0),
    };
    let (way, function) = ways.swap_remove(place);
    Chosen {
        function,
        way,
        tried,
    }
}

/// A function that leaves pairs of joints to loops.
pub(super) fn pair_by_pair(
    model: &Model,
    links: &[Link],
    (kind, (_, way)): (Kind, PairedWay),
    loops: Loops,
) -> Function {
    let straight = paired(model, kind, record(|| numbers(model, links, way)));
    let whole = straight.written();
    if loops == Loops::Never || loops == Loops::Long && whole < LOOPED {
        return straight;
    }
    let mut alike = paired(model, kind, record_alike(|| numbers(model, links, way)));
    let plan = Plan::new(&alike.graph, &alike.outputs);
    match loops == Loops::Always || 2 * plan.written(&alike.graph) < whole {
        true => {
            alike.plan = Some(plan);
            alike
        }
        false => straight,
    }
}

/// What a way that leaves pairs of joints to loops finds for the bodies, with its tables.
pub(super) fn numbers(
    model: &Model,
    links: &[Link],
    way: fn(&Tree<'_>) -> Paired,
) -> (Vec<Value>, Tables) {
    let (numbers, tables) = way(&Tree::new(model, links.to_vec()));
    (numbers.into_iter().map(Sym::value).collect(), tables)
}

/// The function of such numbers.
fn paired(
    model: &Model,
    kind: Kind,
    ((outputs, tables), graph): ((Vec<Value>, Tables), Graph),
) -> Function {
    Function {
        pairs: Some(tables),
        ..function(model, kind, outputs, graph, None)
    }
}

/// A function without loops over pairs of joints.
fn body_by_body(model: &Model, links: &[Link], kind: Kind, loops: Loops) -> Chosen {
    let ways = kind.ways(model).into_iter();
    let straight = ways.map(|(name, way)| {
        let (outputs, graph) = record(|| run(model, links, way));
        (name, way, function(model, kind, outputs, graph, None))
    });
    let mut straight: Vec<(&'static str, Run, Function)> = straight.collect();
    let flops = |function: &Function| function.operations().flops();
    let tried = straight
        .iter()
        .map(|(name, _, function)| (*name, flops(function)))
        .collect();
    straight.sort_by_cached_key(|(.., function)| flops(function));
    let (name, way, function) = straight.swap_remove(0);
    let looped = looped(model, links, &function, (kind, way), loops);
    Chosen {
        function: looped.unwrap_or(function),
        way: name,
        tried,
    }
}

pub(super) fn run(model: &Model, links: &[Link], way: Run) -> Vec<Value> {
    let tree = Tree::new(model, links.to_vec());
    way(&tree).into_iter().map(Sym::value).collect()
}

/// The function with loops over like bodies, where these are wanted.
fn looped(
    model: &Model,
    links: &[Link],
    straight: &Function,
    (kind, way): (Kind, Run),
    loops: Loops,
) -> Option<Function> {
    let whole = straight.operations().flops();
    let never = !kind.has_like_parts() || loops == Loops::Never;
    if never || loops == Loops::Long && whole < LOOPED {
        return None;
    }
    let (outputs, graph) = record_alike(|| run(model, links, way));
    let plan = Plan::new(&graph, &outputs);
    let pays = loops == Loops::Always || 2 * plan.written(&graph) < whole;
    pays.then(|| function(model, kind, outputs, graph, Some(plan)))
}

fn function(
    model: &Model,
    kind: Kind,
    outputs: Vec<Value>,
    graph: Graph,
    plan: Option<Plan>,
) -> Function {
    let [configuration, freedoms, speeds] = model.sizes();
    let size = |argument| argument_size(argument, [configuration, freedoms, speeds]);
    let arguments = kind.arguments().iter();
    Function {
        name: kind.name(),
        summary: kind.summary().to_owned(),
        arguments: arguments
            .map(|&argument| (argument, size(argument)))
            .collect(),
        columns: kind.columns(model),
        graph,
        outputs,
        plan,
        packs: None,
        pairs: None,
    }
}
