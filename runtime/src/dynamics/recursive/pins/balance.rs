//! The balance of the bodies of a joint, for the forces at its pins: six equations a body, by complete elimination.

use super::{PinForce, Placed};
use crate::spatial::split;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Vector3, Vector6};

/// A pivot that is less than this part of the largest entry is none: beyond, half the digits would be lost.
const SINGULAR: f64 = 1.5e-8;

/// Equations in the components that the pins can carry. Moments are about one point, over one length, so that all entries are about 1.
pub(super) struct Balance {
    /// The point.
    about: Vector3<f64>,
    /// The length, m.
    length: f64,
    /// By rows; the right side last.
    rows: Vec<Vec<f64>>,
    unknowns: usize,
}

/// What is known of the pins.
pub(super) struct Solution {
    /// How many motions of the bodies the pins allow.
    pub(super) motions: usize,
    pub(super) forces: Vec<PinForce>,
}

impl Balance {
    /// Of so many bodies, within a length, m.
    pub(super) fn new(bodies: usize, pins: &[Placed], length: f64) -> Self {
        let about = pins.first().map_or(Vector3::zeros(), |placed| placed.point);
        let carried = pins.iter().map(|placed| {
            let [forces, moments] = placed.carries();
            forces.len() + moments.len()
        });
        let unknowns = carried.sum();
        let mut balance = Self {
            about,
            length,
            rows: vec![vec![0.0; unknowns + 1]; 6 * bodies],
            unknowns,
        };
        let mut column = 0;
        for placed in pins {
            let [forces, moments] = placed.carries();
            let arm = placed.point - about;
            for force in forces {
                balance.add(placed, column, &(arm.cross(&force), force));
                column += 1;
            }
            for moment in moments {
                let moment = moment * balance.length;
                balance.add(placed, column, &(moment, Vector3::zeros()));
                column += 1;
            }
        }
        balance
    }

    /// A moment and a force of the second body of a pin on the first, into a column.
    fn add(
        &mut self,
        placed: &Placed,
        column: usize,
        (moment, force): &(Vector3<f64>, Vector3<f64>),
    ) {
        for (body, sign) in placed.pin.bodies.into_iter().zip([1.0, -1.0]) {
            let Some(body) = body else { continue };
            for i in 0..3 {
                self.rows[6 * body + i][column] += sign * moment[i] / self.length;
                self.rows[6 * body + 3 + i][column] += sign * force[i];
            }
        }
    }

    /// What the joint exerts on a body: moment about the origin, and force.
    pub(super) fn exert(&mut self, body: usize, wrench: &Vector6<f64>) {
        let (moment, force) = split(wrench);
        let moment = moment - self.about.cross(&force);
        for i in 0..3 {
            self.rows[6 * body + i][self.unknowns] += moment[i] / self.length;
            self.rows[6 * body + 3 + i][self.unknowns] += force[i];
        }
    }

    /// A couple and a force of the second body of a pin on the first that are known.
    pub(super) fn drive(&mut self, placed: &Placed, [couple, force]: &[Vector3<f64>; 2]) {
        let arm = placed.point - self.about;
        let moment = couple + arm.cross(force);
        self.add(placed, self.unknowns, &(-moment, -force));
    }

    /// The components, NaN where they are not determined.
    pub(super) fn solve(mut self, pins: &[Placed]) -> Solution {
        let pivots = self.eliminate();
        let is_pivot = |column: &usize| pivots.contains(column);
        let free: Vec<usize> = (0..self.unknowns).filter(|c| !is_pivot(c)).collect();
        // Each unknown as a number, and how it changes with those that are free.
        let mut numbers = vec![0.0; self.unknowns];
        let mut slopes = vec![vec![0.0; free.len()]; self.unknowns];
        for (row, &column) in self.rows.iter().zip(&pivots) {
            numbers[column] = row[self.unknowns];
            let others = free.iter().map(|&other| -row[other]);
            slopes[column] = others.collect();
        }
        for (n, &column) in free.iter().enumerate() {
            slopes[column][n] = 1.0;
        }
        Solution {
            motions: self.rows.len() - pivots.len(),
            forces: self.forces(pins, &numbers, &slopes),
        }
    }

    /// Gauss and Jordan with complete pivoting; the columns of the pivots, one for each of the first rows.
    fn eliminate(&mut self) -> Vec<usize> {
        let entries = self.rows.iter().flat_map(|row| &row[..self.unknowns]);
        let largest = entries.fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        let mut pivots: Vec<usize> = Vec::new();
        while let Some((row, column, size)) = self.largest_from(pivots.len(), &pivots) {
            if size <= SINGULAR * largest {
                break;
            }
            let place = pivots.len();
            self.rows.swap(place, row);
            let pivot = self.rows[place][column];
            self.rows[place]
                .iter_mut()
                .for_each(|entry| *entry /= pivot);
            let own = self.rows[place].clone();
            for (n, other) in self.rows.iter_mut().enumerate() {
                let factor = other[column];
                if n != place && factor != 0.0 {
                    let pairs = other.iter_mut().zip(&own);
                    pairs.for_each(|(entry, own)| *entry -= factor * own);
                    other[column] = 0.0;
                }
            }
            pivots.push(column);
        }
        pivots
    }

    /// The entry of largest size from that row on, in columns without a pivot.
    fn largest_from(&self, first: usize, pivots: &[usize]) -> Option<(usize, usize, f64)> {
        let rows = self.rows.iter().enumerate().skip(first);
        let entries = rows.flat_map(|(i, row)| {
            let entries = row[..self.unknowns].iter().enumerate();
            let left = entries.filter(|(j, _)| !pivots.contains(j));
            left.map(move |(j, entry)| (i, j, entry.abs()))
        });
        entries.reduce(|best, other| if other.2 > best.2 { other } else { best })
    }

    fn forces(&self, pins: &[Placed], numbers: &[f64], slopes: &[Vec<f64>]) -> Vec<PinForce> {
        let mut first = 0;
        let mut next = |directions: &[Vector3<f64>], unit: f64| {
            let own = first..first + directions.len();
            first = own.end;
            let component = |i: usize| {
                let weights = || directions.iter().map(|d| d[i]).zip(own.clone());
                let mut free = 0..slopes.first().map_or(0, Vec::len);
                let is_free = free.any(|n| {
                    let slope: f64 = weights().map(|(weight, j)| weight * slopes[j][n]).sum();
                    slope.abs() > SINGULAR
                });
                match is_free {
                    true => f64::NAN,
                    false => {
                        unit * weights()
                            .map(|(weight, j)| weight * numbers[j])
                            .sum::<f64>()
                    }
                }
            };
            Vector3::from_fn(|i, _| component(i))
        };
        let told = pins.iter().map(|placed| {
            let [forces, moments] = placed.carries();
            let force = next(&forces, 1.0);
            let moment = next(&moments, self.length);
            PinForce { force, moment }
        });
        told.collect()
    }
}
