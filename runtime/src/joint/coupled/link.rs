//! One link of coupled joints: a turn or a slide, what it hangs on, and which coordinate it follows.

use super::MOST_COORDINATES;
use crate::joint::Port;
use crate::scalar::Scalar;
use crate::shown::Number;
use crate::spatial::{Pose, PoseError};
use core::ops::RangeInclusive;
use nalgebra::Vector6;

/// Most links of a joint, each with a body.
pub const MOST_LINKS: usize = 16;

/// How a link moves, along or about the z axis of its joint frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkMotion {
    /// A turn by y, rad.
    Turn,
    /// A displacement by y, m.
    Slide,
}

/// A turn or a slide by `y = ratio · q + offset`, and the body that it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Number of the link that it hangs on, less than its own; `None` for the joint's parent.
    pub before: Option<usize>,
    /// Its joint frame in the child frame of the link that it hangs on, or beside the placement of its body on the joint's parent.
    pub frame: Pose<f64>,
    /// How it moves.
    pub motion: LinkMotion,
    /// Number of the coordinate q that it follows.
    pub coordinate: usize,
    /// y per q; not 0.
    pub ratio: f64,
    /// y where q is 0, rad or m.
    pub offset: f64,
}

/// Why links make no joint.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinkFault {
    /// No link, too many, or another number of ports.
    #[error("coupled links: {found} {what}, not {limit}")]
    Count {
        /// `links`, `ports` or what they have.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be, in words.
        limit: &'static str,
    },
    /// More coordinates than a joint has, or one that nothing follows.
    #[error("coupled links: they follow {found} coordinates, and must follow 1 to {most}")]
    Coordinates {
        /// How many they follow.
        found: usize,
        /// How many they may follow.
        most: usize,
    },
    /// A coordinate below the greatest that no link follows.
    #[error("coupled links: no link follows coordinate {coordinate}")]
    Unused {
        /// Its number.
        coordinate: usize,
    },
    /// It hangs on a link that does not come before it.
    #[error("coupled link {link}: it hangs on link {before}, which does not come before it")]
    Before {
        /// Its number.
        link: usize,
        /// That of the other.
        before: usize,
    },
    /// A ratio of 0, or a number that is not finite.
    #[error("coupled link {link}: its {what} is {value}: it must be finite, and a ratio not 0", value = Number(*.value))]
    Value {
        /// Its number.
        link: usize,
        /// `ratio` or `offset`.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A tie of a link that is not there.
    #[error("coupled links: tie {tie} is of link {link}, and there are {links}")]
    Tie {
        /// Its number.
        tie: usize,
        /// That of the link.
        link: usize,
        /// How many links there are.
        links: usize,
    },
    /// A tie with a number that is not finite, a frame that is no pose, or an axis other than 0, 1, 2.
    #[error(
        "coupled links: tie {tie}: its numbers must be finite, its frames poses, and its axes 0, 1 or 2"
    )]
    Unsound {
        /// Its number.
        tie: usize,
    },
    /// A number of relations that joints of so many independent coordinates do not have.
    #[error(
        "coupled links: {relations} relations leave {independent} coordinates independent: a joint has 1 to 6 independent coordinates and 1 to 12 relations, and at most 16 of both together"
    )]
    Sizes {
        /// How many coordinates are independent.
        independent: usize,
        /// How many relations there are.
        relations: usize,
    },
    /// A start that is not on the ties.
    #[error("coupled links: at the start the ties are {residual} off, in m and numbers: at most 1e-9 is possible", residual = Number(*.residual))]
    Open {
        /// Root of the sum of squares of the relations.
        residual: f64,
    },
    /// At the start the dependent coordinates do not follow from the others.
    #[error("coupled links: at the start the dependent coordinates do not follow from the others")]
    Dependent,
    /// A frame that is no pose.
    #[error("coupled link {link}: its frame: {error}")]
    Frame {
        /// Its number.
        link: usize,
        /// Why.
        error: PoseError,
    },
}

impl Link {
    /// y at a value of the coordinate that it follows.
    pub(super) fn value<T: Scalar>(&self, q: T) -> T {
        q.mul_add(T::from_f64(self.ratio), T::from_f64(self.offset))
    }

    /// Its child frame in the child frame of what it hangs on.
    pub(super) fn pose<T: Scalar>(&self, q: T) -> Pose<T> {
        let y = self.value(q);
        let mut frame = Pose::new(
            self.frame.rotation.map(T::from_f64),
            self.frame.translation.map(T::from_f64),
        );
        match self.motion {
            LinkMotion::Turn => {
                let (sin, cos) = y.sin_cos();
                for i in 0..3 {
                    let [a, b] = [0, 1].map(|j| frame.rotation[(i, j)]);
                    frame.rotation[(i, 0)] = cos.mul_add(a, sin * b);
                    frame.rotation[(i, 1)] = cos.mul_add(b, -(sin * a));
                }
            }
            LinkMotion::Slide => {
                for i in 0..3 {
                    let along = frame.rotation[(i, 2)];
                    frame.translation[i] = along.mul_add(y, frame.translation[i]);
                }
            }
        }
        frame
    }

    /// The pose of a link's child frame in the joint's parent, at coordinates `q`; that of the parent itself of no link.
    pub fn stands<T: Scalar>(links: &[Self], q: &[T], mut at: Option<usize>) -> Pose<T> {
        let mut pose = Pose::identity();
        while let Some(link) = at.and_then(|at| links.get(at)) {
            pose = link.pose(q[link.coordinate]) * pose;
            at = link.before;
        }
        pose
    }

    /// Its twist at unit rate of y, in its own child frame.
    pub(super) fn axis<T: Scalar>(&self) -> Vector6<T> {
        let mut axis = Vector6::zeros();
        axis[match self.motion {
            LinkMotion::Turn => 2,
            LinkMotion::Slide => 5,
        }] = T::one();
        axis
    }
}

/// The number of coordinates that links follow, all independent.
pub(super) fn check(links: &[Link], ports: &[Port]) -> Result<usize, LinkFault> {
    let found = check_links(links, ports)?;
    match found > MOST_COORDINATES {
        true => Err(LinkFault::Coordinates {
            found,
            most: MOST_COORDINATES,
        }),
        false => Ok(found),
    }
}

/// The number of coordinates that links follow.
pub(super) fn check_links(links: &[Link], ports: &[Port]) -> Result<usize, LinkFault> {
    let size = links.len();
    check_count("links", size, 1..=MOST_LINKS, "1 to 16")?;
    check_count("ports", ports.len(), size..=size, "one a link")?;
    for (number, link) in links.iter().enumerate() {
        check_link(number, link)?;
    }
    let found = links.iter().map(|link| link.coordinate).max().unwrap_or(0) + 1;
    let most = found.min(MOST_LINKS);
    let follows = |k: usize| links.iter().any(|link| link.coordinate == k);
    match (0..most).find(|&k| !follows(k)) {
        Some(coordinate) if found <= MOST_COORDINATES => Err(LinkFault::Unused { coordinate }),
        Some(_) => Err(LinkFault::Coordinates {
            found,
            most: MOST_COORDINATES,
        }),
        None => Ok(found),
    }
}

/// The error unless there are as many as there may be.
pub(super) fn check_count(
    what: &'static str,
    found: usize,
    limits: RangeInclusive<usize>,
    limit: &'static str,
) -> Result<(), LinkFault> {
    match limits.contains(&found) {
        true => Ok(()),
        false => Err(LinkFault::Count { what, found, limit }),
    }
}

fn check_link(link: usize, own: &Link) -> Result<(), LinkFault> {
    if let Some(before) = own.before.filter(|before| *before >= link) {
        return Err(LinkFault::Before { link, before });
    }
    for (what, value) in [("ratio", own.ratio), ("offset", own.offset)] {
        if !value.is_finite() || (what == "ratio" && value == 0.0) {
            return Err(LinkFault::Value { link, what, value });
        }
    }
    let checked = own.frame.check();
    checked.map_err(|error| LinkFault::Frame { link, error })
}
