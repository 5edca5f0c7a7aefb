//! Kernels of a body that hangs on other links of its coupling, on the graph: products of the links' motions.
//!
//! With a_i the twist of link i at unit rate of its coordinate k(i), in the frame of the body, X^c is their sum in the columns k(i). Along ϕ_l it changes by
//! `∂a_i/∂ϕ_l = [a_i, b_il]`, where b_il is the sum of the a_j behind i that follow q_l.

use super::graph::{Sym, sin_cos};
use super::prune::Fixed;
use super::spatial::{Mat3, Step, Twist, Vec3, Wrench, product, simplified};
use hamel_runtime::joint::LinkMotion;
use hamel_scene::Coupling;
use num_traits::Zero;

/// The links from the joint's parent to a body, in numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chain {
    links: Vec<Link>,
    coordinates: usize,
}

#[derive(Clone, Debug, PartialEq)]
struct Link {
    frame: Vec<Fixed>,
    motion: LinkMotion,
    coordinate: usize,
    ratio: f64,
    offset: f64,
}

/// A twist at unit rate of a coordinate.
type Axis = (usize, Twist);

impl Chain {
    /// That of a body of a coupling; `None` of one that hangs on the joint's parent.
    pub(super) fn of(coupling: &Coupling, body: usize) -> Option<Self> {
        let mut links = vec![];
        let mut at = Some(body);
        while let Some(link) = at.and_then(|at| coupling.links.get(at)) {
            links.push(Link {
                frame: Fixed::steps(&link.frame),
                motion: link.motion,
                coordinate: link.coordinate,
                ratio: link.ratio,
                offset: link.offset,
            });
            at = link.before;
        }
        links.reverse();
        (links.len() > 1).then(|| Self {
            links,
            coordinates: coupling.coordinates(),
        })
    }

    /// H(Q) in factors.
    pub(super) fn pose(&self, q: &[Sym]) -> Vec<Step> {
        simplified(self.links.iter().flat_map(|link| link.steps(q)))
    }

    /// The rotation of H(Q).
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

    /// The a_i, from the parent's side.
    fn axes(&self, q: &[Sym]) -> Vec<Axis> {
        let mut axes: Vec<Axis> = vec![];
        for link in &self.links {
            let steps = simplified(link.steps(q));
            for (_, axis) in &mut axes {
                *axis = steps
                    .iter()
                    .fold(axis.clone(), |twist, step| step.twist_to_child(&twist));
            }
            axes.push((link.coordinate, link.axis()));
        }
        axes
    }

    /// Sums of twists by coordinate.
    fn columns(&self, parts: impl IntoIterator<Item = Axis>) -> Vec<Twist> {
        let mut columns = vec![Twist::zero(); self.coordinates];
        for (k, twist) in parts {
            columns[k] = columns[k].plus(&twist);
        }
        columns
    }

    /// The columns of X^c, and of X^c S₀.
    pub(super) fn twists(&self, q: &[Sym]) -> Vec<Twist> {
        self.columns(self.axes(q))
    }

    /// The columns of X.
    pub(super) fn twists_in_parent(&self, q: &[Sym]) -> Vec<Twist> {
        let steps = self.pose(q);
        let to_parent = |twist: Twist| {
            steps.iter().rev().fold(twist, |twist, step| match step {
                Step::Shift(by) => Twist {
                    linear: twist.linear + super::spatial::cross(by, &twist.angular),
                    angular: twist.angular,
                },
                _ => Twist {
                    angular: step.to_parent(&twist.angular),
                    linear: step.to_parent(&twist.linear),
                },
            })
        };
        self.twists(q).into_iter().map(to_parent).collect()
    }

    /// ∂(X^c x)/∂ϕ, one column per coordinate.
    pub(super) fn gradient(&self, q: &[Sym], x: &[Sym]) -> Vec<Twist> {
        let axes = self.axes(q);
        let along = |l: usize| {
            let parts = axes.iter().enumerate();
            let parts = parts.map(|(i, (k, _))| along(&axes, i, l).times(x[*k]));
            parts.fold(Twist::zero(), |sum, part| sum.plus(&part))
        };
        (0..self.coordinates).map(along).collect()
    }

    /// ∂(X^cᵀ h)/∂ϕ by rows, one per coordinate.
    pub(super) fn effort_gradient(&self, q: &[Sym], wrench: &Wrench) -> Vec<Vec<Sym>> {
        let axes = self.axes(q);
        let entry = |k: usize, l: usize| {
            let own = axes.iter().enumerate().filter(|(_, axis)| axis.0 == k);
            own.map(|(i, _)| along(&axes, i, l).dot(wrench)).sum()
        };
        let row = |k: usize| (0..self.coordinates).map(|l| entry(k, l)).collect();
        (0..self.coordinates).map(row).collect()
    }

    /// `c = Ẋ^c v`.
    pub(super) fn bias(&self, q: &[Sym], v: &[Sym]) -> Twist {
        let axes = self.axes(q);
        let parts = axes.iter().enumerate();
        let parts = parts.map(|(i, (k, axis))| axis.bracket(&carried(&axes, i, v)).times(v[*k]));
        parts.fold(Twist::zero(), |sum, part| sum.plus(&part))
    }

    /// `Ẋ^cᵀ h`, one per coordinate.
    pub(super) fn bias_momentum(&self, q: &[Sym], v: &[Sym], momentum: &Wrench) -> Vec<Sym> {
        let axes = self.axes(q);
        let mut all = vec![Sym::zero(); self.coordinates];
        for (i, (k, axis)) in axes.iter().enumerate() {
            all[*k] += axis.bracket(&carried(&axes, i, v)).dot(momentum);
        }
        all
    }

    /// ∂c/∂v, one column per coordinate.
    pub(super) fn bias_slope(&self, q: &[Sym], v: &[Sym]) -> Vec<Twist> {
        let axes = self.axes(q);
        let mut parts = vec![];
        for (i, (k, axis)) in axes.iter().enumerate() {
            parts.push((*k, axis.bracket(&carried(&axes, i, v))));
            for (l, behind) in &axes[i + 1..] {
                parts.push((*l, axis.bracket(behind).times(v[*k])));
            }
        }
        self.columns(parts)
    }

    /// ∂c/∂ϕ, one column per coordinate.
    pub(super) fn bias_gradient(&self, q: &[Sym], v: &[Sym]) -> Vec<Twist> {
        let axes = self.axes(q);
        let column = |l: usize| {
            let parts = axes.iter().enumerate().map(|(i, (k, axis))| {
                let behind = axes.iter().enumerate().skip(i + 1);
                let moved = behind.fold(Twist::zero(), |sum, (j, (k, _))| {
                    sum.plus(&along(&axes, j, l).times(v[*k]))
                });
                let turned = along(&axes, i, l).bracket(&carried(&axes, i, v));
                turned.plus(&axis.bracket(&moved)).times(v[*k])
            });
            parts.fold(Twist::zero(), |sum, part| sum.plus(&part))
        };
        (0..self.coordinates).map(column).collect()
    }
}

/// ∂a_i/∂ϕ_l.
fn along(axes: &[Axis], i: usize, l: usize) -> Twist {
    let behind = axes[i + 1..].iter().filter(|(k, _)| *k == l);
    let sum = behind.fold(Twist::zero(), |sum, (_, axis)| sum.plus(axis));
    axes[i].1.bracket(&sum)
}

/// The twist of what is behind link i.
fn carried(axes: &[Axis], i: usize, v: &[Sym]) -> Twist {
    let behind = axes[i + 1..].iter();
    behind.fold(Twist::zero(), |sum, (k, axis)| sum.plus(&axis.times(v[*k])))
}

impl Link {
    /// From its child frame to that of what it hangs on, in factors.
    fn steps(&self, q: &[Sym]) -> Vec<Step> {
        let fixed = self.frame.iter().map(|step| match *step {
            Fixed::Shift(by) => Step::Shift(by.map(Sym::from)),
            Fixed::Turn(axis, cos, sin) => Step::known_turn(axis, cos, sin),
        });
        let y = Sym::from(self.ratio) * q[self.coordinate] + Sym::from(self.offset);
        let motion = match self.motion {
            LinkMotion::Slide => Step::Shift(Vec3::new(Sym::zero(), Sym::zero(), y)),
            LinkMotion::Turn => {
                let (sin, cos) = sin_cos(y);
                Step::Turn { axis: 2, cos, sin }
            }
        };
        fixed.chain([motion]).collect()
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
