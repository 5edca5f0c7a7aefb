//! One motion in several coordinates: the joints of a scene exchanged for others with the same motions.

use hamel_scene::{Located, Motion, Position, SceneDescription};

/// What attitudes are stored as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Representation {
    /// The joints that the scene names.
    Declared,
    /// Ball joints as rotation matrices.
    Matrix,
    /// Ball joints as unit quaternions.
    Quaternion,
    /// Ball joints as gimbals: three angles.
    Euler,
    /// Revolute joints as points of a circle.
    Circle,
}

impl Representation {
    /// As files and options write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Declared => "declared",
            Self::Matrix => "matrix",
            Self::Quaternion => "quaternion",
            Self::Euler => "euler",
            Self::Circle => "circle",
        }
    }

    /// Whether it is the library's own, the first of [`Representation::of`].
    pub const fn is_first(self) -> bool {
        matches!(self, Self::Declared | Self::Matrix)
    }

    /// Those that make sense for a scene, the one of the library first.
    pub fn of(scene: &SceneDescription) -> Vec<Self> {
        let mut kinds = scene.bodies.iter().map(|body| &body.joint.kind.value);
        if kinds.any(|kind| is_ball(kind)) && scene.bodies.iter().all(exchangeable) {
            return vec![Self::Matrix, Self::Quaternion, Self::Euler];
        }
        match scene.bodies.as_slice() {
            // A spring pulls back whole turns, which a circle does not count.
            [body] if body.joint.kind.value == "revolute" && body.forces.spring.is_none() => {
                vec![Self::Declared, Self::Circle]
            }
            _ => vec![Self::Declared],
        }
    }

    /// The scene in this representation.
    pub fn apply(self, scene: &SceneDescription) -> SceneDescription {
        let mut scene = scene.clone();
        for body in &mut scene.bodies {
            if let Some(other) = self.exchanged(&body.joint.kind.value) {
                let span = body.joint.kind.span.clone();
                body.joint.kind = Located {
                    value: other.to_owned(),
                    span,
                };
            }
        }
        scene
    }

    fn exchanged(self, kind: &str) -> Option<&'static str> {
        match (self, kind) {
            (Self::Matrix, "ball" | "ball_quaternion") => Some("ball"),
            (Self::Quaternion, "ball" | "ball_quaternion") => Some("ball_quaternion"),
            (Self::Matrix, "ball_child" | "ball_quaternion_child") => Some("ball_child"),
            (Self::Quaternion, "ball_child" | "ball_quaternion_child") => {
                Some("ball_quaternion_child")
            }
            (Self::Euler, kind) if is_ball(kind) => Some("gimbal"),
            (Self::Circle, "revolute") => Some("revolute_circle"),
            _ => None,
        }
    }
}

fn is_ball(kind: &str) -> bool {
    matches!(
        kind,
        "ball" | "ball_child" | "ball_quaternion" | "ball_quaternion_child"
    )
}

/// Whether the state of the joint is said in words that all representations know.
fn exchangeable(body: &hamel_scene::BodyDescription) -> bool {
    let place = matches!(body.initial.position, Position::Home | Position::Pose(_));
    let motion = matches!(body.initial.motion, Motion::Rest | Motion::Twist(_));
    !is_ball(&body.joint.kind.value) || (place && motion)
}
