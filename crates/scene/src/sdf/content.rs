//! What a file holds: its models with their links, joints and frames, by their names.

use super::Version;
use super::document::{
    attribute, attribute_node, child, children, flag, is_of_sdf, name_span, place, text_span, value,
};
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::robot::xml::tag;
use crate::source::Span;
use crate::suggest::nearest;
use crate::text::visible_line;
use roxmltree::Node;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

/// The place of the world among the entities.
pub(super) const WORLD: usize = 0;

/// Something with a frame.
#[derive(Clone, Debug)]
pub(super) struct Entity<'a, 'i> {
    /// What it is.
    pub(super) kind: Kind,
    /// Its element; that of the whole for the world.
    pub(super) node: Node<'a, 'i>,
    /// Its name with those of the models that it is in.
    pub(super) name: String,
    /// The model that it is in; the world itself is in the world.
    pub(super) model: usize,
    /// Whether its model, or one around that, does not move.
    pub(super) is_static: bool,
}

/// What an entity is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The world.
    World,
    /// A model.
    Model,
    /// A link.
    Link,
    /// A joint.
    Joint,
    /// A frame.
    Frame,
}

/// What a file holds.
#[derive(Debug)]
pub(super) struct Content<'a, 'i> {
    /// The world, then all others in the order of the file.
    pub(super) entities: Vec<Entity<'a, 'i>>,
    /// Their places by their names.
    names: HashMap<String, usize>,
    /// What names begin with where all is in one model.
    prefix: String,
    /// The names of what the second axes of joints become.
    second: HashMap<usize, String>,
    /// The version of SDF.
    pub(super) version: Version,
}

impl<'a, 'i> Content<'a, 'i> {
    /// What the element holds: a world, or the whole with one model.
    pub(super) fn read(top: Node<'a, 'i>, version: Version, sink: &mut Sink) -> Self {
        let models: Vec<Node<'_, '_>> = children(top, "model").collect();
        let has_own = child(top, "joint").or(child(top, "frame")).is_some();
        let prefix = match models.as_slice() {
            // Names beside a model may be those of what is in it.
            [only] if !has_own => format!("{}::", attribute(*only, "name").unwrap_or_default()),
            _ => String::new(),
        };
        let world = Entity {
            kind: Kind::World,
            node: top,
            name: String::new(),
            model: WORLD,
            is_static: false,
        };
        let mut content = Self {
            entities: vec![world],
            names: HashMap::new(),
            prefix,
            second: HashMap::new(),
            version,
        };
        let mut open = vec![WORLD];
        while let Some(model) = open.pop() {
            let before = content.entities.len();
            content.fill(model, sink);
            let inner = before..content.entities.len();
            let models = inner.filter(|&place| content.entities[place].kind == Kind::Model);
            open.extend(models.rev().collect::<Vec<_>>());
        }
        content.name_second_axes();
        content
    }

    /// Names for what the second axes of joints become, which nothing else has.
    fn name_second_axes(&mut self) {
        let all = 0..self.entities.len();
        let mut taken: HashSet<String> = all.map(|own| self.shown(own).to_owned()).collect();
        let joints: Vec<usize> = self.of(Kind::Joint).collect();
        for joint in joints {
            if child(self.entities[joint].node, "axis2").is_none() {
                continue;
            }
            let mut name = format!("{}_2", self.shown(joint));
            while !taken.insert(name.clone()) {
                name.push('_');
            }
            self.second.insert(joint, name);
        }
    }

    /// The name of what an axis of a joint becomes.
    pub(super) fn axis_name(&self, joint: usize, axis: &str) -> &str {
        let second = self.second.get(&joint).filter(|_| axis == "axis2");
        second.map_or_else(|| self.shown(joint), String::as_str)
    }

    /// All names that are given.
    pub(super) fn all_names(&self) -> HashSet<String> {
        let all = 0..self.entities.len();
        let names = all.map(|own| self.shown(own).to_owned());
        names.chain(self.second.values().cloned()).collect()
    }

    /// Adds what stands in a model.
    fn fill(&mut self, model: usize, sink: &mut Sink) {
        let (node, is_static) = (self.entities[model].node, self.entities[model].is_static);
        let scope = self.scope(model);
        for child in node.children().filter(|child| is_of_sdf(*child)) {
            let kind = match child.tag_name().name() {
                "model" => Kind::Model,
                "link" if model != WORLD => Kind::Link,
                "joint" => Kind::Joint,
                "frame" => Kind::Frame,
                _ => continue,
            };
            let Some(own) = attribute(child, "name") else {
                continue;
            };
            if own == "world" || own.starts_with("__") && own.ends_with("__") {
                let message = format!(
                    "`{}` is a name that SDF keeps for itself",
                    visible_line(own)
                );
                sink.push(Diagnostic::new(name_span(child), message));
                continue;
            }
            let name = format!("{scope}{own}");
            let place = self.entities.len();
            match self.names.entry(name.clone()) {
                Entry::Vacant(free) => _ = free.insert(place),
                Entry::Occupied(taken) => {
                    let first = self.entities[*taken.get()].node;
                    let message = format!("two elements are called `{}`", visible_line(own));
                    let error = Diagnostic::new(name_span(child), message).label("the second one");
                    sink.push(
                        error.context(name_span(first), "the first one").help(
                            "the links, joints, frames and models of a model share their names",
                        ),
                    );
                    continue;
                }
            }
            self.entities.push(Entity {
                kind,
                node: child,
                name,
                model,
                is_static: is_static || kind == Kind::Model && flag(child, "static") == Some(true),
            });
        }
    }

    /// What the names in a model begin with.
    fn scope(&self, model: usize) -> String {
        match model {
            WORLD => String::new(),
            model => format!("{}::", self.entities[model].name),
        }
    }

    /// The name of an entity as scenes have it: without that of the only model.
    pub(super) fn shown(&self, entity: usize) -> &str {
        let name = &self.entities[entity].name;
        name.strip_prefix(&self.prefix).unwrap_or(name)
    }

    /// What messages call an entity.
    pub(super) fn called(&self, entity: usize) -> String {
        let kind = match self.entities[entity].kind {
            Kind::World => return "the world".to_owned(),
            Kind::Model => "model",
            Kind::Link => "link",
            Kind::Joint => "joint",
            Kind::Frame => "frame",
        };
        format!("{kind} `{}`", self.shown(entity))
    }

    /// The entities of a kind.
    pub(super) fn of(&self, kind: Kind) -> impl Iterator<Item = usize> {
        let all = self.entities.iter().enumerate();
        all.filter(move |(_, own)| own.kind == kind)
            .map(|(place, _)| place)
    }

    /// The entity that is called `name` in a model; an error at `at`, in words that begin with `what`, where there is none.
    pub(super) fn find(
        &self,
        name: &str,
        model: usize,
        (what, at): (&str, Span),
        sink: &mut Sink,
    ) -> Option<usize> {
        match name {
            "__model__" => return Some(model),
            "world" => return Some(WORLD),
            _ => {}
        }
        let scope = self.scope(model);
        // The frame of a model is told as the model itself.
        let own = name.strip_suffix("::__model__").unwrap_or(name);
        let found = self.names.get(&format!("{scope}{own}"));
        let is_model = |found: &&usize| self.entities[**found].kind == Kind::Model;
        if let Some(&found) = found.filter(|found| own == name || is_model(found)) {
            return Some(found);
        }
        let message = format!("{what} `{}`, which is not there", visible_line(name));
        let error = Diagnostic::new(at, message);
        let mut known: Vec<&str> = self
            .names
            .keys()
            .filter_map(|known| known.strip_prefix(&*scope))
            .collect();
        known.sort_unstable();
        sink.push(match nearest(name, known.iter().copied()) {
            Some(near) => error.label(format!("did you mean `{near}`?")),
            None => error.help("names are those of links, joints, frames and models beside it, or of what is in these, as `model::link`"),
        });
        None
    }

    /// The entity that the text of a child element names.
    pub(super) fn named_in(&self, entity: usize, element: &str, sink: &mut Sink) -> Option<usize> {
        let own = &self.entities[entity];
        let name = value(own.node, element)?;
        let what = format!("{}: its {element} is", self.called(entity));
        self.find(name, own.model, (&what, place(own.node, element)), sink)
    }

    /// The entity in whose frame the `<pose>` inside `node` stands, which belongs to `entity`; `None` where that does not say it. Until SDF 1.6 `frame` says it.
    pub(super) fn base_of_pose(
        &self,
        entity: usize,
        node: Node<'_, '_>,
        sink: &mut Sink,
    ) -> Option<usize> {
        let pose = child(node, "pose")?;
        let of_old = || attribute_node(pose, "frame").filter(|_| self.version < (1, 7));
        let found = attribute_node(pose, "relative_to").or_else(of_old)?;
        if found.value().is_empty() {
            return None;
        }
        let what = format!("{}: its <pose> is relative to", self.called(entity));
        // The pose of a model is told in what it is in.
        let model = self.entities[entity].model;
        self.find(found.value(), model, (&what, found.range_value()), sink)
    }

    /// What a frame says that it is attached to.
    pub(super) fn attached(&self, frame: usize, sink: &mut Sink) -> Option<usize> {
        let own = &self.entities[frame];
        let what = format!("{}: it is attached to", self.called(frame));
        let found = attribute_node(own.node, "attached_to")?;
        let is_said = !found.value().is_empty();
        is_said.then(|| self.find(found.value(), own.model, (&what, found.range_value()), sink))?
    }

    /// The link that a model's frame is fixed to: the one that it names, or its first, or that of the first model in it; the world where it has none.
    pub(super) fn canonical(&self, model: usize, sink: &mut Sink) -> Option<usize> {
        let said = attribute_node(self.entities[model].node, "canonical_link");
        if let Some(said) = said.filter(|said| !said.value().is_empty()) {
            let what = format!("{}: its canonical link is", self.called(model));
            let link = self.find(said.value(), model, (&what, said.range_value()), sink)?;
            if self.entities[link].kind != Kind::Link {
                let message = format!("{what} {}", self.called(link));
                sink.push(Diagnostic::new(said.range_value(), message));
            }
            return Some(link);
        }
        let first = |kind: Kind| self.of(kind).find(|&own| self.entities[own].model == model);
        // What is wrong in a model within is told of that.
        first(Kind::Link).or_else(|| self.canonical(first(Kind::Model)?, &mut Sink::default()))
    }

    /// Where an entity stands in the file.
    pub(super) fn span(&self, entity: usize) -> Span {
        name_span(self.entities[entity].node)
    }

    /// Where a child element of an entity stands.
    pub(super) fn place(&self, entity: usize, element: &str) -> Span {
        let node = self.entities[entity].node;
        child(node, element).map_or_else(|| tag(node), text_span)
    }
}
