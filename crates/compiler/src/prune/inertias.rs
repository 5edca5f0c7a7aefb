//! Inertias that do not affect a joint move to its parent, from the leaves to the root; what arrives at the world is dropped.
//!
//! N_X is spanned in the child frames of the joint's bodies ([`across`]). Subtracting its elements makes as many of their parameters 0 as it has
//! dimensions. What a body has for itself is constant in the parent frame in every pose, so it may be read at home; sums over bodies come with the elements.

use super::{Fixed, Link, Placed, across};
use crate::graph::{Sym, record};
use crate::joint::Joint;
use crate::model::{Body, Inertia, Model};
use crate::spatial::{Mat3, Step, Vec3};
use hamel_runtime::spatial::Pose;
use nalgebra::{Matrix3, Vector3};

/// Parameters that are made 0, those that cost most first; among equals the one with the largest entry. Of second moments squares come first: wherever an
/// axis points, one of them has an entry of at least a third.
const ORDER: [&[usize]; 4] = [&[0], &[3, 1, 2], &[6, 5, 4], &[9, 8, 7]];
/// Entries of a basis below this are rounding: of the turn that was made with it, and below this part of what is subtracted, of the difference.
const ROUNDING: f64 = 1e-14;
/// Entries of a basis below this part of the largest are not divided by: the square of a gear's ratio of a thousand.
const SMALL: f64 = 1e-6;
/// Nor are those below this part of the largest of their own element: some thousand roundings of it, which differences may have left of nothing.
const CLEAR: f64 = 1e-12;
/// A sum below this part of what was added and subtracted is rounding of some dozen terms.
const SUM_ROUNDING: f64 = 4e-15;

/// The parameters of all bodies of a joint, ten each.
type Parameters = Vec<[f64; 10]>;

/// One of them: the body, and its parameter.
type Place = (usize, usize);

/// The links with the inertias that are left to them.
pub fn rootward(model: &Model, placed: &Placed<'_>, mut links: Vec<Link>) -> Vec<Link> {
    let joints: Vec<usize> = model.joints().map(|(first, _)| first).collect();
    for first in joints.into_iter().rev() {
        let bodies = model.carried(first);
        let to_links: Vec<Pose<f64>> = bodies
            .clone()
            .map(|body| placed.moved(body).inverse())
            .collect();
        let basis = across::basis(model, first);
        let unit = basis.first().map_or(1.0, |element| element.unit);
        let in_links = basis.iter().map(|element| Moved::new(element, &to_links));
        let mut basis = reduced(in_links.collect());
        basis
            .iter_mut()
            .for_each(|(place, element)| element.in_metres(*place, unit));
        let (parts, sum) = taken(&mut links[bodies.clone()], &basis);
        let mut whole = sum.seen_from(&placed.joint_frame(first));
        for (index, part) in bodies.zip(parts) {
            let placement = Fixed::pose(&links[index].placement);
            let pose = placement
                .compose(&home(&model.bodies[index]))
                .compose(&Fixed::pose(&links[index].after));
            whole = whole.plus(&part.seen_from(&pose));
        }
        match model.bodies[first].parent {
            Some(parent) => links[parent].inertia = links[parent].inertia.plus(&whole),
            None => links[first].dropped = whole.first,
        }
    }
    links
}

/// An element of N_X by its parameters in the frames of the links, and what of it moves as a sum.
#[derive(Clone)]
struct Moved {
    bodies: Parameters,
    sum: Option<[f64; 10]>,
}

impl Moved {
    fn new(element: &across::Element, to_links: &[Pose<f64>]) -> Self {
        let bodies = element.bodies.iter().zip(to_links);
        let bodies = bodies.map(|(own, to_link)| {
            let shift = to_link.translation / element.unit;
            let to_link = Pose::new(to_link.rotation, shift);
            own.seen_from(&to_link).parameters()
        });
        let clean = |entry: f64| if entry.abs() <= ROUNDING { 0.0 } else { entry };
        Self {
            bodies: bodies.map(|own| own.map(clean)).collect(),
            sum: element.sum.map(|sum| sum.parameters()),
        }
    }

    fn entries(&mut self) -> impl Iterator<Item = &mut f64> {
        let bodies = self.bodies.as_flattened_mut().iter_mut();
        bodies.chain(self.sum.iter_mut().flatten())
    }

    /// In metres instead of units of length of so many, times what makes the parameter at its place 1 again.
    fn in_metres(&mut self, place: Place, unit: f64) {
        let factor = |n: usize| match n {
            0 => 1.0,
            1..4 => unit,
            _ => unit * unit,
        };
        let own = factor(place.1);
        let scale = |(n, entry): (usize, &mut f64)| *entry *= factor(n % 10) / own;
        self.entries().enumerate().for_each(scale);
    }

    /// The size of its largest entry.
    fn largest(&self) -> f64 {
        let entries = self.bodies.as_flattened().iter();
        entries.fold(0.0, |most, entry| most.max(entry.abs()))
    }

    fn values(&self) -> impl Iterator<Item = &f64> {
        self.bodies
            .as_flattened()
            .iter()
            .chain(self.sum.iter().flatten())
    }
}

/// The same space with a basis of which each element alone has 1 at a parameter of its own: element and parameter.
fn reduced(mut basis: Vec<Moved>) -> Vec<(Place, Moved)> {
    let mut done: Vec<(Place, Moved)> = vec![];
    for parameters in ORDER {
        while let Some((element, place)) = largest(&basis, parameters) {
            let mut pivot = basis.swap_remove(element);
            let scale = pivot.bodies[place.0][place.1];
            pivot.entries().for_each(|entry| *entry /= scale);
            let others = done.iter_mut().map(|(_, element)| element);
            for other in basis.iter_mut().chain(others) {
                let factor = other.bodies[place.0][place.1];
                for (entry, pivot) in other.entries().zip(pivot.values()) {
                    let (before, part) = (*entry, factor * pivot);
                    *entry = before - part;
                    if entry.abs() <= ROUNDING * (before.abs() + part.abs()) {
                        *entry = 0.0;
                    }
                }
                other.bodies[place.0][place.1] = 0.0;
            }
            done.push((place, pivot));
        }
    }
    done
}

/// Where the elements' largest entry at one of the parameters stands, unless all are 0: of the last body that has one worth dividing by, so that what is left is left to the first, and of
/// equals the first.
fn largest(basis: &[Moved], parameters: &[usize]) -> Option<(usize, Place)> {
    let bodies = basis.first().map_or(0, |element| element.bodies.len());
    let size = |&(n, (body, parameter)): &(usize, Place)| basis[n].bodies[body][parameter].abs();
    let of_body = |body: usize| {
        let places = parameters
            .iter()
            .flat_map(move |&parameter| (0..basis.len()).map(move |n| (n, (body, parameter))));
        let clear = places.filter(|place| size(place) > CLEAR * basis[place.0].largest());
        clear.reduce(|first, other| match size(&other) > size(&first) {
            true => other,
            false => first,
        })
    };
    let places: Vec<(usize, Place)> = (0..bodies).filter_map(of_body).collect();
    let most = places.iter().map(size).fold(0.0, f64::max);
    let worth = |place: &&(usize, Place)| size(place) > SMALL * most;
    places.iter().rev().find(worth).copied()
}

/// Leaves the links of a joint zeros at the parameters of the basis; what was taken off each that is constant in every pose, and the sum of the rest in the joint's parent frame.
fn taken(links: &mut [Link], basis: &[(Place, Moved)]) -> (Vec<Inertia>, Inertia) {
    let whole: Parameters = links.iter().map(|link| link.inertia.parameters()).collect();
    let mut left = whole.clone();
    // Sizes of what is added and subtracted, by which a sum of 0 is told.
    let mut sizes: Parameters = whole.iter().map(|own| own.map(f64::abs)).collect();
    let mut parts = vec![Inertia::zero(); links.len()];
    let mut sum = Inertia::zero();
    for ((body, parameter), element) in basis {
        let amount = whole[*body][*parameter];
        let entries = left.as_flattened_mut().iter_mut();
        let sizes = sizes.as_flattened_mut().iter_mut();
        for ((entry, size), own) in entries.zip(sizes).zip(element.bodies.as_flattened()) {
            *entry -= amount * own;
            *size += (amount * own).abs();
        }
        match &element.sum {
            Some(own) => sum = sum.plus(&Inertia::from_parameters(own).times(amount)),
            None => {
                for (part, own) in parts.iter_mut().zip(&element.bodies) {
                    *part = part.plus(&Inertia::from_parameters(own).times(amount));
                }
            }
        }
    }
    for (index, link) in links.iter_mut().enumerate() {
        let rest = |n: usize| {
            let by_basis = basis.iter().any(|(place, _)| *place == (index, n));
            let rest = left[index][n];
            match by_basis || rest.abs() <= SUM_ROUNDING * sizes[index][n] {
                true => 0.0,
                false => rest,
            }
        };
        link.inertia = Inertia::from_parameters(&std::array::from_fn(rest));
    }
    (parts, sum)
}

/// The joint's pose at home.
fn home(body: &Body) -> Pose<f64> {
    body.joint.homes.get(&body.parameters, || found(body))
}

fn found(body: &Body) -> Pose<f64> {
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
