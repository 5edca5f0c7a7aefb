//! What displacements of Q in the group would do if the relations allowed them: the twists of the bodies and the rates of ports, for the
//! multipliers of the relations.

use super::implicit;
use super::motion::Motion;
use super::ports;
use super::twist::child_twists;
use crate::matrix::Matrix;
use crate::model::{Declared, PoseExpr};
use crate::prepare::Prepared;

/// Twists and rates along the standard directions of the group, with H and ports as the spec writes them.
#[derive(Clone, Debug)]
pub struct Forbidden {
    /// Q⁻¹Q̇ to the twist of each body in its child frame, 6×dim G; of several bodies one below the other.
    pub twists: Matrix,
    /// Q⁻¹Q̇ to the rates of the ports.
    pub ports: Matrix,
}

impl Forbidden {
    /// Of a joint whose motion relations alone give.
    pub fn new(joint: &Prepared) -> Self {
        let ideal = joint.space.manifold.ideal();
        let freely = Motion::of_exponential(&implicit::freely(joint));
        let own = |pose: &Declared<PoseExpr>| child_twists(&pose.value, &freely, ideal);
        let none = Matrix::zeros(0, freely.freedoms());
        let twists = joint.spec.poses().map(own);
        Self {
            twists: twists.fold(none, |above, rows| above.stack(&rows)),
            ports: ports::gradient(&joint.spec.ports, &freely, ideal),
        }
    }

    /// With the twists of one body alone.
    pub fn of_body(&self, body: usize) -> Self {
        Self {
            twists: self.twists.rows_of_body(body),
            ports: self.ports.clone(),
        }
    }
}
