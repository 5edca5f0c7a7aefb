//! What `<compiler>` and `<option>` say of the whole model.

use super::element::Element;
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use nalgebra::Vector3;
use roxmltree::Node;

/// Settings of a model.
#[derive(Debug)]
pub(super) struct Settings {
    /// Whether angles are in degrees.
    pub(super) degrees: bool,
    /// Axes of Euler angles: small letters turn with the body.
    pub(super) euler: [char; 3],
    /// Whether a range alone makes a limit.
    pub(super) autolimits: bool,
    /// Whether masses are those of geoms: always, never, or where there is no `<inertial>`.
    pub(super) from_geoms: Option<bool>,
    /// The groups of geoms that have mass.
    pub(super) groups: [f64; 2],
    /// The least mass, kg.
    pub(super) least_mass: f64,
    /// The least principal moment of inertia, kg m².
    pub(super) least_inertia: f64,
    /// Whether impossible principal moments are replaced by their mean.
    pub(super) balanced: bool,
    /// The mass of the whole, kg, where it is given.
    pub(super) total: Option<f64>,
    /// Whether bodies without joints are no bodies of their own.
    pub(super) fused: bool,
    /// Whether frames of free bodies are those of their inertias.
    pub(super) aligned: bool,
    /// Acceleration of free fall, m/s².
    pub(super) gravity: Vector3<f64>,
    /// Whether springs act.
    pub(super) springs: bool,
    /// Whether dampers act.
    pub(super) dampers: bool,
    /// Whether limits act.
    pub(super) limits: bool,
    /// Whether dry friction acts.
    pub(super) friction: bool,
    /// Whether equalities act.
    pub(super) equalities: bool,
}

impl Settings {
    /// Those of the document of that root. Of several elements the later ones go first.
    pub(super) fn read(root: Node<'_, '_>, notices: &mut Notices, sink: &mut Sink) -> Self {
        let all = |nodes: Vec<Node<'_, '_>>, name: &str| -> Vec<_> {
            let inside = nodes.into_iter().flat_map(|node| node.children());
            inside
                .filter(|node| node.has_tag_name(name))
                .map(|node| node.id())
                .collect()
        };
        let node = |id| root.document().get_node(id);
        let element = |ids: Vec<roxmltree::NodeId>| -> Option<Element<'_>> {
            let mut chain: Vec<Node<'_, '_>> = ids.into_iter().filter_map(node).collect();
            chain.reverse();
            Some(Element {
                node: *chain.first()?,
                chain,
            })
        };
        let options: Vec<_> = all(vec![root], "option");
        let flags = all(options.iter().copied().filter_map(node).collect(), "flag");
        let compiler = element(all(vec![root], "compiler"));
        let (options, flags) = (element(options), element(flags));
        let of = |name: &str| compiler.as_ref().and_then(|own| own.text(name));
        let number = |name: &str| compiler.as_ref().and_then(|own| own.number(name));
        let on = |name: &str, otherwise: bool| {
            let own = compiler.as_ref().and_then(|own| own.switch(name));
            own.unwrap_or(otherwise)
        };
        let enabled = |name: &str| {
            let own = flags.as_ref().and_then(|own| own.text(name));
            own != Some("disable")
        };
        if let Some(own) = compiler
            .as_ref()
            .filter(|_| of("coordinate") == Some("global"))
        {
            let message =
                "`coordinate` of <compiler> is \"global\", which MuJoCo gave up in version 2.3.4";
            let error = Diagnostic::new(own.span("coordinate"), message);
            sink.push(error.help("an earlier version writes the model in local coordinates: `compile robot.xml local.xml`"));
        }
        let fluid = |own: &&Element<'_>| {
            ["density", "viscosity"]
                .iter()
                .any(|name| own.number(name).is_some_and(|value| value != 0.0))
        };
        if options.as_ref().filter(fluid).is_some() {
            notices.warn(
                "drag and lift of a surrounding fluid are not simulated",
                "<option>",
            );
        }
        let mut letters = of("eulerseq").unwrap_or("xyz").chars();
        let constraint = enabled("constraint");
        let passive = enabled("passive");
        Self {
            degrees: of("angle") != Some("radian"),
            euler: ['x', 'y', 'z'].map(|otherwise| letters.next().unwrap_or(otherwise)),
            autolimits: on("autolimits", true),
            from_geoms: compiler
                .as_ref()
                .and_then(|own| own.switch("inertiafromgeom")),
            groups: compiler
                .as_ref()
                .and_then(|own| own.vector("inertiagrouprange"))
                .unwrap_or([0.0, 5.0]),
            least_mass: number("boundmass").unwrap_or(0.0),
            least_inertia: number("boundinertia").unwrap_or(0.0),
            balanced: on("balanceinertia", false),
            total: number("settotalmass").filter(|total| *total > 0.0),
            fused: on("fusestatic", false),
            aligned: on("alignfree", false),
            gravity: match enabled("gravity") {
                true => options
                    .as_ref()
                    .and_then(|own| own.vector("gravity"))
                    .map_or(Vector3::new(0.0, 0.0, -9.81), Vector3::from),
                false => Vector3::zeros(),
            },
            springs: enabled("spring") && passive,
            dampers: enabled("damper") && passive,
            limits: enabled("limit") && constraint,
            friction: enabled("frictionloss") && constraint,
            equalities: enabled("equality") && constraint,
        }
    }

    /// An angle as the file writes it, in rad.
    pub(super) fn angle(&self, angle: f64) -> f64 {
        match self.degrees {
            true => angle / 180.0 * std::f64::consts::PI,
            false => angle,
        }
    }
}
