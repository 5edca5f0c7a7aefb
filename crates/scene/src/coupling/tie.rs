//! Loops and couplings between bodies, as the graph of joints looks at them.

use super::forest::Ways;
use super::graph::{Law, Movement, Node, name};
use crate::description::{CouplingDescription, LoopDescription};
use crate::diagnostics::Diagnostic;
use crate::parse::no_ratio;
use crate::read::Sink;
use crate::source::Located;

/// What holds two bodies together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tie<'a> {
    pub(crate) name: &'a Located<String>,
    /// Predecessor and successor; `None` is the world, or what stands for it.
    pub(crate) ends: [Option<usize>; 2],
    /// Names of joints that are to move independently.
    pub(crate) independent: &'a [Located<String>],
    /// Ratio and offset of a coupling; `None` of a loop.
    pub(crate) law: Option<(f64, f64)>,
}

impl<'a> Tie<'a> {
    pub(crate) fn of_loop(tie: &'a LoopDescription) -> Self {
        Self {
            name: &tie.name,
            ends: tie.ends.map(|end| end.body),
            independent: &tie.independent,
            law: None,
        }
    }

    pub(crate) fn of_coupling(tie: &'a CouplingDescription) -> Self {
        Self {
            name: &tie.name,
            ends: tie.ends,
            independent: &tie.independent,
            law: Some((tie.ratio, tie.offset)),
        }
    }

    /// What messages call it.
    pub(super) fn called(&self) -> String {
        let kind = match self.law {
            None => "loop",
            Some(_) => "coupling",
        };
        format!("{kind} `{}`", self.name.value)
    }

    pub(super) fn refuse(&self, why: &str) -> Diagnostic {
        Diagnostic::new(self.name.span.clone(), format!("{}: {why}", self.called()))
    }
}

/// Makes laws of the couplings of two joints of which one follows none yet, the successor if the file does not say otherwise, and returns the places of all other ties. What moves otherwise than links can is an error.
pub(super) fn followed(
    nodes: &[Node<'_>],
    ties: &[Tie<'_>],
    ways: &[Ways],
    direct: &mut [Option<Law>],
    sink: &mut Sink,
) -> Vec<usize> {
    let mut open = Vec::new();
    for (place, (tie, ways)) in ties.iter().zip(ways).enumerate() {
        if let Some(error) = refusal(nodes, tie, ways) {
            sink.push(error);
            continue;
        }
        let law = match (tie.law, ways[0].as_slice(), ways[1].as_slice()) {
            (Some(law), &[first], &[second]) => {
                let forward = (first, second, law);
                let (ratio, offset) = law;
                let backward = (second, first, (1.0 / ratio, -offset / ratio));
                let leads = |node: usize| {
                    let mut named = tie.independent.iter();
                    named.any(|own| own.value == name(nodes, node))
                };
                let ways = match leads(second) && !leads(first) {
                    true => [backward, forward],
                    false => [forward, backward],
                };
                let mut free = ways.into_iter();
                free.find(|(_, own, _)| direct[*own].is_none())
            }
            _ => None,
        };
        match law {
            Some((leader, own, (ratio, offset))) => {
                direct[own] = Some(Law {
                    leader,
                    ratio,
                    offset,
                });
            }
            None => open.push(place),
        }
    }
    open
}

fn refusal(nodes: &[Node<'_>], tie: &Tie<'_>, ways: &Ways) -> Option<Diagnostic> {
    if let Some(error) = tie.law.and_then(|(ratio, _)| no_ratio(tie.name, ratio)) {
        return Some(error);
    }
    let [first, second] = ways.each_ref().map(|way| !way.is_empty());
    if tie.law.is_some() && !(first && second) {
        let end = if first { "successor" } else { "predecessor" };
        let why =
            format!("no joint moves on the way to its {end} from the last body that carries both");
        return Some(tie.refuse(&why));
    }
    if !(first || second) {
        return Some(tie.refuse("no joint moves between its ends"));
    }
    let mut all = ways.iter().flatten();
    let other = all.find_map(|node| match nodes[*node].movement {
        Movement::Other(kind) => Some((*node, kind)),
        _ => None,
    });
    if let Some((node, kind)) = other {
        let why = format!("joint `{}` of type `{kind}` moves in it", name(nodes, node));
        let help = "the joints of a loop or a coupling turn about an axis or slide along one; a ball in a loop is the joint that closes it";
        return Some(tie.refuse(&why).help(help));
    }
    let elastic = ways
        .iter()
        .flatten()
        .find_map(|node| Some((*node, nodes[*node].motor?)));
    elastic.map(|(node, motor)| {
        let why = format!(
            "joint `{}` in it is elastic: its coordinate is the deflection of the spring behind `{motor}`",
            name(nodes, node)
        );
        tie.refuse(&why)
    })
}
