//! What acts at coupled joints, given to the one joint that they make: at its degrees of freedom what acts at a joint that follows none, at its
//! ports what acts at one that follows.

use super::graph::Movement;
use super::{initial, limit};
use crate::description::{BodyDescription, Motion};
use crate::diagnostics::Diagnostic;
use crate::forces::{
    FrictionDescription, JointForces, PerFreedom, PortForces, PortSpringDescription, SpringEnergy,
};
use crate::read::Sink;
use crate::source::{Located, Span};
use hamel_runtime::joint::Link;
use hamel_runtime::time_function::TimeFunction;

/// A joint of a coupling.
pub(super) struct Owner<'a> {
    /// Its name.
    pub(super) name: &'a str,
    /// Its body.
    pub(super) body: &'a BodyDescription,
    /// How it moves.
    pub(super) movement: Movement<'a>,
    /// Whether it follows another.
    pub(super) follows: bool,
    /// What it follows, and by which ratio.
    pub(super) link: Link,
}

impl Owner<'_> {
    /// What joints with several independent coordinates cannot have.
    pub(super) fn needs_one(&self, what: &str, span: &Span, coordinates: usize) -> Diagnostic {
        let message = format!(
            "joint `{}`: {what} needs a single coordinate, and the joints that it is coupled with have {coordinates}",
            self.name
        );
        Diagnostic::new(span.clone(), message)
    }

    /// The one number of a list that has one for each degree of freedom.
    fn one(&self, key: &str, numbers: Option<&Located<PerFreedom>>) -> Result<f64, Diagnostic> {
        let Some(numbers) = numbers else {
            return Ok(0.0);
        };
        match numbers.value.spread(1).as_deref() {
            Some([number]) => Ok(*number),
            _ => {
                let found = match &numbers.value {
                    PerFreedom::Each(numbers) => numbers.len(),
                    PerFreedom::All(_) => 1,
                };
                Err(self.size(key, found, &numbers.span))
            }
        }
    }

    /// The one function of a list.
    fn only<'f>(
        &self,
        key: &str,
        functions: &'f Located<Vec<TimeFunction>>,
    ) -> Result<&'f TimeFunction, Diagnostic> {
        match functions.value.as_slice() {
            [function] => Ok(function),
            several => Err(self.size(key, several.len(), &functions.span)),
        }
    }

    fn size(&self, key: &str, found: usize, span: &Span) -> Diagnostic {
        let message = format!("joint `{}`: `{key}` has size {found}, not 1", self.name);
        Diagnostic::new(span.clone(), message)
    }

    /// What acts at the port of this joint.
    fn at_port(&self) -> Result<Option<PortForces>, Diagnostic> {
        let forces = &self.body.forces;
        let effort = match &forces.effort {
            Some(effort) if self.follows => Some(self.only("effort", effort)?.clone()),
            _ => None,
        };
        let damping = match self.follows {
            true => self.one("damping", forces.damping.as_ref())?,
            false => 0.0,
        };
        let spring = self.spring()?;
        let acts = effort.is_some() || damping > 0.0 || spring.is_some();
        Ok(acts.then(|| PortForces {
            name: self.body.joint.name.clone(),
            effort,
            spring,
            damping,
            armature: 0.0,
            friction: None,
            limit: None,
        }))
    }

    fn spring(&self) -> Result<Option<PortSpringDescription>, Diagnostic> {
        let Some(spring) = &self.body.forces.spring else {
            return Ok(None);
        };
        let key = "spring.stiffness";
        let stiffness = match &spring.value.energy {
            SpringEnergy::Diagonal(numbers) => {
                let numbers = Located::new(numbers.clone(), spring.span.clone());
                self.one(key, Some(&numbers))?
            }
            SpringEnergy::Full(matrix) if matrix.len() == 1 => matrix[(0, 0)],
            SpringEnergy::Full(matrix) => {
                return Err(self.size(key, matrix.nrows(), &spring.span));
            }
            SpringEnergy::Trace(_) => {
                let message = format!(
                    "joint `{}`: it is coupled, and a spring of kind \"trace\" cannot act at it: give one of kind \"log\"",
                    self.name
                );
                return Err(Diagnostic::new(spring.span.clone(), message));
            }
        };
        let rest = initial::position(self.name, self.movement, &spring.value.rest)?;
        Ok(Some(PortSpringDescription {
            stiffness,
            rest: Some(rest.map_or(0.0, |(rest, _)| rest)),
        }))
    }
}

/// What acts at all of them, at one joint.
pub(super) fn joined(owners: &[Owner<'_>], coordinates: usize, sink: &mut Sink) -> JointForces {
    let mut forces = JointForces::default();
    for owner in owners {
        match owner.at_port() {
            Ok(own) => forces.ports.extend(own),
            Err(error) => sink.push(error),
        }
    }
    type Part = fn(&[Owner<'_>], usize, &mut JointForces) -> Added;
    let parts: [Part; 6] = [damping, armature, efforts, motion, friction, limit::add];
    for part in parts {
        let added = part(owners, coordinates, &mut forces);
        added.unwrap_or_else(|error| sink.push(error));
    }
    forces
}

type Added = Result<(), Diagnostic>;

/// Numbers at the degrees of freedom, in the order of these, of the joints whose key is given.
fn each<'o>(
    owners: &'o [Owner<'o>],
    coordinates: usize,
    given: impl Fn(&'o Owner<'o>) -> Option<(&'o Span, Result<f64, Diagnostic>)>,
) -> Result<Option<Located<PerFreedom>>, Diagnostic> {
    let (mut sums, mut place) = (vec![0.0; coordinates], None);
    for owner in owners {
        if let Some((span, number)) = given(owner) {
            sums[owner.link.coordinate] += number?;
            place.get_or_insert(span.clone());
        }
    }
    Ok(place.map(|span| Located::new(PerFreedom::Each(sums), span)))
}

fn damping(owners: &[Owner<'_>], coordinates: usize, forces: &mut JointForces) -> Added {
    forces.damping = each(owners, coordinates, |owner| {
        let own = owner.body.forces.damping.as_ref();
        let own = own.filter(|_| !owner.follows)?;
        Some((&own.span, owner.one("damping", Some(own))))
    })?;
    Ok(())
}

/// A rotor that turns with a joint that follows has ratio² times its inertia at what is followed.
fn armature(owners: &[Owner<'_>], coordinates: usize, forces: &mut JointForces) -> Added {
    forces.armature = each(owners, coordinates, |owner| {
        let own = owner.body.forces.armature.as_ref()?;
        let number = owner.one("armature", Some(own));
        Some((
            &own.span,
            number.map(|number| owner.link.ratio * owner.link.ratio * number),
        ))
    })?;
    Ok(())
}

fn efforts(owners: &[Owner<'_>], coordinates: usize, forces: &mut JointForces) -> Added {
    let own = owners.iter().filter(|owner| !owner.follows);
    forces.effort = at_leaders(own, coordinates, "effort", |forces| forces.effort.as_ref())?;
    Ok(())
}

/// Functions of time at degrees of freedom: 0 where none is given.
fn at_leaders<'o>(
    owners: impl Iterator<Item = &'o Owner<'o>>,
    coordinates: usize,
    key: &str,
    given: impl Fn(&'o JointForces) -> Option<&'o Located<Vec<TimeFunction>>>,
) -> Result<Option<Located<Vec<TimeFunction>>>, Diagnostic> {
    let (mut all, mut place) = (vec![TimeFunction::from(0.0); coordinates], None);
    for owner in owners {
        if let Some(own) = given(&owner.body.forces) {
            all[owner.link.coordinate] = owner.only(key, own)?.clone();
            place.get_or_insert(own.span.clone());
        }
    }
    Ok(place.map(|span| Located::new(all, span)))
}

/// Motion is prescribed of all that move independently, or of none.
fn motion(owners: &[Owner<'_>], coordinates: usize, forces: &mut JointForces) -> Added {
    let mut given = 0;
    for owner in owners {
        let Some(motion) = &owner.body.forces.motion else {
            continue;
        };
        let refuse = |what: &str| {
            let message = format!("joint `{}`: {what}", owner.name);
            Err(Diagnostic::new(motion.span.clone(), message))
        };
        if owner.follows {
            return refuse("it follows another: prescribe the motion of that");
        }
        if owner.body.initial.motion != Motion::Rest {
            return refuse(
                "its motion is prescribed, and so are its speeds at time 0: leave them out of its `initial`",
            );
        }
        given += 1;
    }
    let own = owners.iter().filter(|owner| !owner.follows);
    let all = at_leaders(own, coordinates, "motion.speeds", |forces| {
        forces.motion.as_ref()
    })?;
    if let Some(motion) = all.as_ref().filter(|_| given < coordinates) {
        let message = format!(
            "joint `{}`: motion is prescribed of {given} of the {coordinates} joints that move independently in its coupling: it must be of all or of none",
            owners.first().map_or("", |owner| owner.name)
        );
        return Err(Diagnostic::new(motion.span.clone(), message));
    }
    forces.motion = all;
    Ok(())
}

/// All slide or stick together: at what is followed their efforts add up, |ratio| times each.
fn friction(owners: &[Owner<'_>], coordinates: usize, forces: &mut JointForces) -> Added {
    let mut all: Option<Located<FrictionDescription>> = None;
    for owner in owners {
        let Some(own) = &owner.body.forces.friction else {
            continue;
        };
        if coordinates > 1 {
            return Err(owner.needs_one("friction", &own.span, coordinates));
        }
        let none = FrictionDescription {
            sliding: 0.0,
            sticking: 0.0,
        };
        let sum = all.get_or_insert(Located::new(none, own.span.clone()));
        sum.value.sliding += owner.link.ratio.abs() * own.value.sliding;
        sum.value.sticking += owner.link.ratio.abs() * own.value.sticking;
    }
    forces.friction = all;
    Ok(())
}
