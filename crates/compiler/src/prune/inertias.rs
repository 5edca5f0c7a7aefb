//! Inertias that do not affect a joint move to its parent, from the leaves to the root; what arrives at the world is dropped.
//!
//! N_X is spanned in the joint's child frame (`Derived::unidentifiable`). Subtracting its elements makes as many of the ten parameters of a
//! body 0 as it has dimensions. N is constant also in the parent frame, so it may be read at home.

use super::{Fixed, Link, Placed};
use crate::graph::{Sym, record};
use crate::joint::Joint;
use crate::model::{Body, Inertia, Model};
use crate::spatial::{Mat3, Step, Vec3};
use hamel_runtime::spatial::Pose;
use nalgebra::{Matrix3, Vector3};
use num_traits::ToPrimitive;

/// Parameters that are made 0, those that cost most first; among equals the one with the largest entry. Of second moments squares come first: wherever an
/// axis points, one of them has an entry of at least a third.
const ORDER: [&[usize]; 4] = [&[0], &[3, 1, 2], &[6, 5, 4], &[9, 8, 7]];
/// Elements of a basis below this are rounding of the turn that was made with it.
const ROUNDING: f64 = 1e-14;

/// The links with the inertias that are left to them.
pub fn rootward(model: &Model, placed: &Placed<'_>, mut links: Vec<Link>) -> Vec<Link> {
    for (index, body) in model.bodies.iter().enumerate().rev() {
        let to_link = placed.moved(index).inverse();
        let basis = reduced(basis(body, &to_link));
        let (rest, moved) = taken(&links[index].inertia, &basis);
        links[index].inertia = rest;
        let placement = Fixed::pose(&links[index].placement);
        let pose = placement
            .compose(&home(body))
            .compose(&Fixed::pose(&links[index].after));
        let moved = moved.seen_from(&pose);
        match body.parent {
            Some(parent) => links[parent].inertia = links[parent].inertia.plus(&moved),
            None => links[index].dropped = moved.first,
        }
    }
    links
}

/// A basis of N_X in the frame of the link, by parameters.
fn basis(body: &Body, to_link: &Pose<f64>) -> Vec<[f64; 10]> {
    let element = |element: &[hamel_codegen::expr::Rational; 10]| {
        let parameters = std::array::from_fn(|i| element[i].to_f64().unwrap_or(0.0));
        let moved = Inertia::from_moments_of_inertia(&parameters)
            .seen_from(to_link)
            .parameters();
        moved.map(|entry| if entry.abs() <= ROUNDING { 0.0 } else { entry })
    };
    body.joint
        .derived
        .unidentifiable
        .iter()
        .map(element)
        .collect()
}

/// The same space with a basis of which each element alone has 1 at a parameter of its own: element and parameter.
fn reduced(mut basis: Vec<[f64; 10]>) -> Vec<(usize, [f64; 10])> {
    let mut done: Vec<(usize, [f64; 10])> = vec![];
    for parameters in ORDER {
        while let Some((element, parameter)) = largest(&basis, parameters) {
            let pivot = basis.swap_remove(element);
            let pivot = pivot.map(|entry| entry / pivot[parameter]);
            let others = basis
                .iter_mut()
                .chain(done.iter_mut().map(|(_, element)| element));
            for other in others {
                let factor = other[parameter];
                for (entry, pivot) in other.iter_mut().zip(pivot) {
                    *entry -= factor * pivot;
                }
                other[parameter] = 0.0;
            }
            done.push((parameter, pivot));
        }
    }
    done
}

/// Where the elements' largest entry at one of the parameters stands, unless all are 0: the first of equals.
fn largest(basis: &[[f64; 10]], parameters: &[usize]) -> Option<(usize, usize)> {
    let places = parameters
        .iter()
        .flat_map(|&parameter| (0..basis.len()).map(move |element| (element, parameter)));
    let size = |&(element, parameter): &(usize, usize)| basis[element][parameter].abs();
    let largest = places.reduce(|first, other| match size(&other) > size(&first) {
        true => other,
        false => first,
    });
    largest.filter(|place| size(place) != 0.0)
}

/// What is left of an inertia, with zeros at the parameters of the basis, and what was taken.
fn taken(inertia: &Inertia, basis: &[(usize, [f64; 10])]) -> (Inertia, Inertia) {
    let whole = inertia.parameters();
    let moved = basis
        .iter()
        .fold(Inertia::zero(), |sum, (parameter, element)| {
            sum.plus(&Inertia::from_parameters(element).times(whole[*parameter]))
        });
    let mut rest = inertia.plus(&moved.times(-1.0)).parameters();
    for (parameter, _) in basis {
        rest[*parameter] = 0.0;
    }
    (Inertia::from_parameters(&rest), moved)
}

/// The joint's pose at home.
fn home(body: &Body) -> Pose<f64> {
    let (pose, _) = record(|| {
        let joint = Joint::new(&body.joint, &body.parameters, &[], &[]);
        let home = joint.home();
        let joint = Joint::new(&body.joint, &body.parameters, &home, &[]);
        let steps = joint.pose();
        let numbers = |step: &Step| match step {
            Step::Shift(by) => Pose::from_translation(vector(by)),
            step => {
                let columns = [0, 1, 2].map(|i| {
                    let mut unit = Vec3::from_element(Sym::Number(0.0));
                    unit[i] = Sym::Number(1.0);
                    vector(&step.to_parent(&unit))
                });
                Pose::from_rotation(Matrix3::from_columns(&columns))
            }
        };
        steps
            .iter()
            .map(numbers)
            .fold(Pose::identity(), |pose, step| pose.compose(&step))
    });
    pose
}

fn vector(a: &Vec3) -> Vector3<f64> {
    a.map(|entry| entry.number().unwrap_or(f64::NAN))
}

impl Fixed {
    /// The same on the graph.
    pub fn step(&self) -> Step {
        match *self {
            Self::Shift(by) => Step::Shift(by.map(Sym::from)),
            Self::Turn(axis, cos, sin) => Step::known_turn(axis, cos, sin),
        }
    }
}

impl Inertia {
    /// The same on the graph.
    pub fn on_graph(&self) -> crate::spatial::Rigid {
        crate::spatial::Rigid {
            mass: self.mass.into(),
            first: self.first.map(Sym::from),
            second: Mat3::from_fn(|i, j| self.second[(i, j)].into()),
        }
    }
}
