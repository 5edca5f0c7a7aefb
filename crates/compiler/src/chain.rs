//! A chain of links on the graph: where its last frame stands in its first, the twist of the one in the other, and how that twist changes.
//!
//! From link to link a twist is carried by the link's pose and takes up the link's own motion: at rates d of the coordinates `w_i(d) = X_i w_i−1(d) + z_i d_k`, with z_i the
//! twist of link i at unit rate of its coordinate k, in its own frame. Along k, X_i w changes by the bracket `[X_i w, z_i]`. So the derivatives along directions e, f, … of the coordinates, d held, are
//!
//! ```text
//! ∂_E w_i(d) = Σ_{F ⊆ E} ad_F (X_i ∂_{E∖F} w_i−1(d)),   ad_F x = [… [x, z_i] f_k, z_i] …
//! ```
//!
//! over the sets of these directions.

use super::graph::{Sym, sin_cos};
use super::prune::Fixed;
use super::spatial::{Mat3, Step, Twist, Vec3, product, simplified};
use hamel_runtime::joint::{self, LinkMotion};
use hamel_runtime::spatial::Pose;
use num_traits::Zero;

/// Links one after the other, in numbers, and what is fixed behind the last.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chain {
    links: Vec<Link>,
    end: Vec<Fixed>,
}

#[derive(Clone, Debug, PartialEq)]
struct Link {
    before: Vec<Fixed>,
    motion: LinkMotion,
    coordinate: usize,
    ratio: f64,
    offset: f64,
}

/// A direction of the coordinates: rates of all of them.
pub(super) type Direction<'a> = &'a [Sym];

impl Chain {
    /// From the joint's parent to the child frame of a link.
    pub(super) fn of(links: &[joint::Link], body: usize) -> Self {
        let way = way(links, Some(body)).into_iter().rev();
        Self {
            links: way
                .map(|link| Link::outward(link, Fixed::steps(&link.frame)))
                .collect(),
            end: vec![],
        }
    }

    /// From the second of two frames, which are fixed in the child frames of links, or in the joint's parent, to the first: along the links that do not carry both.
    pub(super) fn between(
        links: &[joint::Link],
        ends: [Option<usize>; 2],
        frames: &[Pose<f64>; 2],
    ) -> Self {
        let [mut outward, mut inward] = ends.map(|end| way(links, end));
        while let (Some(a), Some(b)) = (outward.last(), inward.last()) {
            if !std::ptr::eq(*a, *b) {
                break;
            }
            outward.pop();
            inward.pop();
        }
        let mut fixed = inverse(&frames[1]);
        let mut all = vec![];
        for link in inward {
            let own = Link::outward(link, fixed);
            all.push(Link {
                ratio: -own.ratio,
                offset: -own.offset,
                ..own
            });
            fixed = inverse(&link.frame);
        }
        for link in outward.into_iter().rev() {
            fixed.extend(Fixed::steps(&link.frame));
            all.push(Link::outward(link, std::mem::take(&mut fixed)));
        }
        fixed.extend(Fixed::steps(&frames[0]));
        Self {
            links: all,
            end: fixed,
        }
    }

    /// Whether it is one link alone.
    pub(super) fn is_one_link(&self) -> bool {
        self.links.len() == 1
    }

    /// The pose of its last frame in its first, in factors.
    pub(super) fn pose(&self, q: &[Sym]) -> Vec<Step> {
        let links = self.links.iter().flat_map(|link| link.steps(q));
        simplified(links.chain(self.end.iter().map(Fixed::step)))
    }

    /// The rotation of that.
    pub(super) fn rotation(&self, q: &[Sym]) -> Mat3 {
        let steps = self.pose(q);
        let matrix = |step: &Step| {
            let columns = [0, 1, 2].map(|i| {
                let unit = Vec3::from_fn(|j, _| Sym::from(f64::from(u8::from(i == j))));
                step.to_parent(&unit)
            });
            Mat3::from_columns(&columns)
        };
        let identity = Mat3::from_fn(|i, j| Sym::from(f64::from(u8::from(i == j))));
        let turns = steps.iter().filter(|step| !matches!(step, Step::Shift(_)));
        turns.fold(identity, |all, step| product(&all, &matrix(step)))
    }

    /// The twist of its last frame in its first at rates `d`, in the axes of the last, differentiated along each of the directions.
    pub(super) fn twist(&self, q: &[Sym], d: Direction<'_>, along: &[Direction<'_>]) -> Twist {
        // By sets of directions, one bit each.
        let mut twists = vec![Twist::zero(); 1 << along.len()];
        for link in &self.links {
            let steps = simplified(link.steps(q));
            let carried: Vec<Twist> = twists.iter().map(|twist| carried(&steps, twist)).collect();
            let (axis, k) = (link.axis(), link.coordinate);
            for (set, twist) in twists.iter_mut().enumerate() {
                let turned = |turning: &usize| {
                    let directions = along.iter().enumerate();
                    let turning = directions.filter(|(n, _)| turning >> n & 1 == 1);
                    let still = turning.clone().fold(set, |set, (n, _)| set & !(1 << n));
                    turning.fold(carried[still].clone(), |twist, (_, direction)| {
                        twist.bracket(&axis).times(direction[k])
                    })
                };
                let own = match set {
                    0 => axis.times(d[k]),
                    _ => Twist::zero(),
                };
                let parts = (0..=set).filter(|turning| turning & !set == 0);
                *twist = parts.fold(own, |sum, turning| sum.plus(&turned(&turning)));
            }
        }
        let end: Vec<Step> = simplified(self.end.iter().map(Fixed::step));
        twists
            .pop()
            .map_or_else(Twist::zero, |twist| carried(&end, &twist))
    }
}

/// A link and those that it hangs on, itself first.
fn way(links: &[joint::Link], mut at: Option<usize>) -> Vec<&joint::Link> {
    let mut way = vec![];
    while let Some(link) = at.and_then(|at| links.get(at)) {
        way.push(link);
        at = link.before;
    }
    way
}

/// A twist, read at the first frame of a placement, at its last.
fn carried(steps: &[Step], twist: &Twist) -> Twist {
    steps
        .iter()
        .fold(twist.clone(), |twist, step| step.twist_to_child(&twist))
}

/// The factors of the inverse of a pose.
fn inverse(pose: &Pose<f64>) -> Vec<Fixed> {
    let steps = Fixed::steps(pose).into_iter().rev();
    let inverse = |step| match step {
        Fixed::Shift(by) => Fixed::Shift(-by),
        Fixed::Turn(axis, cos, sin) => Fixed::Turn(axis, cos, -sin),
    };
    steps.map(inverse).collect()
}

impl Link {
    /// A link of a joint, behind these fixed factors.
    fn outward(link: &joint::Link, before: Vec<Fixed>) -> Self {
        Self {
            before,
            motion: link.motion,
            coordinate: link.coordinate,
            ratio: link.ratio,
            offset: link.offset,
        }
    }

    /// From its own frame to that of what it hangs on, in factors.
    fn steps(&self, q: &[Sym]) -> Vec<Step> {
        let y = Sym::from(self.ratio) * q[self.coordinate] + Sym::from(self.offset);
        let motion = match self.motion {
            LinkMotion::Slide => Step::Shift(Vec3::new(Sym::zero(), Sym::zero(), y)),
            LinkMotion::Turn => {
                let (sin, cos) = sin_cos(y);
                Step::Turn { axis: 2, cos, sin }
            }
        };
        let before = self.before.iter().map(Fixed::step);
        before.chain([motion]).collect()
    }

    /// Its twist at unit rate of its coordinate, in its own frame.
    fn axis(&self) -> Twist {
        let mut twist = Twist::zero();
        *twist.entry_mut(match self.motion {
            LinkMotion::Turn => 2,
            LinkMotion::Slide => 5,
        }) = Sym::from(self.ratio);
        twist
    }
}
