//! Masses of bodies: from `<inertial>`, or from the geoms, with the bounds that `<compiler>` says.

use super::element::Element;
use super::placement;
use super::settings::Settings;
use super::tree::Body;
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::robot::mass::sum;
use crate::robot::xml::tag;
use hamel_runtime::shown::Number;
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};

/// The masses of all bodies, each in its own frame; the world has none.
pub(super) fn masses(
    bodies: &[Body<'_>],
    settings: &Settings,
    sink: &mut Sink,
) -> Vec<MassProperties> {
    let moving = moving(bodies);
    let all = (0..bodies.len()).map(|place| {
        // What never moves may weigh what it will, unless the whole is to weigh something.
        match place == 0 || settings.total.is_none() && !moving[place] {
            true => MassProperties::massless(),
            false => of_body(&bodies[place], settings, sink),
        }
    });
    let mut all: Vec<MassProperties> = all.collect();
    if let Some(total) = settings.total {
        // What is fused with the world is no body for MuJoCo, and counts for nothing.
        let counts = |place: &usize| !settings.fused || moving[*place];
        let weighed: f64 = (0..all.len())
            .filter(counts)
            .map(|place| all[place].mass)
            .sum();
        let scale = total / weighed;
        if scale.is_finite() {
            for mass in &mut all {
                mass.mass *= scale;
                mass.inertia_com *= scale;
            }
        }
    }
    all
}

/// Which bodies a joint moves, their own or one that they hang on.
fn moving(bodies: &[Body<'_>]) -> Vec<bool> {
    let mut moving = Vec::with_capacity(bodies.len());
    for body in bodies {
        let carried = body.parent.is_some_and(|parent| moving[parent]);
        moving.push(carried || !body.joints.is_empty());
    }
    moving
}

fn of_body(body: &Body<'_>, settings: &Settings, sink: &mut Sink) -> MassProperties {
    let from_geoms = settings.from_geoms.unwrap_or(body.inertial.is_none());
    let parts: Vec<MassProperties> = match from_geoms {
        true => body
            .geoms
            .iter()
            .filter_map(|geom| geom.mass(settings, sink))
            .collect(),
        false => Vec::new(),
    };
    let said = match (&body.inertial, parts.is_empty()) {
        (Some(inertial), true) => of_inertial(&body.owner, inertial, settings, sink),
        _ => Some(sum(&parts)),
    };
    let Some(said) = said else {
        return MassProperties::massless();
    };
    let mass = bounded(said, settings);
    if let Err(error) = mass.check() {
        let place = body
            .inertial
            .as_ref()
            .map_or(body.node, |own| Some(own.node));
        let message = format!("{}: {error}", body.owner);
        let error = Diagnostic::new(place.map_or(0..0, tag), message);
        sink.push(error.help("`balanceinertia` of <compiler> makes impossible moments equal, `boundmass` and `boundinertia` raise those that are too small"));
        return MassProperties::massless();
    }
    mass
}

/// What an `<inertial>` says, in the frame of its body.
fn of_inertial(
    owner: &str,
    element: &Element<'_>,
    settings: &Settings,
    sink: &mut Sink,
) -> Option<MassProperties> {
    let owner = format!("{owner}: <inertial>");
    let at: Pose<f64> = placement::pose(&owner, element, settings, sink)?;
    let mass = element.number("mass")?;
    if mass < 0.0 {
        let message = format!(
            "{owner}: `mass` is {:?} kg: it must be at least 0",
            Number(mass)
        );
        sink.push(Diagnostic::new(element.span("mass"), message));
        return None;
    }
    let full = element.vector("fullinertia");
    let refused = match full.is_some() {
        true if element.text("diaginertia").is_some() => {
            Some("`diaginertia` and `fullinertia` exclude each other")
        }
        true if placement::is_turned(element) => {
            Some("`fullinertia` is in the axes of the body, and has no orientation")
        }
        _ => None,
    };
    if let Some(why) = refused {
        sink.push(Diagnostic::new(
            element.span("fullinertia"),
            format!("{owner}: {why}"),
        ));
        return None;
    }
    let own = match full {
        Some([xx, yy, zz, xy, xz, yz]) => Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        None => {
            let moments = element
                .vector("diaginertia")
                .map_or_else(Vector3::zeros, Vector3::from);
            Matrix3::from_diagonal(&moments)
        }
    };
    let turned = at.rotation * own * at.rotation.transpose();
    Some(MassProperties {
        mass,
        com: at.translation,
        inertia_com: (turned + turned.transpose()) * 0.5,
    })
}

/// The same with a mass and moments that are not too small, and possible ones where these are to be balanced.
fn bounded(said: MassProperties, settings: &Settings) -> MassProperties {
    let mass = said.mass.max(settings.least_mass);
    let eigen = said.inertia_com.symmetric_eigen();
    let mut moments = eigen
        .eigenvalues
        .map(|moment| moment.max(settings.least_inertia));
    let impossible = moments.iter().any(|moment| 2.0 * moment > moments.sum());
    if settings.balanced && impossible && said.check().is_err() {
        moments = Vector3::repeat(moments.mean());
    }
    // Without a change the digits of the file stay.
    let inertia_com = match moments == eigen.eigenvalues {
        true => said.inertia_com,
        false => {
            eigen.eigenvectors * Matrix3::from_diagonal(&moments) * eigen.eigenvectors.transpose()
        }
    };
    MassProperties {
        mass,
        com: said.com,
        inertia_com: (inertia_com + inertia_com.transpose()) * 0.5,
    }
}
