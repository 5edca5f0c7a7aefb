//! Links that [`Tie`]s hold: their relations, how the dependent coordinates follow, and the joint that they make.

use super::link::{check_count, check_links};
use super::{Coupled, Link, LinkFault, LinkMotion, MOST_LINKS, Tie};
use crate::erased::{Shared, erase};
use crate::finite;
use crate::joint::{Joint, Port};
use crate::scalar::{Dual, Scalar};
use alloc::sync::Arc;
use alloc::vec::Vec;
use nalgebra::{SMatrix, SVector};

/// Most relations of a joint.
pub const MOST_RELATIONS: usize = 12;

/// Most independent coordinates of a joint that ties hold.
pub const MOST_INDEPENDENT: usize = 6;

/// The most relations that leave so many coordinates independent: a joint has [`MOST_LINKS`] links, and each coordinate moves one of them.
pub const fn most_relations(independent: usize) -> usize {
    let left = MOST_LINKS.saturating_sub(independent);
    match independent {
        1..=MOST_INDEPENDENT if left < MOST_RELATIONS => left,
        1..=MOST_INDEPENDENT => MOST_RELATIONS,
        _ => 0,
    }
}

/// Residual of its relations that a start may have, m and numbers: it is projected on them.
const CLOSED: f64 = 1e-9;

/// Part of the determinant at the start at which a joint ends, ε^(1/6): rounding ε of the relations is ε/det³ in the second derivatives of the dependent coordinates, which keep half of their digits there.
const LOST: f64 = 2.5e-3;

/// The sine of the angle between what two coordinates do to the relations at which a joint ends, ε^(1/4): rounding ε of the relations takes ε over its square of the rates of the dependent
/// coordinates, half of their digits.
const FOLDED: f64 = 1.220_703_125e-4;

/// Part of the determinant at the start at which a joint ends at the latest: one that begins nearly folded can leave.
const HALF: f64 = 0.5;

/// Ties with the configuration that says on which branch of the linkage they hold.
#[derive(Clone, Debug)]
pub(super) struct Ties {
    ties: Vec<Tie>,
    start: Vec<f64>,
    /// What makes a number of the determinant of the dependent columns.
    scale: f64,
    /// The determinant, as a number, at which the joint ends.
    end: f64,
    /// The relations of the joint's type that it does not have.
    idle: usize,
}

/// B: rates of the independent coordinates to those of all.
pub(super) struct Tangent<T, const N: usize, const K: usize>(pub(super) SMatrix<T, N, K>);

/// The names of the sets that a joint of so many relations must stay away from.
pub(super) const fn singularities(relations: usize) -> &'static [&'static str] {
    match relations {
        0 => &[],
        _ => &["det ∂g/∂y of the dependent coordinates = 0"],
    }
}

/// Names of so many relations.
pub(super) const fn relations(count: usize) -> &'static [&'static str] {
    const NAMES: [&str; MOST_RELATIONS] = [
        "g_1 = 0", "g_2 = 0", "g_3 = 0", "g_4 = 0", "g_5 = 0", "g_6 = 0", "g_7 = 0", "g_8 = 0",
        "g_9 = 0", "g_10 = 0", "g_11 = 0", "g_12 = 0",
    ];
    match NAMES.split_at_checked(count) {
        Some((names, _)) => names,
        None => &[],
    }
}

/// N: the directions of the dependent coordinates, which are the last.
pub(super) fn dependent<T: Scalar, const N: usize, const C: usize>() -> SMatrix<T, N, C> {
    SMatrix::from_fn(|i, j| match i + C == N + j {
        true => T::one(),
        false => T::zero(),
    })
}

/// The columns of the independent coordinates, and of the dependent ones.
pub(super) fn split<T: Scalar, const N: usize, const K: usize, const C: usize>(
    slopes: &SMatrix<T, C, N>,
) -> (SMatrix<T, C, K>, SMatrix<T, C, C>) {
    (
        SMatrix::from_fn(|i, j| slopes[(i, j)]),
        SMatrix::from_fn(|i, j| slopes[(i, K + j)]),
    )
}

/// A joint of these links, which ties hold together, whose bodies are `link_1`, `link_2` …. With C relations the last C of the coordinates depend on the others; `start` is
/// a configuration on the ties, and chooses the branch of the linkage. `ports` are those of [`coupled`](super::coupled).
///
/// # Errors
/// Links and ties that no joint can have: more of independent coordinates than [`MOST_INDEPENDENT`] or of relations than [`most_relations`], a start that is off the ties, or where the last coordinates do not follow from the others.
pub fn closed(
    links: &[Link],
    ties: &[Tie],
    start: &[f64],
    ports: &'static [Port],
) -> Result<Shared, LinkFault> {
    let (coordinates, count) = sizes(links, ties, ports)?;
    let independent = coordinates.saturating_sub(count);
    // Each size is a type of its own, and takes its time to compile: linkages that are seldom take the next larger one.
    macro_rules! of_the_next_size {
        ($($k:literal: $($c:literal)*;)*) => {
            match (independent, count) {
                $($(($k, 1..=$c) => Coupled::<{ $k + $c }, $k, $c>::closed(links, ties, start, ports).map(erase),)*)*
                _ => Err(LinkFault::Sizes {
                    independent,
                    relations: count,
                }),
            }
        };
    }
    of_the_next_size! {
        1: 1 2 3 6 12;
        2: 1 2 3 6 12;
        3: 1 2 6 12;
        4: 2 12;
        5: 11;
        6: 10;
    }
}

/// The numbers of coordinates and of relations.
fn sizes(links: &[Link], ties: &[Tie], ports: &[Port]) -> Result<(usize, usize), LinkFault> {
    Ok((check_links(links, ports)?, check_ties(ties, links.len())?))
}

fn check_ties(ties: &[Tie], links: usize) -> Result<usize, LinkFault> {
    for (number, tie) in ties.iter().enumerate() {
        let of: Vec<usize> = match tie {
            Tie::Sum { terms, .. } => terms.iter().map(|(link, _)| *link).collect(),
            Tie::Closure { links, .. } => links.iter().copied().flatten().collect(),
        };
        if let Some(link) = of.into_iter().find(|link| *link >= links) {
            return Err(LinkFault::Tie {
                tie: number,
                link,
                links,
            });
        }
        let sound = match tie {
            Tie::Sum { terms, constant } => {
                constant.is_finite() && terms.iter().all(|(_, weight)| weight.is_finite())
            }
            Tie::Closure {
                frames,
                relations,
                implied,
                ..
            } => {
                frames.iter().all(|frame| frame.check().is_ok())
                    && relations
                        .iter()
                        .chain(implied)
                        .all(|relation| relation.is_of_axes())
            }
        };
        if !sound {
            return Err(LinkFault::Unsound { tie: number });
        }
    }
    Ok(ties.iter().map(Tie::count).sum())
}

/// The length of a linkage below which it is none, m: what rounding leaves of positions within a metre, some thousand times. All axes of such a linkage meet.
const NO_LENGTH: f64 = 1e-12;

/// The largest length in a linkage, that of a frame from another, m; 1 where there is none but rounding.
pub fn linkage_length(links: &[Link], ties: &[Tie]) -> f64 {
    let own = links.iter().map(|link| link.frame.translation.norm());
    let frames = ties.iter().flat_map(|tie| match tie {
        Tie::Closure { frames, .. } => frames.each_ref().map(|frame| frame.translation.norm()),
        Tie::Sum { .. } => [0.0; 2],
    });
    let length = own.chain(frames).fold(0.0, f64::max);
    if length > NO_LENGTH { length } else { 1.0 }
}

/// Divides the rows of lengths by a length of the linkage, and takes it into the columns of lengths: what is left has no unit.
fn scale(links: &[Link], ties: &[Tie], independent: usize) -> f64 {
    let length = linkage_length(links, ties);
    let slides = |coordinate: usize| {
        let mut own = links.iter();
        let first = own.find(|link| link.coordinate == coordinate);
        first.is_some_and(|link| link.motion == LinkMotion::Slide)
    };
    let rows = ties.iter().flat_map(|tie| tie.lengths(links));
    let rows = rows.filter(|is_length| *is_length).count();
    let all = links
        .iter()
        .map(|link| link.coordinate + 1)
        .max()
        .unwrap_or(0);
    let columns = (independent..all).filter(|k| slides(*k)).count();
    (columns..rows).fold(1.0, |scale, _| scale / length)
        * (rows..columns).fold(1.0, |scale, _| scale * length)
}

impl Ties {
    /// None.
    pub(super) const NONE: Self = Self {
        ties: Vec::new(),
        start: Vec::new(),
        scale: 1.0,
        end: 0.0,
        idle: 0,
    };

    pub(super) fn start<T: Scalar, const N: usize>(&self) -> SVector<T, N> {
        SVector::from_fn(|i, _| self.start.get(i).map_or(T::zero(), |q| T::from_f64(*q)))
    }

    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    pub(super) fn end(&self) -> f64 {
        self.end
    }

    pub(super) fn idle(&self) -> usize {
        self.idle
    }

    /// Root of the sum of squares of all relations, those that follow from others among them.
    pub(super) fn residual<T: Scalar>(&self, links: &[Link], q: &[T]) -> T {
        let mut square = T::zero();
        for tie in &self.ties {
            tie.relations(links, q, |(value, _)| square = value.mul_add(value, square));
            tie.implied(links, q, |value| square = value.mul_add(value, square));
        }
        square.sqrt()
    }
}

impl<const N: usize, const K: usize, const C: usize> Coupled<N, K, C> {
    /// The joint of these links and ties, of C relations at most. Those that it does not have hold coordinates at 0 that move nothing, [`Joint::idle`].
    ///
    /// # Errors
    /// Those of [`closed`](fn@closed), another number of independent coordinates than K, and more relations than C.
    pub fn closed(
        links: &[Link],
        ties: &[Tie],
        start: &[f64],
        ports: &'static [Port],
    ) -> Result<Self, LinkFault> {
        let (coordinates, count) = sizes(links, ties, ports)?;
        if coordinates != K + count || !(1..=C).contains(&count) || N != K + C {
            return Err(LinkFault::Sizes {
                independent: coordinates.saturating_sub(count),
                relations: count,
            });
        }
        check_count(
            "coordinates of the start",
            start.len(),
            coordinates..=coordinates,
            "one a coordinate",
        )?;
        let ties = Ties {
            ties: ties.to_vec(),
            start: start.to_vec(),
            scale: scale(links, ties, K),
            end: 0.0,
            idle: C - count,
        };
        let mut joint = Self::of(links, ports, ties);
        let start = joint.ties.start::<f64, N>();
        let (residual, determinant) = (joint.residual(&start), joint.singularity(&start));
        let spread = joint.spread(&start);
        match residual <= CLOSED {
            false => Err(LinkFault::Open { residual }),
            true if determinant > 0.0 && spread >= FOLDED => {
                let end = LOST.max(FOLDED / spread).min(HALF);
                Arc::make_mut(&mut joint.ties).end = end * determinant;
                Ok(joint)
            }
            true => Err(LinkFault::Dependent),
        }
    }

    /// How far the linkage is from folding: the least sine of the angle between what one dependent coordinate does to the relations and what all others do, with lengths as parts of the largest.
    fn spread(&self, q: &SVector<f64, N>) -> f64 {
        let (_, mut own) = split::<f64, N, K, C>(&self.relations(q).1);
        let length = linkage_length(&self.links, &self.ties.ties);
        let kinds = self
            .ties
            .ties
            .iter()
            .flat_map(|tie| tie.lengths(&self.links));
        for (i, _) in kinds.enumerate().filter(|(_, is_length)| *is_length) {
            own.row_mut(i).scale_mut(1.0 / length);
        }
        let inverse = finite::inverse(&own);
        let sines = (0..C).map(|k| 1.0 / (own.column(k).norm() * inverse.row(k).norm()));
        sines.fold(1.0, |least, sine| if sine < least { sine } else { least })
    }

    /// g(q), and its derivatives along the coordinates.
    pub(super) fn relations<T: Scalar>(
        &self,
        q: &SVector<T, N>,
    ) -> (SVector<T, C>, SMatrix<T, C, N>) {
        let (mut values, mut slopes) = (SVector::zeros(), SMatrix::zeros());
        let mut i = 0;
        for tie in &self.ties.ties {
            tie.relations(&self.links, q.as_slice(), |(value, row)| {
                if i < C {
                    values[i] = value;
                    let row = row.iter().take(N).enumerate();
                    row.for_each(|(k, slope)| slopes[(i, k)] = *slope);
                }
                i += 1;
            });
        }
        for i in C - self.ties.idle()..C {
            values[i] = q[K + i];
            slopes[(i, K + i)] = T::one();
        }
        (values, slopes)
    }

    pub(super) fn tangent<T: Scalar>(&self, q: &SVector<T, N>) -> Tangent<T, N, K> {
        if C == 0 {
            return Tangent(SMatrix::identity());
        }
        let (independent, dependent) = split(&self.relations(q).1);
        let follow: SMatrix<T, C, K> = -finite::least_squares(&dependent, &independent);
        Tangent(SMatrix::from_fn(|i, j| match i {
            _ if i >= K => follow[(i - K, j)],
            _ if i == j => T::one(),
            _ => T::zero(),
        }))
    }

    /// The dependent rows of ∂B along a direction of the coordinates: `−(∂g_d)⁻¹ (∂²g d) B`.
    pub(super) fn bend<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        direction: &SVector<T, N>,
        tangent: &Tangent<T, N, K>,
    ) -> SMatrix<T, C, K> {
        if C == 0 {
            return SMatrix::zeros();
        }
        let moved = q.zip_map(direction, Dual::new);
        let slopes = self.relations(&moved).1;
        let (_, dependent) = split::<T, N, K, C>(&slopes.map(|entry| entry.value));
        let change = slopes.map(|entry| entry.derivative()) * tangent.0;
        -finite::least_squares(&dependent, &change)
    }

    /// For each relation the displacement of the dependent coordinates at which it changes at unit rate, and no other.
    pub(super) fn relation_displacements<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, N, C> {
        let (_, own) = split::<T, N, K, C>(&self.relations(q).1);
        dependent::<T, N, C>() * finite::inverse(&own)
    }
}

impl<T: Scalar, const N: usize, const K: usize> Tangent<T, N, K> {
    /// What is given for rates of all coordinates, for those of the independent ones.
    pub(super) fn along<const R: usize>(&self, map: &SMatrix<T, R, N>) -> SMatrix<T, R, K> {
        SMatrix::from_fn(|i, k| {
            (K..N).fold(map[(i, k)], |sum, d| {
                map[(i, d)].mul_add(self.0[(d, k)], sum)
            })
        })
    }

    /// What changes as the dependent coordinates bend.
    pub(super) fn bent<const R: usize, const C: usize>(
        &self,
        map: &SMatrix<T, R, N>,
        bend: &SMatrix<T, C, K>,
    ) -> SMatrix<T, R, K> {
        SMatrix::from_fn(|i, k| {
            (0..C).fold(T::zero(), |sum, d| {
                map[(i, K + d)].mul_add(bend[(d, k)], sum)
            })
        })
    }

    /// The rates of all coordinates.
    pub(super) fn rates(&self, v: &SVector<T, K>) -> SVector<T, N> {
        SVector::from_fn(|i, _| match i < K {
            true => v[i],
            false => (0..K).fold(T::zero(), |sum, k| self.0[(i, k)].mul_add(v[k], sum)),
        })
    }

    /// The rates of all coordinates at unit rate of one.
    pub(super) fn direction(&self, k: usize) -> SVector<T, N> {
        SVector::from_fn(|i, _| self.0[(i, k)])
    }

    /// The rate of a coordinate by those of the independent ones.
    pub(super) fn row(&self, coordinate: usize) -> [T; K] {
        core::array::from_fn(|k| self.0[(coordinate, k)])
    }
}
