//! For each mimic joint: its direct leader, and the leader at the end of the chain.

use super::graph::{Law, Node, name};
use crate::description::MimicDescription;
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::source::Located;
use hamel_runtime::shown::Number;
use std::collections::HashMap;

/// What each node follows itself; the nodes are the `elements`, a scene or a robot.
pub(super) fn direct(nodes: &[Node<'_>], elements: &str, sink: &mut Sink) -> Vec<Option<Law>> {
    let named = nodes.iter().enumerate();
    let named = named.filter_map(|(index, node)| Some((node.joint?.value.as_str(), index)));
    let places: HashMap<&str, usize> = named.collect();
    let known = nodes.iter().filter_map(|node| Some(&*node.joint?.value));
    let mut known: Vec<&str> = known.collect();
    // The bodies of a joint follow each other.
    known.dedup();
    let mut law = |index: usize, mimic: &Located<MimicDescription>| {
        let followed = &mimic.value.joint;
        let Some(&leader) = places.get(followed.value.as_str()) else {
            let (own, followed) = (name(nodes, index), &mimic.value.joint);
            let message = format!(
                "joint `{own}`: it mimics `{}`, which is no joint of the {elements}",
                followed.value
            );
            let error = Diagnostic::new(followed.span.clone(), message);
            sink.unknown(error, &followed.value, &known, "a joint is");
            return None;
        };
        match refusal(nodes, index, leader, mimic) {
            Some(error) => sink.push(error),
            None => {
                return Some(Law {
                    leader,
                    ratio: mimic.value.multiplier,
                    offset: mimic.value.offset,
                });
            }
        }
        None
    };
    let all = nodes.iter().enumerate();
    all.map(|(index, node)| law(index, node.mimic?)).collect()
}

/// Why a node cannot follow another.
fn refusal(
    nodes: &[Node<'_>],
    index: usize,
    leader: usize,
    mimic: &Located<MimicDescription>,
) -> Option<Diagnostic> {
    let (own, followed) = (name(nodes, index), &mimic.value.joint);
    if mimic.value.multiplier == 0.0 {
        let message =
            format!("joint `{own}`: the `multiplier` of its mimic is 0: it would stand still");
        let error = Diagnostic::new(mimic.span.clone(), message);
        return Some(error.help("leave the joint out, and fix the body to its parent"));
    }
    let other = &followed.value;
    let kinds = [index, leader].map(|node| nodes[node].movement.other());
    let why = match (kinds, nodes[leader].motor) {
        _ if leader == index => String::from("itself"),
        ([Some(kind), _], _) => format!("`{other}`, and is of type `{kind}`"),
        ([_, Some(kind)], _) => format!("`{other}`, which is of type `{kind}`"),
        (_, Some(motor)) => format!(
            "`{other}`, which is elastic: its coordinate is the deflection of the spring behind `{motor}`"
        ),
        _ => return None,
    };
    let error = Diagnostic::new(
        followed.span.clone(),
        format!("joint `{own}`: it mimics {why}"),
    );
    Some(error.help(
        "what mimics, and what is mimicked, is another joint that turns about an axis or slides along one",
    ))
}

/// What each node follows in the end: of what follows none itself. Circles are errors.
pub(super) fn composed(nodes: &[Node<'_>], direct: &[Option<Law>], sink: &mut Sink) -> Vec<Law> {
    let own = |leader: usize| Law {
        leader,
        ratio: 1.0,
        offset: 0.0,
    };
    let mut laws: Vec<Option<Law>> = vec![None; direct.len()];
    for start in 0..direct.len() {
        let (mut path, mut at) = (Vec::new(), start);
        let mut on_path = HashMap::new();
        while let (None, Some(law)) = (laws[at], direct[at]) {
            if let Some(&entry) = on_path.get(&at) {
                sink.push(circle(nodes, &path[entry..]));
                break;
            }
            on_path.insert(at, path.len());
            path.push(at);
            at = law.leader;
        }
        let mut last = *laws[at].get_or_insert(own(at));
        for &node in path.iter().rev() {
            let Some(law) = direct[node] else { continue };
            last = Law {
                leader: last.leader,
                ratio: law.ratio * last.ratio,
                offset: law.ratio * last.offset + law.offset,
            };
            if !(last.ratio.is_finite() && last.offset.is_finite() && last.ratio != 0.0) {
                sink.push(out_of_range(nodes, node, &last));
                last = own(node);
            }
            laws[node] = Some(last);
        }
    }
    let laws = laws.into_iter().enumerate();
    laws.map(|(node, law)| law.unwrap_or_else(|| own(node)))
        .collect()
}

fn circle(nodes: &[Node<'_>], path: &[usize]) -> Diagnostic {
    let names = path.iter().chain(path.first()).take(13);
    let names: Vec<String> = names
        .map(|&node| format!("`{}`", name(nodes, node)))
        .collect();
    let message = format!("joints mimic each other in a circle: {}", names.join(" → "));
    let first = path.first().and_then(|&node| nodes[node].mimic);
    let joint = path.first().and_then(|&node| nodes[node].joint);
    let span = first.map(|mimic| mimic.value.joint.span.clone());
    let span = span.or_else(|| joint.map(|joint| joint.span.clone()));
    Diagnostic::new(span.unwrap_or(0..0), message).help("one of them must mimic none")
}

fn out_of_range(nodes: &[Node<'_>], node: usize, law: &Law) -> Diagnostic {
    let (own, leader) = (name(nodes, node), name(nodes, law.leader));
    let message = format!(
        "joint `{own}`: in the end it follows `{leader}` by the multiplier {:?} and the offset {:?}: both must be finite, and the multiplier not 0",
        Number(law.ratio),
        Number(law.offset)
    );
    let joint = nodes[node].joint.map(|joint| joint.span.clone());
    let span = nodes[node].mimic.map(|mimic| mimic.span.clone());
    Diagnostic::new(span.or(joint).unwrap_or(0..0), message)
}
