//! `<loop>` and `<coupling>` of URDF+ (arXiv 2411.19753): what closes loops, and what makes sums of joint positions proportional.
//!
//! A loop is closed by a joint between a frame of the predecessor and one of the successor, its axis read in both. A coupling says `Σ q = ratio · Σ q`, of the joints on the way to the successor
//! and to the predecessor, from the last link that carries both. `independent` of a joint names those whose positions are the coordinates.

use super::document::{attribute, number, place, vector};
use super::joint;
use super::robot::Robot;
use super::tree::name_span;
use crate::coupling::Tie;
use crate::description::{Closing, CouplingDescription, LoopDescription, LoopEnd};
use crate::diagnostics::Diagnostic;
use crate::parse::rotation;
use crate::read::Sink;
use crate::source::Located;
use crate::suggest::{all_of, nearest};
use hamel_runtime::spatial::Pose;
use nalgebra::Vector3;
use roxmltree::Node;
use std::collections::HashMap;

/// Types of the joints that close loops: those of URDF+, and a ball.
pub(super) struct ClosingType;

impl ClosingType {
    pub(super) const NAMES: [&'static str; 6] = [
        "revolute",
        "continuous",
        "prismatic",
        "planar",
        "spherical",
        "fixed",
    ];

    fn of(name: &str) -> Option<Closing> {
        match name {
            "continuous" => Some(Closing::Revolute),
            name => Closing::of(name),
        }
    }
}

/// Loops, then couplings, with the links that they hold by index.
pub(super) struct Ties<'a, 'i> {
    loops: Vec<Read<'a, 'i, LoopDescription>>,
    couplings: Vec<Read<'a, 'i, CouplingDescription>>,
}

struct Read<'a, 'i, D> {
    node: Node<'a, 'i>,
    ends: [usize; 2],
    tie: D,
}

/// Reads what the robot has; `parents` are joint and parent link of each link. `None` where there is an error, which is noted.
pub(super) fn ties<'a, 'i>(
    robot: &Robot<'a, 'i>,
    names: &HashMap<&str, usize>,
    parents: &[Option<(usize, usize)>],
    sink: &mut Sink,
) -> Option<Ties<'a, 'i>> {
    let errors_before = sink.len();
    let mut ends = |node: Node<'a, 'i>| {
        let ends = ["predecessor", "successor"].map(|end| found(robot, names, node, end, sink));
        let [Some(first), Some(second)] = ends else {
            return None;
        };
        Some([first, second])
    };
    let loops = robot.loops.iter().filter_map(|&node| {
        let ends = ends(node)?;
        let tie = LoopDescription {
            name: name(node)?,
            closing: ClosingType::of(node.attribute("type")?)?,
            ends: [LoopEnd {
                body: None,
                at: Pose::identity(),
            }; 2],
            independent: independent(robot, parents, ends),
        };
        Some(Read { node, ends, tie })
    });
    let loops: Vec<_> = loops.collect();
    let couplings = robot.couplings.iter().filter_map(|&node| {
        let ends = ends(node)?;
        let tie = CouplingDescription {
            name: name(node)?,
            ends: [None; 2],
            ratio: number(node, "ratio", "value")?,
            offset: 0.0,
            independent: independent(robot, parents, ends),
        };
        Some(Read { node, ends, tie })
    });
    let couplings: Vec<_> = couplings.collect();
    (sink.len() == errors_before).then_some(Ties { loops, couplings })
}

fn name(node: Node<'_, '_>) -> Option<Located<String>> {
    let name = node.attribute("name")?.to_owned();
    Some(Located::new(name, name_span(node)))
}

fn found(
    robot: &Robot<'_, '_>,
    names: &HashMap<&str, usize>,
    node: Node<'_, '_>,
    end: &str,
    sink: &mut Sink,
) -> Option<usize> {
    let link = attribute(node, end, "link")?;
    if let Some(&found) = names.get(link) {
        return Some(found);
    }
    let (kind, name) = (node.tag_name().name(), node.attribute("name").unwrap_or(""));
    let message = format!("{kind} `{name}`: its {end} `{link}` is not a link of the robot");
    let error = Diagnostic::new(place(node, end, "link"), message);
    let known = || robot.links.iter().map(|link| link.name);
    sink.push(match nearest(link, known()) {
        Some(near) => error.label(format!("did you mean `{near}`?")),
        None => error.help(format!("its links are {}", all_of(known()))),
    });
    None
}

/// Whether the file calls a joint independent.
fn is_independent(robot: &Robot<'_, '_>, joint: usize) -> bool {
    let told = robot.joints[joint].node.attribute("independent");
    told.is_some_and(|told| told.eq_ignore_ascii_case("true"))
}

/// The joints on the ways to both ends that the file calls independent, in the order of the file.
fn independent(
    robot: &Robot<'_, '_>,
    parents: &[Option<(usize, usize)>],
    ends: [usize; 2],
) -> Vec<Located<String>> {
    let [first, second] = ends.map(|end| {
        let mut joints = Vec::new();
        let mut at = end;
        while let Some((joint, parent)) = parents[at] {
            joints.push(joint);
            at = parent;
        }
        joints
    });
    let own = first.iter().filter(|joint| !second.contains(joint));
    let other = second.iter().filter(|joint| !first.contains(joint));
    let mut all: Vec<usize> = own.chain(other).copied().collect();
    all.retain(|&joint| is_independent(robot, joint));
    all.sort_unstable();
    let named = all.into_iter().map(|joint| {
        let joint = &robot.joints[joint];
        Located::new(joint.name.to_owned(), name_span(joint.node))
    });
    named.collect()
}

impl Ties<'_, '_> {
    /// The elements, with what messages call their kinds.
    pub(super) fn nodes(&self) -> impl Iterator<Item = Node<'_, '_>> {
        let loops = self.loops.iter().map(|own| own.node);
        loops.chain(self.couplings.iter().map(|own| own.node))
    }

    /// As couplings look at them: ends are the links that move the bodies of theirs, which `body` tells.
    pub(super) fn of_links(&self, body: impl Fn(usize) -> usize) -> Vec<Tie<'_>> {
        let ends = |ends: [usize; 2]| ends.map(|link| Some(body(link)));
        let loops = self.loops.iter().map(|own| Tie {
            ends: ends(own.ends),
            ..Tie::of_loop(&own.tie)
        });
        let couplings = self.couplings.iter().map(|own| Tie {
            ends: ends(own.ends),
            ..Tie::of_coupling(&own.tie)
        });
        loops.chain(couplings).collect()
    }

    /// Both lists with bodies in place of links, where `anchor` says on which body a link is, and its pose there.
    pub(super) fn placed(
        self,
        version: (u32, u32),
        anchor: impl Fn(usize) -> Option<(Option<usize>, Pose<f64>)>,
        sink: &mut Sink,
    ) -> (Vec<LoopDescription>, Vec<CouplingDescription>) {
        let mut loops = Vec::new();
        for own in self.loops {
            let mut tie = own.tie;
            let owner = format!("loop `{}`", tie.name.value);
            let axis = axis(&owner, own.node, tie.closing, sink).unwrap_or_else(Pose::identity);
            for ((end, key), link) in ["predecessor", "successor"]
                .into_iter()
                .enumerate()
                .zip(own.ends)
            {
                let node = super::document::child(own.node, key);
                let origin = node.and_then(|node| {
                    let owner = format!("{owner}: {key}");
                    joint::origin(&owner, node, version, sink)
                });
                let (body, pose) = anchor(link).unwrap_or((None, Pose::identity()));
                let at = pose * origin.unwrap_or_else(Pose::identity) * axis;
                tie.ends[end] = LoopEnd { body, at };
            }
            loops.push(tie);
        }
        let couplings = self.couplings.into_iter().map(|own| CouplingDescription {
            ends: own.ends.map(|link| anchor(link).and_then(|(body, _)| body)),
            ..own.tie
        });
        (loops, couplings.collect())
    }
}

/// The rotation that turns z onto the axis of a loop.
fn axis(owner: &str, node: Node<'_, '_>, closing: Closing, sink: &mut Sink) -> Option<Pose<f64>> {
    if matches!(closing, Closing::Spherical | Closing::Fixed) {
        return Some(Pose::identity());
    }
    // The default of URDF.
    let axis = vector(node, "axis", "xyz").map_or(Vector3::x(), Vector3::from);
    let axis = Located::new(axis, place(node, "axis", "xyz"));
    let turned = rotation::from_axis(&format!("{owner}: its axis"), axis, sink);
    turned.map(Pose::from_rotation)
}
