//! Memory for the equations of motion of one robot: one workspace for each thread that asks, kept for the next call.

use crate::batch::lock;
use crate::equations::Equations;
use hamel::compiled::Compiled;
use hamel::dynamics::{
    ForwardDerivatives, ForwardSecondDerivatives, InverseDerivatives, InverseSecondDerivatives,
    JointTorqueRegressor,
};
use hamel::mechanism::{Body, CONFIGURATION_TOLERANCE, Mechanism, StateError};
use std::sync::{Arc, Mutex};

/// Memory of one thread.
pub struct Workspace {
    mechanism: Arc<Mechanism>,
    /// The equations of motion.
    pub equations: Equations,
    /// Speeds of a mechanism at rest.
    pub rest: Vec<f64>,
    /// A Jacobian, column by column.
    pub jacobian: Vec<f64>,
    forward: Option<Box<ForwardDerivatives>>,
    inverse: Option<Box<InverseDerivatives>>,
    forward_second: Option<Box<ForwardSecondDerivatives>>,
    inverse_second: Option<Box<InverseSecondDerivatives>>,
    regressor: Option<Box<JointTorqueRegressor>>,
}

impl Workspace {
    fn new(mechanism: &Arc<Mechanism>, equations: Equations) -> Self {
        let speeds = mechanism.layout().speeds;
        Self {
            mechanism: Arc::clone(mechanism),
            equations,
            rest: vec![0.0; speeds],
            jacobian: vec![0.0; 6 * speeds],
            forward: None,
            inverse: None,
            forward_second: None,
            inverse_second: None,
            regressor: None,
        }
    }

    /// The equations of motion, and room for derivatives of forward dynamics.
    pub fn forward(&mut self) -> (&mut Equations, &mut ForwardDerivatives) {
        let room = self
            .forward
            .get_or_insert_with(|| Box::new(ForwardDerivatives::new(&self.mechanism)));
        (&mut self.equations, room)
    }

    /// The equations of motion, and room for derivatives of inverse dynamics.
    pub fn inverse(&mut self) -> (&mut Equations, &mut InverseDerivatives) {
        let room = self
            .inverse
            .get_or_insert_with(|| Box::new(InverseDerivatives::new(&self.mechanism)));
        (&mut self.equations, room)
    }

    /// The equations of motion, and room for second derivatives of forward dynamics.
    pub fn forward_second(&mut self) -> (&mut Equations, &mut ForwardSecondDerivatives) {
        let room = self
            .forward_second
            .get_or_insert_with(|| Box::new(ForwardSecondDerivatives::new(&self.mechanism)));
        (&mut self.equations, room)
    }

    /// The equations of motion, and room for second derivatives of inverse dynamics.
    pub fn inverse_second(&mut self) -> (&mut Equations, &mut InverseSecondDerivatives) {
        let room = self
            .inverse_second
            .get_or_insert_with(|| Box::new(InverseSecondDerivatives::new(&self.mechanism)));
        (&mut self.equations, room)
    }

    /// The equations of motion, and room for a regressor.
    pub fn regressor(&mut self) -> (&mut Equations, &mut JointTorqueRegressor) {
        let room = self
            .regressor
            .get_or_insert_with(|| Box::new(JointTorqueRegressor::new(&self.mechanism)));
        (&mut self.equations, room)
    }
}

/// Workspaces that no thread uses.
pub struct Workspaces {
    mechanism: Arc<Mechanism>,
    /// The bodies of joints whose Q is not free: rotations, circles, loops.
    bound: Vec<usize>,
    /// Equations that were compiled for it.
    compiled: Option<Compiled>,
    #[expect(
        clippy::vec_box,
        reason = "they change hands at each call, and are hundreds of bytes long"
    )]
    free: Mutex<Vec<Box<Workspace>>>,
}

impl Workspaces {
    /// Those of a mechanism, with the equations that were compiled for it, if any: none yet.
    pub fn new(mechanism: &Arc<Mechanism>, compiled: Option<Compiled>) -> Self {
        let is_bound = |body: &Body| {
            let ranges = body.ranges();
            ranges.configuration.len() != ranges.freedoms.len()
                || !body.joint().relations().is_empty()
        };
        let joints = mechanism.joints();
        let bound = joints.filter_map(|(index, body)| is_bound(body).then_some(index));
        Self {
            mechanism: Arc::clone(mechanism),
            bound: bound.collect(),
            compiled,
            free: Mutex::default(),
        }
    }

    /// Whether Q lies on the manifold of each joint; numbers that are not finite are left to the equations of motion.
    ///
    /// # Errors
    /// The first joint that is off, with its residual.
    pub fn check_configuration(&self, q: &[f64]) -> Result<(), StateError> {
        self.bound.iter().try_for_each(|&index| {
            let body = self.mechanism.body(index)?;
            let residual = body.joint().residual(body.configuration(q));
            if residual.is_finite() && residual > CONFIGURATION_TOLERANCE {
                return Err(StateError::OffManifold {
                    joint: body.joint_name().into(),
                    residual,
                    limit: CONFIGURATION_TOLERANCE,
                });
            }
            Ok(())
        })
    }

    /// The equations that were compiled for its mechanism.
    pub const fn compiled(&self) -> Option<&Compiled> {
        self.compiled.as_ref()
    }

    /// How many speeds its mechanism has.
    pub fn speeds(&self) -> usize {
        self.mechanism.layout().speeds
    }

    /// One that no other thread has.
    pub fn take(&self) -> Box<Workspace> {
        let free = lock(&self.free).pop();
        free.unwrap_or_else(|| {
            let equations = match &self.compiled {
                Some(compiled) => Equations::compiled(compiled),
                None => Equations::tree_of(&self.mechanism),
            };
            Box::new(Workspace::new(&self.mechanism, equations))
        })
    }

    /// Keeps one for the next call.
    pub fn give_back(&self, workspace: Box<Workspace>) {
        lock(&self.free).push(workspace);
    }
}
