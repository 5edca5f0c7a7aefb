//! From what a scene file says to a mechanism and its state at time 0.

mod control;
mod equip;
mod event;
mod forces;
mod joint;
mod parts;
mod place;
mod state;

pub(crate) use control::control;
pub(crate) use event::check as check_events;
pub(crate) use joint::joint;
pub(crate) use parts::states;
pub(crate) use state::{Stand, State, stand, state};

use crate::description::SceneDescription;
use crate::read::Sink;
use crate::scene::Scene;
use hamel_runtime::dynamics::DynamicsError;
use hamel_runtime::mechanism::{BodySpec, Mechanism};
use place::Places;
use std::collections::HashMap;
use std::sync::Arc;

/// Puts the mechanism together; `states` go with the bodies of `description`.
pub(crate) fn scene(
    description: &SceneDescription,
    states: Vec<State>,
    sink: &mut Sink,
) -> Option<Scene> {
    let mut configuration = Vec::new();
    let mut speeds = Vec::new();
    let mut bodies = Vec::with_capacity(states.len());
    let mut acting = Vec::with_capacity(states.len());
    for (body, state) in description.bodies.iter().zip(states) {
        configuration.extend(state.configuration);
        speeds.extend(state.speeds);
        acting.push(state.acting);
        bodies.push(BodySpec {
            name: body.name.value.clone(),
            joint_name: body.joint.name.value.clone(),
            parent: body.parent,
            joint: state.joint,
            placement: body.at,
            child_placement: body.body_at,
            mass: body.mass,
        });
    }
    let places = Places::new(description);
    let mechanism = Mechanism::new(description.gravity, bodies)
        .and_then(|mechanism| equip::equip(mechanism, description, &acting))
        .and_then(|mechanism| equip::couple(mechanism, description, &configuration))
        .map_err(|errors| {
            let errors = errors.into_iter();
            errors.for_each(|error| sink.push(places.refused(&error)));
        })
        .ok()?;
    let mechanism = Arc::new(mechanism);
    let driven = mechanism.set_driven_speeds(0.0, &mut speeds);
    let completed = driven
        .map_err(DynamicsError::from)
        .and_then(|()| equip::complete(&mechanism, &configuration, &mut speeds));
    completed
        .map_err(|error| sink.push(places.undetermined(&error)))
        .ok()?;
    let control = match &description.controller {
        Some(controller) => {
            let begin = (configuration.as_slice(), description.settings.t_end);
            Some(control::control(controller, &mechanism, begin, sink)?)
        }
        None => None,
    };
    let events = event::events(&description.events, &mechanism)?;
    Some(Scene {
        name: description.name.clone(),
        description: description.description.clone(),
        mechanism,
        configuration,
        speeds,
        events,
        shapes: description.shapes.clone(),
        control,
        settings: description.settings,
        notices: Vec::new(),
    })
}

/// The bodies that stand for joints, by the names of these.
fn by_joint(mechanism: &Mechanism) -> HashMap<&str, usize> {
    mechanism
        .joints()
        .map(|(index, body)| (body.joint_name(), index))
        .collect()
}
