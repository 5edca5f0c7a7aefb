//! From where instants are drawn, in which light, and on which ground.

use super::Instant;
use super::scenery::Scenery;
use super::view::{Ball, View, across};
use nalgebra::Vector3;

/// Opacity of shadows, of the grid, and of each part of it.
pub const SHADOW: f64 = 0.16;
pub const GRID: f64 = 0.75;
pub const GRID_PART: f64 = 0.4;

/// Width of the lines of the grid, pixels of a picture of the size [`super::SIZE`].
pub const LINE: f64 = 0.9;

/// Squares of the grid from its middle to its end.
const REACH: i32 = 16;

/// The ends of a line.
pub type Line = [Vector3<f64>; 2];

/// What all instants of a picture have in common.
#[derive(Clone, Debug)]
pub struct Stage {
    pub view: View,
    pub up: Vector3<f64>,
    /// Direction to the light.
    light: Vector3<f64>,
    /// Of the mechanism at the last instant, m.
    pub size: f64,
    /// Height of the ground, m; none where it is far below.
    pub ground: Option<f64>,
}

/// Opacity of the earlier instant `index` of `count`.
pub fn ghost(index: usize, count: usize) -> f64 {
    0.12 + 0.3 * (index + 1) as f64 / (count + 1) as f64
}

impl Stage {
    /// On which all `instants` are seen, in a picture so many times wider than high.
    pub fn of(scenery: &Scenery, instants: &[Instant], aspect: f64) -> Self {
        let balls = instants.iter().flat_map(|instant| scenery.balls(instant));
        let balls: Vec<Ball> = balls.collect();
        let size = instants
            .last()
            .map_or(1.0, |last| radius(&scenery.balls(last)));
        let up = scenery.up;
        let view = View::on(&balls, &up, aspect);
        Self {
            light: view.light(&up),
            view,
            size,
            ground: ground(&balls, &up, size),
            up,
        }
    }

    /// The factor of a colour in the light, of a face with this unit vector outwards.
    pub fn lit(&self, normal: &Vector3<f64>) -> f64 {
        0.68 + 0.14 * normal.dot(&self.up) + 0.34 * normal.dot(&self.light).max(0.0)
    }

    /// Where the shadow of a point is.
    pub fn shadow(&self, point: &Vector3<f64>, ground: f64) -> Vector3<f64> {
        let height = (self.up.dot(point) - ground).max(0.0);
        point - self.light * (height / self.light.dot(&self.up))
    }

    /// Squares on the ground, 1, 2 or 5 times a power of ten wide. The lines are in three parts, each nearer to the middle, which are drawn one over the other.
    pub fn grid(&self, ground: f64) -> [Vec<Line>; 3] {
        let wide = 0.12 * self.view.distance();
        let power = 10.0_f64.powf(wide.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
        let step = step.into_iter().find(|step| *step >= wide).unwrap_or(wide);
        let front = across(&self.up);
        let left = self.up.cross(&front);
        let axes = [front, left];
        let middle = axes.map(|axis| (self.view.target.dot(&axis) / step).round());
        [1.0, 0.75, 0.5].map(|reach| {
            let mut lines = vec![];
            for line in -REACH..=REACH {
                let across = f64::from(line);
                let half = (f64::from(REACH) * reach).powi(2) - across * across;
                if half <= 0.0 {
                    continue;
                }
                for axis in 0..2 {
                    let end = |along: f64| {
                        let mut at = [middle[0], middle[1]];
                        at[axis] += along;
                        at[1 - axis] += across;
                        (axes[0] * at[0] + axes[1] * at[1]) * step + self.up * ground
                    };
                    lines.extend(self.before_eye([end(-half.sqrt()), end(half.sqrt())]));
                }
            }
            lines
        })
    }

    /// The part of a line that is before the eye.
    fn before_eye(&self, [a, b]: Line) -> Option<Line> {
        let near = self.view.near();
        let depths = (self.view.depth(&a), self.view.depth(&b));
        let cut = || a + (b - a) * ((near - depths.0) / (depths.1 - depths.0));
        match (depths.0 < near, depths.1 < near) {
            (true, true) => None,
            (true, false) => Some([cut(), b]),
            (false, true) => Some([a, cut()]),
            (false, false) => Some([a, b]),
        }
    }
}

/// Radius of a ball about the middle of balls.
fn radius(balls: &[Ball]) -> f64 {
    let middle = balls.iter().map(|ball| ball.0).sum::<Vector3<f64>>() / balls.len() as f64;
    let reach = balls
        .iter()
        .map(|(place, radius)| (place - middle).norm() + radius);
    reach.fold(1e-9, f64::max)
}

/// Height of the ground as on the page: that of the origin, or below everything; none where that is far below.
fn ground(balls: &[Ball], up: &Vector3<f64>, size: f64) -> Option<f64> {
    let heights = balls.iter().map(|(place, radius)| up.dot(place) - radius);
    let lowest = heights.fold(f64::INFINITY, f64::min);
    let ground = if lowest < -0.02 * size { lowest } else { 0.0 };
    (lowest - ground <= 6.0 * size).then_some(ground)
}
