//! What acts at coupled joints, given to the one joint that they make: at its degrees of freedom what acts at a joint that follows none, at its
//! ports what acts at one that follows.

use super::graph::Movement;
use super::{initial, limit};
use crate::description::{BodyDescription, Motion};
use crate::diagnostics::Diagnostic;
use crate::forces::{
    FrictionDescription, JointForces, LimitDescription, LimitKind, PerFreedom, PortForces,
    PortSpringDescription, SpringEnergy,
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
    /// Whether ties hold what it is coupled with: everything acts at its port then.
    pub(super) closed: bool,
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

    /// Whether efforts and damping act at its port, as they do where it is not independent, or may not be.
    fn at_its_port(&self) -> bool {
        self.follows || self.closed
    }

    /// What acts at the port of this joint.
    fn at_port(&self) -> Result<Option<PortForces>, Diagnostic> {
        let forces = &self.body.forces;
        let effort = match &forces.effort {
            Some(effort) if self.at_its_port() => Some(self.only("effort", effort)?.clone()),
            _ => None,
        };
        let damping = match self.at_its_port() {
            true => self.one("damping", forces.damping.as_ref())?,
            false => 0.0,
        };
        let own = PortForces {
            name: self.body.joint.name.clone(),
            effort,
            spring: self.spring()?,
            damping,
            armature: match self.closed {
                true => self.one("armature", forces.armature.as_ref())?,
                false => 0.0,
            },
            friction: forces.friction.clone().filter(|_| self.closed),
            limit: match self.closed {
                true => self.stops()?,
                false => None,
            },
        };
        let acts = own.effort.is_some()
            || own.damping > 0.0
            || own.spring.is_some()
            || own.armature > 0.0
            || own.friction.is_some()
            || own.limit.is_some();
        Ok(acts.then_some(own))
    }

    /// Where its range ends, by stops that give way.
    fn stops(&self) -> Result<Option<Located<LimitDescription>>, Diagnostic> {
        let limit = self.body.forces.limit.as_ref();
        if let Some(limit) = limit.filter(|own| matches!(own.value.kind, LimitKind::Impact { .. }))
        {
            let message = format!(
                "joint `{}`: it is part of a loop, and its limit is one of impacts",
                self.name
            );
            let error = Diagnostic::new(limit.span.clone(), message);
            return Err(error.help("give `stiffness` and `damping` in place of `restitution`"));
        }
        Ok(limit.cloned())
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
    if owners.iter().any(|owner| owner.closed) {
        let driven = linkage_motion(owners, coordinates, &mut forces);
        driven.unwrap_or_else(|error| sink.push(error));
        return forces;
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

/// Motion is prescribed of all joints of a loop that move independently, or of none.
fn linkage_motion(owners: &[Owner<'_>], coordinates: usize, forces: &mut JointForces) -> Added {
    let driven = |owner: &&Owner<'_>| owner.body.forces.motion.is_some();
    let all: Vec<&Owner<'_>> = owners.iter().filter(driven).collect();
    let mut speeds = vec![None; coordinates];
    for owner in &all {
        let Some(motion) = &owner.body.forces.motion else {
            continue;
        };
        let refuse = |what: &str| {
            let message = format!("joint `{}`: {what}", owner.name);
            Diagnostic::new(motion.span.clone(), message)
        };
        if owner.body.initial.motion != Motion::Rest {
            return Err(refuse(
                "its motion is prescribed, and so are its speeds at time 0: leave them out of its `initial`",
            ));
        }
        match speeds.get_mut(owner.link.coordinate) {
            Some(speed) if !owner.follows => {
                *speed = Some(owner.only("motion.speeds", motion)?.clone());
            }
            _ => {
                let error = refuse(
                    "its motion is prescribed, and in its loop it follows from other joints",
                );
                return Err(error.help("name it among the `independent` joints of the loop"));
            }
        }
    }
    let (Some(first), Some(motion)) = (
        all.first(),
        all.first()
            .and_then(|owner| owner.body.forces.motion.as_ref()),
    ) else {
        return Ok(());
    };
    let given = speeds.iter().flatten().count();
    let speeds: Option<Vec<TimeFunction>> = speeds.into_iter().collect();
    match speeds {
        Some(speeds) => forces.motion = Some(Located::new(speeds, motion.span.clone())),
        None => {
            let message = format!(
                "joint `{}`: motion is prescribed of {given} of the {coordinates} joints that move independently in its loop: it must be of all or of none",
                first.name
            );
            return Err(Diagnostic::new(motion.span.clone(), message));
        }
    }
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
