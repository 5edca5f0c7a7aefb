//! A posture of a robot, by the coordinates of its joints.

use super::Import;
use crate::description::Position;
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::read::Sink;
use crate::source::Located;
use crate::suggest::{nearest, one_of};

/// The joint types with one coordinate, which an angle or a displacement tells.
const OF_ONE: [&str; 3] = ["revolute", "revolute_circle", "prismatic"];

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
            _ => Err(sink.refuse(
                &self.scene.source.name,
                &self.scene.source.text,
                "the robot cannot take the posture",
            )),
        }
    }

    /// The same, but that joints which follow others stand where these have them, whatever is said of them: named postures of robots often say both.
    ///
    /// # Errors
    /// Those of [`Import::in_posture`].
    pub fn in_state(self, state: &[(String, f64)]) -> Result<Self, Diagnostics> {
        let follows = |joint: &str| {
            let mut bodies = self.scene.bodies.iter();
            bodies.any(|body| body.joint.name.value == *joint && body.mimic.is_some())
        };
        let own = state.iter().filter(|(joint, _)| !follows(joint));
        let own: Vec<(String, f64)> = own.cloned().collect();
        self.in_posture(&own)
    }

    fn place(&mut self, joint: &str, coordinate: f64, sink: &mut Sink) {
        let bodies = &mut self.scene.bodies;
        let found = bodies
            .iter()
            .position(|body| body.joint.name.value == joint);
        let Some(body) = found.map(|index| &mut bodies[index]) else {
            let message = format!("posture: there is no joint `{joint}` that moves");
            let names = || bodies.iter().map(|body| &*body.joint.name.value);
            let help = match nearest(joint, names()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("a joint is {}", one_of(names())),
            };
            return sink.push(Diagnostic::without_place(message).help(help));
        };
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
