//! A still picture of a motion as SVG: bodies as the page draws them, at one instant or at several.
//!
//! Solids are convex, so that the faces of one never hide each other: it is solids that are put in order, and cut where they go through each other.

mod colors;
mod order;
mod scenery;
mod solid;
mod svg;
mod view;

use super::plan::Plan;
use hamel::mechanism::Kinematics;
use hamel::spatial::Pose;
use hamel_console::files::{Draft, first_line};
use hamel_console::output::Failure;
use scenery::Scenery;
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// Instants that are kept at most to choose from.
const MOST_KEPT: usize = 512;

/// Whether a file is a picture that was written before.
pub fn is_own(file: &File) -> bool {
    first_line(file) == svg::FIRST_LINE
}

/// A picture being recorded.
pub struct Picture<'a> {
    plan: &'a Plan,
    file: Draft,
    path: &'a Path,
    kept: Kept,
}

/// The bodies at one time.
#[derive(Clone, Debug)]
struct Instant {
    time: f64,
    poses: Vec<Pose<f64>>,
}

/// Samples spread over the motion so far, and the last one.
#[derive(Debug)]
struct Kept {
    some: Vec<Instant>,
    /// Of how many samples one is kept.
    stride: usize,
    seen: usize,
    last: Option<Instant>,
}

impl<'a> Picture<'a> {
    /// Begins the file that `plan` asks for, if it asks for one.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(plan: &'a Plan) -> Result<Option<Self>, Failure> {
        let Some(output) = &plan.picture else {
            return Ok(None);
        };
        Ok(Some(Self {
            plan,
            file: output.open()?,
            path: output.path(),
            kept: Kept::new(),
        }))
    }

    /// Takes a sample.
    pub fn sample(&mut self, time: f64, kinematics: &Kinematics) {
        let poses = kinematics.bodies.iter().map(|body| body.pose).collect();
        self.kept.push(Instant { time, poses });
    }

    /// Writes the picture, and gives the file its name.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(mut self) -> Result<(), Failure> {
        let instants = self.kept.chosen(self.plan.instants);
        let scenery = Scenery::new(&self.plan.scene);
        let picture = svg::picture(&self.plan.scene.name, &scenery, &instants);
        let written = self.file.write_all(picture.as_bytes());
        written.map_err(|error| Failure::write(self.path, error))?;
        self.file.finish()
    }
}

impl Kept {
    const fn new() -> Self {
        Self {
            some: Vec::new(),
            stride: 1,
            seen: 0,
            last: None,
        }
    }

    fn push(&mut self, instant: Instant) {
        if self.seen.is_multiple_of(self.stride) {
            if self.some.len() == MOST_KEPT {
                let mut index = 0;
                self.some.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.stride *= 2;
            }
            if self.seen.is_multiple_of(self.stride) {
                self.some.push(instant.clone());
            }
        }
        self.seen += 1;
        self.last = Some(instant);
    }

    /// So many instants at equal distances from the first to the last, which is always there.
    fn chosen(&self, count: usize) -> Vec<Instant> {
        let (Some(first), Some(last)) = (self.some.first(), &self.last) else {
            return vec![];
        };
        let earlier = (0..count.saturating_sub(1)).filter_map(|k| {
            let part = k as f64 / (count - 1) as f64;
            let time = first.time + part * (last.time - first.time);
            let distance = |instant: &&Instant| (instant.time - time).abs();
            let mut some = self.some.iter();
            let start = some.next()?;
            let nearest = some.fold(start, |best, other| {
                match distance(&other) < distance(&best) {
                    true => other,
                    false => best,
                }
            });
            Some(nearest.clone())
        });
        earlier.chain([last.clone()]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Instant, Kept};

    #[test]
    fn instants_are_spread_from_the_first_to_the_last() {
        let mut kept = Kept::new();
        for sample in 0..5000 {
            let (time, poses) = (f64::from(sample), vec![]);
            kept.push(Instant { time, poses });
        }
        assert!(kept.some.len() <= super::MOST_KEPT);
        let times = |count| {
            kept.chosen(count)
                .iter()
                .map(|at| at.time)
                .collect::<Vec<_>>()
        };
        assert_eq!(times(1), [4999.0]);
        let three = times(3);
        assert_eq!((three[0], three[2]), (0.0, 4999.0));
        assert!((three[1] - 2499.5).abs() <= 16.0, "{three:?}");
    }
}
