//! Where the frames of a file stand: each in another one, and on what it is fixed.

use super::content::{Content, Kind, WORLD};
use super::document::{attribute_node, child, pose};
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use hamel_runtime::spatial::Pose;

/// The frames of all entities, at home.
#[derive(Debug)]
pub(super) struct Poses {
    /// The entity in whose frame each stands, and its pose there; of the world its own.
    bases: Vec<(usize, Pose<f64>)>,
    /// How many frames each stands in, one in the other.
    depths: Vec<usize>,
    /// The link that each is fixed to; the world where it is to that.
    links: Vec<usize>,
}

impl Poses {
    /// Those of what a file holds; names that are not there, and frames that stand in themselves, are errors.
    pub(super) fn read(content: &Content<'_, '_>, sink: &mut Sink) -> Option<Self> {
        let errors = sink.len();
        let count = content.entities.len();
        let held = (0..count).map(|own| holder(content, own, sink).unwrap_or(WORLD));
        let held: Vec<usize> = held.collect();
        let bases = (0..count).map(|own| {
            let base = content.base_of_pose(own, content.entities[own].node, sink);
            let base = base.unwrap_or_else(|| default_base(content, own, &held));
            let said = pose(&content.called(own), content.entities[own].node, sink);
            (base, said.unwrap_or_else(Pose::identity))
        });
        let bases: Vec<(usize, Pose<f64>)> = bases.collect();
        let bases_alone: Vec<usize> = bases.iter().map(|(base, _)| *base).collect();
        let holds = |own: usize| matches!(content.entities[own].kind, Kind::World | Kind::Link);
        refuse_cycles(content, &held, holds, ("frames", "attached_to"), sink);
        // What goes round there does so here.
        if sink.len() == errors {
            let is_world = |own: usize| own == WORLD;
            refuse_cycles(
                content,
                &bases_alone,
                is_world,
                ("poses", "relative_to"),
                sink,
            );
        }
        (sink.len() == errors).then(|| Self {
            links: (0..count).map(|own| end(&held, own)).collect(),
            depths: depths(&bases_alone),
            bases,
        })
    }

    /// The link that the frame of an entity is fixed to; `None` is the world.
    pub(super) fn link(&self, entity: usize) -> Option<usize> {
        Some(self.links[entity]).filter(|link| *link != WORLD)
    }

    /// The pose of a frame in another one, at home. Where one stands in the other as the file says, it is that to the bit.
    pub(super) fn of(&self, frame: usize, other: usize) -> Pose<f64> {
        let mut ways = [frame, other].map(|at| (at, Pose::identity()));
        while ways[0].0 != ways[1].0 {
            let deeper = usize::from(self.depths[ways[0].0] < self.depths[ways[1].0]);
            let (at, pose) = ways[deeper];
            let (base, own) = self.bases[at];
            ways[deeper] = (base, own * pose);
        }
        let [(_, pose), (common, of_other)] = ways;
        match common == other {
            true => pose,
            false => of_other.inverse() * pose,
        }
    }
}

/// How many steps it takes from each to the world, where no way leads back.
fn depths(bases: &[usize]) -> Vec<usize> {
    let mut depths: Vec<Option<usize>> = vec![None; bases.len()];
    depths[WORLD] = Some(0);
    for start in 0..bases.len() {
        let (mut at, mut way) = (start, Vec::new());
        while depths[at].is_none() {
            way.push(at);
            at = bases[at];
        }
        let above = depths[at].unwrap_or(0);
        for (steps, own) in way.into_iter().rev().enumerate() {
            depths[own] = Some(above + steps + 1);
        }
    }
    depths.into_iter().map(Option::unwrap_or_default).collect()
}

/// What the frame of an entity is fixed to: the world and links are that themselves.
fn holder(content: &Content<'_, '_>, own: usize, sink: &mut Sink) -> Option<usize> {
    let entity = &content.entities[own];
    match entity.kind {
        Kind::World => Some(WORLD),
        Kind::Link if entity.is_static => Some(WORLD),
        Kind::Link => Some(own),
        Kind::Joint => content.named_in(own, "child", sink),
        Kind::Frame => Some(content.attached(own, sink).unwrap_or(entity.model)),
        Kind::Model if entity.is_static => Some(WORLD),
        Kind::Model => content.canonical(own, sink),
    }
}

/// The frame in which one stands whose `<pose>` does not say it: that of its model; of a joint that of its child, of a frame what it is fixed to.
fn default_base(content: &Content<'_, '_>, own: usize, held: &[usize]) -> usize {
    let entity = &content.entities[own];
    match entity.kind {
        Kind::World => WORLD,
        Kind::Joint | Kind::Frame => held[own],
        Kind::Link | Kind::Model => entity.model,
    }
}

/// What the way from an entity leads to.
fn end(held: &[usize], mut own: usize) -> usize {
    while held[own] != own {
        own = held[own];
    }
    own
}

/// Refuses ways that lead back to where they began, except for those that end at what `rests`.
fn refuse_cycles(
    content: &Content<'_, '_>,
    next: &[usize],
    rests: impl Fn(usize) -> bool,
    (what, attribute): (&str, &str),
    sink: &mut Sink,
) {
    // From which start each was seen, counted from 1.
    let mut seen = vec![0; next.len()];
    for start in 0..next.len() {
        let (mut at, mut way) = (start, Vec::new());
        while seen[at] == 0 {
            seen[at] = start + 1;
            way.push(at);
            at = next[at];
        }
        // What was seen before has been judged before.
        if seen[at] != start + 1 || rests(at) {
            continue;
        }
        const MOST_SHOWN: usize = 12;
        let cycle: Vec<usize> = way.into_iter().skip_while(|own| *own != at).collect();
        let shown = cycle.iter().take(MOST_SHOWN);
        let mut names: Vec<String> = shown.map(|own| content.called(*own)).collect();
        if cycle.len() > MOST_SHOWN {
            names.push(format!("({} more)", cycle.len() - MOST_SHOWN));
        }
        names.push(content.called(at));
        let message = format!("{what} go round in a cycle: {}", names.join(" → "));
        let node = content.entities[at].node;
        let place = child(node, "pose").and_then(|pose| attribute_node(pose, attribute));
        let place = place.or(attribute_node(node, attribute));
        let span = place.map_or_else(|| content.span(at), |found| found.range_value());
        sink.push(Diagnostic::new(span, message));
    }
}
