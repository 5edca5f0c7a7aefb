//! A posture of a robot, by the coordinates of its joints.

use super::Import;
use crate::description::{BodyDescription, Position};
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::notice::{Notice, Severity};
use crate::parse::rotation::unit_quaternion;
use crate::read::Sink;
use crate::source::Located;
use crate::suggest::{nearest, one_of};
use hamel_runtime::spatial::Pose;
use nalgebra::{Vector3, Vector4};

/// The joint types with one coordinate, which an angle or a displacement tells.
const OF_ONE: [&str; 3] = ["revolute", "revolute_circle", "prismatic"];
/// The joint types that an attitude places.
const OF_ATTITUDE: [&str; 3] = ["ball", "ball_child", "ball_quaternion"];

impl Import {
    /// The same robot, which begins where each of these joints has its coordinate: an angle in rad or a displacement in m, as the file counts it. Other joints begin as they did.
    ///
    /// # Errors
    /// Joints that the robot does not have, that are named twice, that have not one degree of freedom or that follow another one; coordinates that are not finite.
    pub fn in_posture(mut self, posture: &[(String, f64)]) -> Result<Self, Diagnostics> {
        let mut sink = Sink::default();
        for (index, (joint, coordinate)) in posture.iter().enumerate() {
            if posture[..index].iter().any(|(before, _)| before == joint) {
                let message = format!("posture: joint `{joint}` is named twice");
                sink.push(Diagnostic::without_place(message));
                continue;
            }
            if !coordinate.is_finite() {
                let message = format!("posture: joint `{joint}` is to stand at {coordinate}");
                sink.push(Diagnostic::without_place(message));
                continue;
            }
            self.place(joint, *coordinate, &mut sink);
        }
        match sink.len() {
            0 => Ok(self),
            _ => Err(self.refuse(sink)),
        }
    }

    /// The same for a state of an SRDF. Joints that follow others stand where these have them, whatever is said of them: named postures of robots often say both. A pose whose joint the robot does not
    /// have is that of its root on the world: where the root moves freely it begins there, and where it is fixed the pose is left out, which a notice says.
    ///
    /// # Errors
    /// Those of [`Import::in_posture`]; a pose for a joint that does not move freely, an attitude for one that is no ball joint.
    pub fn in_state(mut self, state: &[(String, Vec<f64>)]) -> Result<Self, Diagnostics> {
        let bodies = &self.scene.bodies;
        let follows = |joint| joint_body(bodies, joint).is_some_and(|i| bodies[i].mimic.is_some());
        let (mut coordinates, mut poses) = (vec![], vec![]);
        for (joint, numbers) in state.iter().filter(|(joint, _)| !follows(joint)) {
            match numbers.as_slice() {
                [coordinate] => coordinates.push((joint.clone(), *coordinate)),
                numbers => poses.push((joint, numbers)),
            }
        }
        let mut sink = Sink::default();
        for (joint, numbers) in poses {
            self.pose(joint, numbers, &mut sink);
        }
        match sink.len() {
            0 => self.in_posture(&coordinates),
            _ => Err(self.refuse(sink)),
        }
    }

    /// Places a joint by a quaternion, with a position before it where it moves freely.
    fn pose(&mut self, joint: &str, numbers: &[f64], sink: &mut Sink) {
        let (position, kinds): (_, &[&str]) = match numbers.len() {
            4 => (Vector3::zeros(), &OF_ATTITUDE),
            _ => (Vector3::from_column_slice(&numbers[..3]), &["free"]),
        };
        let bodies = &mut self.scene.bodies;
        let own = joint_body(bodies, joint);
        let is_root = own.is_none() && numbers.len() > 4;
        let root = |body: &BodyDescription| {
            is_root && body.parent.is_none() && body.joint.kind.value == "free"
        };
        let Some(index) = own.or_else(|| bodies.iter().position(root)) else {
            if is_root {
                return self.notices.push(Notice {
                    severity: Severity::Note,
                    message: String::from(
                        "the root is fixed: its pose in the state of the SRDF is left out",
                    ),
                    elements: vec![format!("joint `{joint}`")],
                });
            }
            return sink.push(unknown(joint, bodies));
        };
        let body = &mut bodies[index];
        let kind = &body.joint.kind.value;
        if !kinds.contains(&&**kind) {
            let message = format!(
                "posture: joint `{joint}` is a `{kind}`: {} numbers do not say where it stands",
                numbers.len()
            );
            return sink.push(Diagnostic::new(body.joint.span.clone(), message));
        }
        let [x, y, z, w] = [4, 3, 2, 1].map(|behind| numbers[numbers.len() - behind]);
        let rotation = unit_quaternion(&Vector4::new(w, x, y, z));
        let span = body.joint.span.clone();
        body.initial.position = Position::Pose(Located::new(Pose::new(rotation, position), span));
    }

    fn refuse(&self, sink: Sink) -> Diagnostics {
        sink.refuse(
            &self.scene.source.name,
            &self.scene.source.text,
            "the robot cannot take the posture",
        )
    }

    fn place(&mut self, joint: &str, coordinate: f64, sink: &mut Sink) {
        let bodies = &mut self.scene.bodies;
        let Some(index) = joint_body(bodies, joint) else {
            return sink.push(unknown(joint, bodies));
        };
        let body = &mut bodies[index];
        let kind = &body.joint.kind.value;
        if !OF_ONE.contains(&&**kind) {
            let message = format!(
                "posture: joint `{joint}` is a `{kind}`: one number does not say where it stands"
            );
            let error = Diagnostic::new(body.joint.span.clone(), message);
            let help = "import the robot to a scene, and give the joint `initial.phi` there";
            return sink.push(error.help(help));
        }
        if let Some(mimic) = &body.mimic {
            let followed = &mimic.value.joint.value;
            let message = format!("posture: joint `{joint}` follows joint `{followed}`");
            let error = Diagnostic::new(mimic.span.clone(), message);
            return sink.push(error.help(format!("say where `{followed}` stands")));
        }
        let span = body.joint.span.clone();
        body.initial.position = Position::Phi(Located::new(vec![coordinate], span));
    }
}

/// The body on the joint of a name.
fn joint_body(bodies: &[BodyDescription], joint: &str) -> Option<usize> {
    bodies
        .iter()
        .position(|body| body.joint.name.value == joint)
}

fn unknown(joint: &str, bodies: &[BodyDescription]) -> Diagnostic {
    let message = format!("posture: there is no joint `{joint}` that moves");
    let names = || bodies.iter().map(|body| &*body.joint.name.value);
    let help = match nearest(joint, names()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("a joint is {}", one_of(names())),
    };
    Diagnostic::without_place(message).help(help)
}
