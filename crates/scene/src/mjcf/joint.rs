//! Joints: how they move, and what else the file says of them.

use super::element::Element;
use super::placement;
use super::settings::Settings;
use crate::diagnostics::Diagnostic;
use crate::parse::rotation;
use crate::read::Sink;
use crate::source::{Located, Span};
use hamel_runtime::shown::Number;
use hamel_runtime::spatial::{Pose, so3};
use nalgebra::{Matrix3, Vector3};

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Movement {
    /// In all ways.
    Free,
    /// About a point.
    Ball,
    /// Along an axis.
    Slide,
    /// About an axis.
    Hinge,
}

/// A joint of a body, in whose frame it stands.
#[derive(Clone, Debug)]
pub(super) struct Joint<'a> {
    /// What it says.
    pub(super) element: Element<'a>,
    /// How it moves.
    pub(super) movement: Movement,
    /// Where it stands.
    position: Vector3<f64>,
    /// The rotation that turns z onto its axis.
    axis: Matrix3<f64>,
    /// Its coordinate where the body stands as the file says, rad or m.
    pub(super) reference: f64,
    /// Its coordinate where its spring is at rest, rad or m.
    pub(super) rest: f64,
    /// Stiffness of its spring, N m/rad or N/m.
    pub(super) stiffness: f64,
    /// Viscous damping, N m s/rad or N s/m.
    pub(super) damping: f64,
    /// Whether its spring or its damper is not linear.
    pub(super) bent: bool,
    /// Armature, kg m² or kg.
    pub(super) armature: f64,
    /// Dry friction, N m or N.
    pub(super) friction: f64,
    /// Where its range ends, rad or m.
    pub(super) range: Option<[f64; 2]>,
    /// The largest effort that actuators may exert, N m or N.
    pub(super) effort: Option<f64>,
}

impl<'a> Joint<'a> {
    /// The joint that an element describes, which stands in `frame` of its body.
    pub(super) fn read(
        owner: &str,
        element: Element<'a>,
        frame: &Pose<f64>,
        settings: &Settings,
        sink: &mut Sink,
    ) -> Option<Self> {
        let movement = match (element.node.tag_name().name(), element.text("type")) {
            ("freejoint", _) | (_, Some("free")) => Movement::Free,
            (_, Some("ball")) => Movement::Ball,
            (_, Some("slide")) => Movement::Slide,
            _ => Movement::Hinge,
        };
        let axis = match movement.has_axis() {
            true => axis(owner, &element, frame, sink)?,
            false => Matrix3::identity(),
        };
        let number = |name: &str| element.number(name).unwrap_or(0.0);
        let angle = |value: f64| match movement {
            Movement::Hinge => settings.angle(value),
            _ => value,
        };
        let further = |name: &str| {
            let all = element.numbers(name).unwrap_or_default();
            all.iter().skip(1).any(|value| *value != 0.0)
        };
        let position = match movement {
            Movement::Free => Vector3::zeros(),
            _ => frame.transform_point(&placement::position(&element)),
        };
        let range = limits(owner, &element, ("range", "limited"), settings, sink);
        let range = range.filter(|_| movement != Movement::Free && settings.limits);
        let range = range.map(|range| {
            range.map(|end| match movement {
                Movement::Ball => settings.angle(end),
                _ => angle(end),
            })
        });
        let force = limits(
            owner,
            &element,
            ("actuatorfrcrange", "actuatorfrclimited"),
            settings,
            sink,
        );
        for name in ["stiffness", "damping", "armature", "frictionloss"] {
            if let Some(value) = element.number(name).filter(|value| *value < 0.0) {
                let message = format!(
                    "{owner}: `{name}` is {:?}, but must be at least 0",
                    Number(value)
                );
                sink.push(Diagnostic::new(element.span(name), message));
            }
        }
        let when = |holds: bool, value: f64| if holds { value } else { 0.0 };
        Some(Self {
            movement,
            position,
            axis,
            reference: when(movement.has_axis(), angle(number("ref"))),
            rest: when(movement.has_axis(), angle(number("springref"))),
            stiffness: when(settings.springs, number("stiffness")),
            damping: when(settings.dampers, number("damping")),
            bent: settings.springs && further("stiffness")
                || settings.dampers && further("damping"),
            armature: number("armature"),
            friction: when(settings.friction, number("frictionloss")),
            range,
            effort: force
                .filter(|_| movement.has_axis())
                .map(|[low, high]| low.abs().max(high.abs())),
            element,
        })
    }

    /// The frame of the joint before its motion, in that of the body before it, and the frame of the body after it in that of the joint.
    pub(super) fn frames(&self) -> [Pose<f64>; 2] {
        let at = Pose::new(self.axis, self.position);
        let back = match self.movement {
            Movement::Hinge => Pose::from_rotation(so3::exp(&(Vector3::z() * -self.reference))),
            Movement::Slide => Pose::new(Matrix3::identity(), Vector3::z() * -self.reference),
            Movement::Free | Movement::Ball => Pose::identity(),
        };
        [at * back, at.inverse()]
    }

    /// Where it stands in the file.
    pub(super) fn span(&self) -> Span {
        self.element
            .name()
            .map_or_else(|| self.element.span("name"), |name| name.span)
    }
}

impl Movement {
    /// Whether it moves about or along an axis.
    pub(super) const fn has_axis(self) -> bool {
        matches!(self, Self::Slide | Self::Hinge)
    }

    /// The joint of the library.
    pub(super) const fn kind(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Ball => "ball_child",
            Self::Slide => "prismatic",
            Self::Hinge => "revolute",
        }
    }
}

/// The rotation that turns z onto the axis.
fn axis(
    owner: &str,
    element: &Element<'_>,
    frame: &Pose<f64>,
    sink: &mut Sink,
) -> Option<Matrix3<f64>> {
    let axis = element.vector("axis").map_or(Vector3::z(), Vector3::from);
    let axis = Located::new(frame.rotation * axis, element.span("axis"));
    rotation::from_axis(&format!("{owner}: its axis"), axis, sink)
}

/// Both ends of a range, where it limits something.
fn limits(
    owner: &str,
    element: &Element<'_>,
    (range, limited): (&str, &str),
    settings: &Settings,
    sink: &mut Sink,
) -> Option<[f64; 2]> {
    let [low, high] = element.vector(range).unwrap_or([0.0; 2]);
    let is_given = [low, high] != [0.0; 2];
    let said = element.switch(limited);
    if said.is_none() && is_given && !settings.autolimits {
        let message = format!(
            "{owner}: `{range}` is given, but not whether it limits: `autolimits` of <compiler> is false"
        );
        let error = Diagnostic::new(element.span(range), message);
        sink.push(error.help(format!("say `{limited}`")));
    }
    if !said.unwrap_or(is_given && settings.autolimits) {
        return None;
    }
    if low >= high {
        let message = format!(
            "{owner}: `{range}` begins at {:?}, which is not below its end, {:?}",
            Number(low),
            Number(high)
        );
        sink.push(Diagnostic::new(element.span(range), message));
        return None;
    }
    Some([low, high])
}
