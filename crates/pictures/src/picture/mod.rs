//! Pictures of a motion: bodies as the page draws them, at one instant or at several, as SVG or PNG, or moving as GIF.
//!
//! For SVG the faces of a solid must never hide each other: it is convex solids that are put in order, and cut where they go through each other. A picture of pixels
//! compares distances in each of them, and so shows meshes too.

mod colors;
mod order;
mod raster;
mod scenery;
mod solid;
mod stage;
mod svg;
mod view;

pub use raster::{Playing, is_gif, is_png};

use crate::meshes::Meshes;
use hamel::mechanism::Kinematics;
use hamel::scene::Scene;
use hamel::spatial::Pose;
use scenery::Scenery;
use std::io::{self, Write};

/// Width and height of a still picture, pixels.
const SIZE: (u16, u16) = (960, 640);

/// Instants that are kept at most to choose from.
const MOST_KEPT: usize = 512;

/// Whether a file with this first line is a picture as SVG that was written here.
pub fn is_svg(first_line: &str) -> bool {
    first_line == svg::FIRST_LINE
}

/// Pictures being recorded: samples spread over the motion.
#[derive(Debug)]
pub struct Pictures(Kept);

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

impl Default for Pictures {
    fn default() -> Self {
        Self(Kept::new())
    }
}

impl Pictures {
    /// Takes a sample.
    pub fn sample(&mut self, time: f64, kinematics: &Kinematics) {
        let poses = kinematics.bodies.iter().map(|body| body.pose).collect();
        self.0.push(Instant { time, poses });
    }

    /// The last sample, and before it paler ones at equal distances: as many as `instants` in all. Meshes are left out.
    pub fn svg(&self, scene: &Scene, instants: usize) -> String {
        // Faces are drawn from the farthest to the nearest, for which they have to be few and convex.
        let no_meshes = Meshes::default();
        let scenery = Scenery::new(scene, &no_meshes);
        svg::picture(&scene.name, &scenery, &self.0.chosen(instants))
    }

    /// The same as PNG, with meshes.
    ///
    /// # Errors
    /// What cannot be written.
    pub fn write_png(
        &self,
        scene: &Scene,
        meshes: &Meshes,
        instants: usize,
        file: &mut impl Write,
    ) -> io::Result<()> {
        let scenery = Scenery::new(scene, meshes).round();
        raster::write_png(&scenery, &self.0.chosen(instants), file)
    }

    /// How the motion plays as GIF.
    pub fn playing(&self) -> Playing {
        Playing::of(self.0.duration(), self.0.some.len())
    }

    /// The motion as GIF, with meshes. `told` hears how many pictures are drawn, 0 while colours are chosen, and of how many; it may end the work by an error.
    ///
    /// # Errors
    /// What cannot be written; an error of `told`.
    pub fn write_gif(
        &self,
        scene: &Scene,
        meshes: &Meshes,
        file: &mut impl Write,
        told: &mut dyn FnMut(usize, usize) -> io::Result<()>,
    ) -> io::Result<()> {
        let playing = self.playing();
        let mut instants = self.0.chosen(playing.count);
        // One sample may be the nearest of two times.
        instants.dedup_by(|a, b| a.time == b.time);
        let scenery = Scenery::new(scene, meshes).round();
        let count = instants.len();
        raster::write_gif(&scenery, &instants, playing, file, &mut |drawn| {
            told(drawn, count)
        })
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

    /// From the first instant to the last, s.
    fn duration(&self) -> f64 {
        let ends = self.some.first().zip(self.last.as_ref());
        ends.map_or(0.0, |(first, last)| last.time - first.time)
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
