//! Inverse dynamics in extended numbers: what rates leave of what acts.

use super::super::Recursive;
use super::super::inverse::MOST_FREEDOMS;
use super::super::link::Link;
use crate::erased::ExtendedJoint;
use crate::scalar::Extended;
use crate::spatial::fused::dot;
use crate::spatial::{
    Pose, SpatialInertia, Symmetric3, add_weighted, join, nearest_rotation, shift_wrench, split,
};
use crate::steps::{Motion, Placement};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{Vector3, Vector6};

type E = Extended;

/// One body and its joint, in extended numbers.
#[derive(Clone, Debug)]
struct Body {
    joint: Arc<dyn ExtendedJoint>,
    parent: Option<usize>,
    configuration: Range<usize>,
    speeds: Range<usize>,
    columns: Range<usize>,
    frame: Pose<E>,
    inertia: SpatialInertia<E>,
    armature: Vec<f64>,
    /// Ports with rotors, and their inertias.
    rotors: Vec<(usize, f64)>,
}

/// The residual of one mechanism's equations, with its workspace.
#[derive(Clone, Debug)]
pub(super) struct Residual {
    bodies: Vec<Body>,
    world: Motion<E>,
    /// The same without gravity.
    still: Motion<E>,
    motions: Vec<Motion<E>>,
    wrenches: Vec<Vector6<E>>,
    columns: Vec<Vector6<E>>,
    configuration: Vec<E>,
    speeds: Vec<E>,
    /// `S̄ᵀτ` of inputs and elements, and the wrenches of elements.
    forces: Vec<f64>,
    external: Vec<Vector6<E>>,
    gathered: Vec<E>,
}

impl Body {
    fn new((index, link): (usize, &Link), tree: &Recursive) -> Self {
        let (frame, inertia) = (&link.frame, &link.inertia);
        let rotors = tree.rotors.iter().filter(|rotor| rotor.body == index);
        let rotors = rotors.map(|rotor| (rotor.port, rotor.inertia)).collect();
        Self {
            joint: Arc::clone(&link.joint).extended(),
            parent: link.parent,
            configuration: link.configuration.clone(),
            speeds: link.speeds.clone(),
            columns: link.columns.clone(),
            // A placement whose entries are doubles is a rotation to 53 bits alone.
            frame: Pose::new(
                nearest_rotation(&frame.rotation.map(E::from)),
                frame.translation.map(E::from),
            ),
            inertia: SpatialInertia {
                mass: E::from(inertia.mass),
                first_moment: inertia.first_moment.map(E::from),
                inertia: Symmetric3::from_matrix(&inertia.inertia.matrix().map(E::from)),
            },
            armature: link.armature.clone(),
            rotors,
        }
    }
}

impl Residual {
    /// Of the mechanism of `tree`.
    pub(super) fn new(tree: &Recursive) -> Self {
        let layout = tree.mechanism.layout();
        let bodies: Vec<Body> = tree
            .links
            .iter()
            .enumerate()
            .map(|own| Body::new(own, tree))
            .collect();
        let resting = |rate: Vector3<f64>| Motion {
            placement: Placement::world(),
            twist: Vector6::zeros(),
            rate: join(&Vector3::zeros(), &rate.map(E::from)),
        };
        let still = resting(Vector3::zeros());
        let zero = E::from(0.0);
        Self {
            world: resting(-tree.mechanism.gravity()),
            motions: vec![still; bodies.len()],
            wrenches: vec![Vector6::zeros(); bodies.len()],
            external: vec![Vector6::zeros(); bodies.len()],
            columns: vec![Vector6::zeros(); tree.mechanism.columns()],
            configuration: vec![zero; layout.configuration],
            speeds: vec![zero; layout.speeds],
            forces: vec![0.0; layout.speeds],
            gathered: vec![zero; layout.speeds],
            still,
            bodies,
        }
    }

    /// Takes the configuration.
    pub(super) fn place(&mut self, q: &[f64]) {
        for body in &self.bodies {
            let own = &mut self.configuration[body.configuration.clone()];
            for (exact, &entry) in own.iter_mut().zip(&q[body.configuration.clone()]) {
                *exact = E::from(entry);
            }
            // A rotation whose entries are doubles is one to 53 bits alone. Where it fails, it is NaN, and no round gains anything.
            _ = body.joint.project(own);
        }
    }

    /// Takes v̄ and what acts: what `tree` has found of it in its last accelerations, or the efforts alone where nothing else does.
    pub(super) fn load(&mut self, tree: &Recursive, speeds: &[f64], efforts: &[f64]) {
        for (own, &speed) in self.speeds.iter_mut().zip(speeds) {
            *own = E::from(speed);
        }
        if tree.plain {
            self.forces.copy_from_slice(efforts);
            return;
        }
        self.forces.copy_from_slice(&tree.forces);
        for (own, wrench) in self.external.iter_mut().zip(&tree.external) {
            *own = wrench.map(E::from);
        }
    }

    /// What the accelerations `found` leave of what acts, into `left`.
    pub(super) fn of_accelerations(&mut self, found: &[E], left: &mut [f64]) {
        let world = self.world;
        self.sweep(&world, found);
        for (own, external) in self.wrenches.iter_mut().zip(&self.external) {
            *own -= external;
        }
        self.gather(found);
        let pairs = self.forces.iter().zip(&self.gathered);
        for (left, (&force, &needed)) in left.iter_mut().zip(pairs) {
            *left = (E::from(force) - needed).high();
        }
    }

    /// What the speeds `found` leave of `momenta`, into `left`: inverse dynamics without velocities and gravity is `M̄ v̄`.
    pub(super) fn of_speeds(&mut self, momenta: &[f64], found: &[E], left: &mut [f64]) {
        self.speeds.fill(E::from(0.0));
        let still = self.still;
        self.sweep(&still, found);
        self.gather(found);
        let pairs = momenta.iter().zip(&self.gathered);
        for (left, (&momentum, &needed)) in left.iter_mut().zip(pairs) {
            *left = (E::from(momentum) - needed).high();
        }
    }

    /// Outward: how the bodies move from `world` on, and the wrench that each takes.
    fn sweep(&mut self, world: &Motion<E>, rates: &[E]) {
        for (index, body) in self.bodies.iter().enumerate() {
            let (before, rest) = self.motions.split_at_mut(index);
            let (parent, own) = (
                body.parent.map_or(world, |parent| &before[parent]),
                &mut rest[0],
            );
            let speeds = body.speeds.clone();
            let state = (
                &self.configuration[body.configuration.clone()],
                &self.speeds[speeds.clone()],
            );
            let columns = &mut self.columns[body.columns.clone()];
            body.joint.advance(state, &body.frame, parent, own, columns);
            for (column, &rate) in columns.iter().zip(&rates[speeds]) {
                own.rate = add_weighted(&own.rate, column, rate);
            }
            let inertia = body.inertia.rotated(&own.placement.rotation);
            self.wrenches[index] = inertia.wrench(&own.twist, &own.rate);
        }
    }

    /// Inward: `X̄ᵀ` of what each joint carries, and what its rotors take.
    fn gather(&mut self, rates: &[E]) {
        self.gathered.fill(E::from(0.0));
        for (index, body) in self.bodies.iter().enumerate().rev() {
            let own = body.speeds.clone();
            let mut taken = [E::from(0.0); MOST_FREEDOMS];
            let taken = &mut taken[..own.len()];
            let wrench = self.wrenches[index];
            for (taken, column) in taken.iter_mut().zip(&self.columns[body.columns.clone()]) {
                *taken = power(column, &wrench);
            }
            for (taken, (&inertia, &rate)) in taken
                .iter_mut()
                .zip(body.armature.iter().zip(&rates[own.clone()]))
            {
                *taken += E::from(inertia) * rate;
            }
            for &(port, inertia) in &body.rotors {
                let q = &self.configuration[body.configuration.clone()];
                let mut row = [E::from(0.0); MOST_FREEDOMS];
                let row = &mut row[..own.len()];
                body.joint.port_speed_row(q, port, row);
                let along = row.iter().zip(&rates[own.clone()]);
                let along = along.fold(E::from(0.0), |sum, (&p, &x)| sum + p * x);
                for (taken, entry) in taken.iter_mut().zip(row) {
                    *taken += E::from(inertia) * along * *entry;
                }
            }
            for (out, taken) in self.gathered[own].iter_mut().zip(taken) {
                *out += *taken;
            }
            if let Some(parent) = body.parent {
                self.wrenches[parent] +=
                    shift_wrench(&wrench, &self.motions[index].placement.offset);
            }
        }
    }
}

/// `Xᵀ F`.
fn power(column: &Vector6<E>, wrench: &Vector6<E>) -> E {
    let ((angular, linear), (moment, force)) = (split(column), split(wrench));
    dot(&angular, &moment) + dot(&linear, &force)
}
