//! What holds links together beyond the tree that they are: [`Tie`]s, each of one or several relations between their y.

use super::filled::Filled;
use super::link::{Link, LinkMotion, MOST_LINKS};
use crate::scalar::Scalar;
use crate::spatial::{Pose, split};
use alloc::vec::Vec;
use nalgebra::{Matrix3, Vector3, Vector6};

/// One relation between two frames, P and S, by the pose [R t] of S in P.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// `t_i = 0`: the origin of S is in the plane through that of P across axis i of P.
    Meets(usize),
    /// `R_ij = 0`: axis i of P and axis j of S are at right angles.
    Square(usize, usize),
}

impl Relation {
    /// Whether its numbers are those of axes.
    pub(super) fn is_of_axes(self) -> bool {
        match self {
            Self::Meets(i) => i < 3,
            Self::Square(i, j) => i < 3 && j < 3,
        }
    }
}

/// What links obey.
#[derive(Clone, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a joint has a few of them, most of them closures"
)]
pub enum Tie {
    /// `Σ weight y = constant` over links, by their numbers.
    Sum {
        /// Number of a link, and its weight.
        terms: Vec<(usize, f64)>,
        /// rad or m.
        constant: f64,
    },
    /// A loop is closed: two frames stand to each other as a joint between them lets them.
    Closure {
        /// The links in whose child frames P and S are fixed; `None` for the joint's parent.
        links: [Option<usize>; 2],
        /// P and S.
        frames: [Pose<f64>; 2],
        /// What must hold, each independent of all others.
        relations: Vec<Relation>,
        /// What then holds as well, by the geometry of the loop.
        implied: Vec<Relation>,
    },
}

/// The value of a relation and its derivatives along the coordinates.
pub type Row<T> = (T, [T; MOST_LINKS]);

/// The pose of S in P, with the twists of S in P at unit rates of the coordinates, read in the axes of P.
struct Between<T> {
    pose: Pose<T>,
    twists: [Vector6<T>; MOST_LINKS],
    coordinates: usize,
}

impl Tie {
    /// How many relations must hold.
    pub fn count(&self) -> usize {
        match self {
            Self::Sum { .. } => 1,
            Self::Closure { relations, .. } => relations.len(),
        }
    }

    /// Which of them are lengths.
    pub(super) fn lengths(&self, links: &[Link]) -> Vec<bool> {
        match self {
            Self::Sum { terms, .. } => {
                let first = terms.first().and_then(|(link, _)| links.get(*link));
                Vec::from([first.is_some_and(|link| link.motion == LinkMotion::Slide)])
            }
            Self::Closure { relations, .. } => {
                let relations = relations.iter();
                relations
                    .map(|own| matches!(own, Relation::Meets(_)))
                    .collect()
            }
        }
    }

    /// Hands the relations that must hold at coordinates `q` to `visit`, one after the other.
    pub fn relations<T: Scalar>(&self, links: &[Link], q: &[T], mut visit: impl FnMut(Row<T>)) {
        match self {
            Self::Sum { terms, constant } => visit(sum(links, q, terms, *constant)),
            Self::Closure {
                links: ends,
                frames,
                relations,
                ..
            } => {
                let between = Between::new(links, q, (*ends, frames));
                relations
                    .iter()
                    .for_each(|relation| visit(between.row(*relation)));
            }
        }
    }

    /// Hands the values of the relations that hold as well to `visit`.
    pub(super) fn implied<T: Scalar>(&self, links: &[Link], q: &[T], mut visit: impl FnMut(T)) {
        if let Self::Closure {
            links: ends,
            frames,
            implied,
            ..
        } = self
        {
            let between = Between::new(links, q, (*ends, frames));
            let implied = implied.iter();
            implied.for_each(|relation| visit(between.row(*relation).0));
        }
    }
}

fn sum<T: Scalar>(links: &[Link], q: &[T], terms: &[(usize, f64)], constant: f64) -> Row<T> {
    let mut row = [T::zero(); MOST_LINKS];
    let mut value = T::from_f64(-constant);
    for (link, weight) in terms {
        let (Some(link), weight) = (links.get(*link), T::from_f64(*weight)) else {
            continue;
        };
        value = weight.mul_add(link.value(q[link.coordinate]), value);
        row[link.coordinate] += weight * T::from_f64(link.ratio);
    }
    (value, row)
}

/// Where a frame stands that is fixed on a link, or on the joint's parent. Hands each link on the way to `visit`: its coordinate, and the twist at unit rate of that, in the frame itself.
fn walk<T: Scalar>(
    links: &[Link],
    q: &[T],
    mut at: Option<usize>,
    frame: &Pose<f64>,
    mut visit: impl FnMut(usize, Vector6<T>),
) -> Pose<T> {
    let mut pose = Pose::new(
        frame.rotation.map(T::from_f64),
        frame.translation.map(T::from_f64),
    );
    while let Some(link) = at.and_then(|at| links.get(at)) {
        let axis = link.axis() * T::from_f64(link.ratio);
        visit(link.coordinate, pose.act_twist_inverse(&axis));
        pose = link.pose(q[link.coordinate]) * pose;
        at = link.before;
    }
    pose
}

impl<T: Scalar> Between<T> {
    #[inline]
    fn new(links: &[Link], q: &[T], (ends, frames): ([Option<usize>; 2], &[Pose<f64>; 2])) -> Self {
        let mut twists = [Vector6::zeros(); MOST_LINKS];
        let first = walk(links, q, ends[0], &frames[0], |coordinate, twist| {
            twists[coordinate] -= twist;
        });
        let mut of_second = Filled::new((0, Vector6::zeros()));
        let second = walk(links, q, ends[1], &frames[1], |coordinate, twist| {
            of_second.push((coordinate, twist));
        });
        let pose = first.inverse() * second;
        for (coordinate, twist) in of_second.as_ref() {
            twists[*coordinate] += pose.act_twist(twist);
        }
        Self {
            pose,
            twists,
            coordinates: q.len(),
        }
    }

    fn row(&self, relation: Relation) -> Row<T> {
        let Pose {
            rotation,
            translation,
        } = &self.pose;
        let along = |rate: &dyn Fn(Vector3<T>, Vector3<T>) -> T| {
            let mut row = [T::zero(); MOST_LINKS];
            for (entry, twist) in row.iter_mut().zip(&self.twists).take(self.coordinates) {
                let (angular, linear) = split(twist);
                *entry = rate(angular, linear);
            }
            row
        };
        // A point fixed in S moves by v + ω × p, a direction by ω × d.
        match relation {
            Relation::Meets(i) => (
                translation[i],
                along(&|angular, linear| linear[i] + turned(&angular, translation, i)),
            ),
            Relation::Square(i, j) => {
                let direction: Vector3<T> = column(rotation, j);
                let rate = along(&|angular, _| turned(&angular, &direction, i));
                (rotation[(i, j)], rate)
            }
        }
    }
}

/// Entry i of ω × d.
fn turned<T: Scalar>(angular: &Vector3<T>, direction: &Vector3<T>, i: usize) -> T {
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    angular[j] * direction[k] - angular[k] * direction[j]
}

fn column<T: Scalar>(matrix: &Matrix3<T>, j: usize) -> Vector3<T> {
    Vector3::new(matrix[(0, j)], matrix[(1, j)], matrix[(2, j)])
}
