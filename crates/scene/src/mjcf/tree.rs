//! Bodies with what stands in them: the tree under `<worldbody>`, its frames resolved.

use super::assets::Assets;
use super::defaults::{Defaults, MAIN};
use super::element::{Element, Lines, label};
use super::geom::Geom;
use super::joint::{Joint, Movement};
use super::placement;
use super::settings::Settings;
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::parse::WORLD;
use crate::read::Sink;
use crate::robot::xml::tag;
use crate::source::Located;
use hamel_runtime::spatial::Pose;
use roxmltree::Node;
use std::collections::HashMap;

/// A body.
#[derive(Debug)]
pub(super) struct Body<'a> {
    /// What messages call it.
    pub(super) owner: String,
    /// Its name, if it has one.
    pub(super) name: Option<Located<String>>,
    /// Its element; none of the world.
    pub(super) node: Option<Node<'a, 'a>>,
    /// The place of the body that it hangs on.
    pub(super) parent: Option<usize>,
    /// Its frame in that of its parent, where its joints are at their references.
    pub(super) pose: Pose<f64>,
    /// Its `<inertial>`.
    pub(super) inertial: Option<Element<'a>>,
    /// Its geoms.
    pub(super) geoms: Vec<Geom>,
    /// Its joints in their order.
    pub(super) joints: Vec<Joint<'a>>,
    /// Its sites, by name and pose.
    pub(super) sites: Vec<(Located<String>, Pose<f64>)>,
    /// The part of its weight that is taken off.
    pub(super) gravcomp: f64,
}

/// What is still to be read: an element, the body that it stands in, its frame there, and the class of its defaults.
#[derive(Clone, Copy)]
struct Open<'a> {
    node: Node<'a, 'a>,
    body: usize,
    frame: Pose<f64>,
    class: usize,
}

/// What the tree is read with.
pub(super) struct Reader<'r, 'a> {
    pub(super) settings: &'r Settings,
    pub(super) defaults: &'r Defaults<'a>,
    pub(super) lines: &'r Lines,
    assets: &'r Assets,
    pub(super) notices: &'r mut Notices,
    pub(super) sink: &'r mut Sink,
    bodies: Vec<Body<'a>>,
    /// The elements that have names, by kind and name.
    names: HashMap<(&'static str, &'a str), Node<'a, 'a>>,
}

impl<'r, 'a> Reader<'r, 'a> {
    /// A reader with what it reads by.
    pub(super) fn new(
        (settings, defaults, lines, assets): (
            &'r Settings,
            &'r Defaults<'a>,
            &'r Lines,
            &'r Assets,
        ),
        notices: &'r mut Notices,
        sink: &'r mut Sink,
    ) -> Self {
        Self {
            settings,
            defaults,
            lines,
            assets,
            notices,
            sink,
            bodies: Vec::new(),
            names: HashMap::new(),
        }
    }

    /// The bodies of the document of that root, parents first and in the order of the file; the world is the first.
    pub(super) fn bodies(mut self, root: Node<'a, 'a>) -> Vec<Body<'a>> {
        self.bodies.push(Body::new(None, None, WORLD.to_owned()));
        let worlds = root
            .children()
            .filter(|node| node.has_tag_name("worldbody"));
        let mut open: Vec<Open<'a>> = Vec::new();
        for node in worlds {
            let world = Open {
                node,
                body: 0,
                frame: Pose::identity(),
                class: MAIN,
            };
            self.push(world, &mut open);
            while let Some(own) = open.pop() {
                self.element(own, &mut open);
            }
        }
        for place in 1..self.bodies.len() {
            self.check(place);
        }
        self.bodies
    }

    /// Opens what stands in an element, the first on top.
    fn push(&self, own: Open<'a>, open: &mut Vec<Open<'a>>) {
        let children = own.node.children().rev().filter(Node::is_element);
        open.extend(children.map(|node| Open { node, ..own }));
    }

    fn element(&mut self, own: Open<'a>, open: &mut Vec<Open<'a>>) {
        match own.node.tag_name().name() {
            "body" => self.body(own, open),
            "frame" => {
                let class = self
                    .defaults
                    .named(own.node, "childclass", own.class, self.sink);
                let pose = self.pose(own.node);
                let frame = own.frame * pose;
                self.push(
                    Open {
                        frame,
                        class,
                        ..own
                    },
                    open,
                );
            }
            "inertial" if self.is_moving(own) => {
                self.bodies[own.body].inertial = Some(Element::plain(own.node));
            }
            "joint" | "freejoint" if self.is_moving(own) => self.joint(own),
            "geom" => self.geom(own),
            "site" => self.site(own),
            "plugin" => self.leave_out("plugins are not simulated", own.node),
            // Cameras and lights are no part of the mechanism.
            _ => {}
        }
    }

    fn pose(&mut self, node: Node<'a, 'a>) -> Pose<f64> {
        let owner = label(node, self.lines);
        let pose = placement::pose(&owner, &Element::plain(node), self.settings, self.sink);
        pose.unwrap_or_else(Pose::identity)
    }

    fn leave_out(&mut self, message: &str, node: Node<'a, 'a>) {
        let line = self.lines.of(node.range().start);
        let element = format!("<{}> in line {line}", node.tag_name().name());
        self.notices.warn(message, element);
    }

    /// Whether an element stands in a body rather than in the world, where it may not.
    fn is_moving(&mut self, own: Open<'a>) -> bool {
        if own.body == 0 {
            let message = format!(
                "<{}> stands in <worldbody>, which does not move",
                own.node.tag_name().name()
            );
            let error = Diagnostic::new(tag(own.node), message);
            self.sink.push(error.help("put it into a <body>"));
        }
        own.body != 0
    }

    /// Notes a name, which no other element of its kind may have.
    fn register(&mut self, kind: &'static str, node: Node<'a, 'a>) {
        let Some(name) = node.attribute("name") else {
            return;
        };
        let Some(first) = self.names.insert((kind, name), node) else {
            return;
        };
        let message = format!("two {kind} are called `{name}`");
        let span = |node: Node<'_, '_>| Element::plain(node).span("name");
        let error = Diagnostic::new(span(node), message).label("the second one");
        self.sink.push(error.context(span(first), "the first one"));
    }

    fn body(&mut self, own: Open<'a>, open: &mut Vec<Open<'a>>) {
        self.register("bodies", own.node);
        let owner = label(own.node, self.lines);
        let class = self
            .defaults
            .named(own.node, "childclass", own.class, self.sink);
        let element = Element::plain(own.node);
        let mut body = Body::new(Some(own.node), Some(own.body), owner);
        body.name = element.name();
        if let Some(name) = body.name.as_ref().filter(|name| name.value == WORLD) {
            let message = format!("a body is called `{WORLD}`, which is the inertial frame");
            self.sink.push(Diagnostic::new(name.span.clone(), message));
        }
        let pose = self.pose(own.node);
        body.pose = own.frame * pose;
        body.gravcomp = element.number("gravcomp").unwrap_or(0.0);
        if element.switch("mocap") == Some(true) {
            self.leave_out("bodies that a user moves (mocap) stand still", own.node);
        }
        let place = self.bodies.len();
        self.bodies.push(body);
        let inside = Open {
            body: place,
            frame: Pose::identity(),
            class,
            ..own
        };
        self.push(inside, open);
    }

    fn joint(&mut self, own: Open<'a>) {
        self.register("joints", own.node);
        let owner = label(own.node, self.lines);
        let element = match own.node.has_tag_name("freejoint") {
            true => Element::plain(own.node),
            false => self.defaults.element(own.node, own.class, self.sink),
        };
        let joint = Joint::read(&owner, element, &own.frame, self.settings, self.sink);
        self.bodies[own.body].joints.extend(joint);
    }

    fn geom(&mut self, own: Open<'a>) {
        self.register("geoms", own.node);
        let owner = label(own.node, self.lines);
        let element = self.defaults.element(own.node, own.class, self.sink);
        let by = (self.settings, self.assets);
        let geom = Geom::read(owner, &element, &own.frame, by, self.sink);
        self.bodies[own.body].geoms.extend(geom);
    }

    fn site(&mut self, own: Open<'a>) {
        self.register("sites", own.node);
        let owner = label(own.node, self.lines);
        let element = self.defaults.element(own.node, own.class, self.sink);
        let pose = placement::segment(&owner, &element, self.sink)
            .or_else(|| placement::pose(&owner, &element, self.settings, self.sink));
        if let (Some(name), Some(pose)) = (element.name(), pose) {
            self.bodies[own.body].sites.push((name, own.frame * pose));
        }
    }

    /// What MuJoCo asks of the joints of a body.
    fn check(&mut self, place: usize) {
        let body = &self.bodies[place];
        let movements: Vec<Movement> = body.joints.iter().map(|joint| joint.movement).collect();
        let is_ball = |movement: &Movement| *movement == Movement::Ball;
        let turns_on = |movement: &Movement| matches!(movement, Movement::Ball | Movement::Hinge);
        let ball = movements.iter().position(is_ball);
        let after_ball = ball.and_then(|ball| {
            movements
                .iter()
                .skip(ball + 1)
                .position(turns_on)
                .map(|after| ball + 1 + after)
        });
        let free = movements
            .iter()
            .position(|movement| *movement == Movement::Free);
        let refused = if let Some(after) = after_ball {
            Some((
                after,
                "a ball joint turns in all ways, and no hinge or ball may follow it in its body",
            ))
        } else if let Some(free) = free.filter(|_| movements.len() > 1) {
            Some((free, "a free joint is the only joint of its body"))
        } else {
            free.filter(|_| body.parent != Some(0))
                .map(|free| (free, "a free joint is that of a body in <worldbody>"))
        };
        if let Some((joint, why)) = refused {
            let node = body.joints[joint].element.node;
            let message = format!("{}: {why}", label(node, self.lines));
            self.sink.push(Diagnostic::new(tag(node), message));
        }
    }
}

impl<'a> Body<'a> {
    fn new(node: Option<Node<'a, 'a>>, parent: Option<usize>, owner: String) -> Self {
        Self {
            owner,
            name: None,
            node,
            parent,
            pose: Pose::identity(),
            inertial: None,
            geoms: Vec::new(),
            joints: Vec::new(),
            sites: Vec::new(),
            gravcomp: 0.0,
        }
    }
}
