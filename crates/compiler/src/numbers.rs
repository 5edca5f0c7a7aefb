//! The numbers of a pruned model in a fixed order, and what else of it equations depend on.
//!
//! Two models with the same [`Shape`] have the same equations except for their [`numbers`]. So the equations of many scenes that differ in numbers can be written once, with what
//! differs given later.

use super::model::{Body, Elements, Model};
use super::prune::{Fixed, Link};
use hamel_runtime::elements::WrenchAxes;
use nalgebra::{Matrix3, Vector3};
use std::rc::Rc;

/// What is no number of a pruned model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shape {
    codes: Vec<usize>,
    /// Joint types by their names, one a body.
    joints: Vec<String>,
}

/// The numbers of a pruned model that its equations of motion read: gravity; of each body parameters, rotors, dampers and constant efforts; of springs, dampers and wrenches
/// theirs; of each link its placement, its frame and its inertia.
pub fn numbers(model: &mut Model, links: &mut [Link], all: &mut Vec<f64>) {
    each(model, links, &mut |number| all.push(*number));
}

/// Puts these numbers in place of those of the model; what is missing stays.
pub fn replace(model: &mut Model, links: &mut [Link], numbers: &[f64]) {
    let mut numbers = numbers.iter();
    each(model, links, &mut |own| {
        if let Some(number) = numbers.next() {
            *own = *number;
        }
    });
}

/// Visits all numbers.
fn each(model: &mut Model, links: &mut [Link], see: &mut impl FnMut(&mut f64)) {
    vector(&mut model.gravity, see);
    for body in &mut model.bodies {
        let Body {
            parameters,
            armature,
            port_armature,
            damping,
            effort,
            ..
        } = body;
        for list in [parameters, armature, port_armature, damping, effort] {
            list.iter_mut().for_each(&mut *see);
        }
    }
    elements(&mut model.elements, see);
    links.iter_mut().for_each(|own| link(own, see));
}

fn elements(all: &mut Elements, see: &mut impl FnMut(&mut f64)) {
    for spring in &mut all.joint_springs {
        spring.stiffness.iter_mut().for_each(&mut *see);
        spring.rest.iter_mut().for_each(&mut *see);
    }
    for spring in &mut all.rotation_springs {
        see(&mut spring.stiffness);
        matrix(&mut spring.rest, see);
    }
    for spring in &mut all.springs {
        spring
            .points
            .iter_mut()
            .for_each(|point| vector(point, see));
        see(&mut spring.stiffness);
        see(&mut spring.damping);
        see(&mut spring.length);
    }
    for spring in &mut all.port_springs {
        see(&mut spring.stiffness);
        see(&mut spring.damping);
        see(&mut spring.rest);
    }
    for wrench in &mut all.wrenches {
        vector(&mut wrench.point, see);
        vector(&mut wrench.force, see);
        vector(&mut wrench.moment, see);
    }
}

fn link(link: &mut Link, see: &mut impl FnMut(&mut f64)) {
    for step in link.placement.iter_mut().chain(&mut link.after) {
        match step {
            Fixed::Shift(by) => vector(by, see),
            Fixed::Turn(_, cos, sin) => {
                see(cos);
                see(sin);
            }
        }
    }
    matrix(&mut link.body.rotation, see);
    vector(&mut link.body.translation, see);
    see(&mut link.inertia.mass);
    vector(&mut link.inertia.first, see);
    // Symmetric: the upper triangle stands for both.
    for (i, j) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
        let entry = &mut link.inertia.second[(i, j)];
        see(entry);
        link.inertia.second[(j, i)] = link.inertia.second[(i, j)];
    }
}

fn vector(vector: &mut Vector3<f64>, see: &mut impl FnMut(&mut f64)) {
    vector.iter_mut().for_each(see);
}

fn matrix(matrix: &mut Matrix3<f64>, see: &mut impl FnMut(&mut f64)) {
    matrix.iter_mut().for_each(see);
}

impl Shape {
    /// That of a pruned model.
    pub fn of(model: &Model, links: &[Link]) -> Self {
        let mut codes = Vec::new();
        for body in &model.bodies {
            codes.extend([
                body.parent.map_or(0, |parent| parent + 1),
                usize::from(body.driven),
            ]);
            let lists = [
                &body.parameters,
                &body.armature,
                &body.port_armature,
                &body.damping,
                &body.effort,
            ];
            codes.extend(lists.map(Vec::len));
        }
        of_elements(&model.elements, &mut codes);
        codes.push(model.coupling.constraints.len());
        for link in links {
            codes.extend([link.placement.len(), link.after.len()]);
            let steps = link.placement.iter().chain(&link.after);
            codes.extend(steps.map(|step| match step {
                Fixed::Shift(_) => 3,
                Fixed::Turn(axis, ..) => *axis,
            }));
        }
        let kind = |body: &Body| Rc::clone(&body.joint).derived.spec.name.value.clone();
        Self {
            codes,
            joints: model.bodies.iter().map(kind).collect(),
        }
    }
}

fn of_elements(all: &Elements, codes: &mut Vec<usize>) {
    let end = |body: Option<usize>| body.map_or(0, |body| body + 1);
    let lists = [
        all.joint_springs.len(),
        all.rotation_springs.len(),
        all.springs.len(),
        all.limits.len(),
        all.port_efforts.len(),
        all.port_springs.len(),
        all.wrenches.len(),
    ];
    codes.extend(lists);
    for spring in &all.joint_springs {
        codes.extend([spring.body, spring.stiffness.len(), spring.rest.len()]);
    }
    codes.extend(all.rotation_springs.iter().map(|spring| spring.body));
    codes.extend(all.springs.iter().flat_map(|spring| spring.bodies.map(end)));
    codes.extend(
        all.port_springs
            .iter()
            .flat_map(|spring| [spring.body, spring.port]),
    );
    for wrench in &all.wrenches {
        codes.extend([wrench.body, usize::from(wrench.axes == WrenchAxes::World)]);
    }
}
