//! Links that [`Tie`]s hold: their relations, how the dependent coordinates follow, and the joint that they make.

use super::equations::{Sides, Square};
use super::link::{check_count, check_links};
use super::{Coordinates, Coupled, Link, LinkFault, LinkMotion, MOST_LINKS, Tie};
use crate::erased::{Shared, erase};
use crate::finite;
use crate::joint::{Joint, Port};
use crate::scalar::{Dual, Scalar};
use alloc::sync::Arc;
use alloc::vec::Vec;
use nalgebra::{DMatrix, SMatrix, SVector};

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
    /// How many relations they are.
    count: usize,
}

/// The name of the set that joints with ties must stay away from.
pub(super) const SINGULARITIES: &[&str] = &["det ∂g/∂y of the dependent coordinates = 0"];

/// Names of so many relations.
pub(super) const fn relations(count: usize) -> &'static [&'static str] {
    const NAMES: [&str; MOST_LINKS] = [
        "g_1 = 0", "g_2 = 0", "g_3 = 0", "g_4 = 0", "g_5 = 0", "g_6 = 0", "g_7 = 0", "g_8 = 0",
        "g_9 = 0", "g_10 = 0", "g_11 = 0", "g_12 = 0", "g_13 = 0", "g_14 = 0", "g_15 = 0",
        "g_16 = 0",
    ];
    match NAMES.split_at_checked(count) {
        Some((names, _)) => names,
        None => &[],
    }
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
    macro_rules! of_the_size {
        ($($k:literal)*) => {
            match independent {
                $($k => Coupled::<$k>::closed(links, ties, start, ports).map(erase),)*
                _ => Err(LinkFault::Sizes {
                    independent,
                    relations: count,
                }),
            }
        };
    }
    of_the_size! { 1 2 3 4 5 6 }
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
        count: 0,
    };

    pub(super) fn start<T: Scalar>(&self) -> Coordinates<T> {
        SVector::from_fn(|i, _| self.start.get(i).map_or(T::zero(), |q| T::from_f64(*q)))
    }

    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    pub(super) fn end(&self) -> f64 {
        self.end
    }

    /// How many relations must hold.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn as_slice(&self) -> &[Tie] {
        &self.ties
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

impl<const K: usize> Coupled<K> {
    /// The joint of these links and ties.
    ///
    /// # Errors
    /// Those of [`closed`](fn@closed), and another number of independent coordinates than K.
    pub fn closed(
        links: &[Link],
        ties: &[Tie],
        start: &[f64],
        ports: &'static [Port],
    ) -> Result<Self, LinkFault> {
        let (coordinates, count) = sizes(links, ties, ports)?;
        if coordinates != K + count || !(1..=most_relations(K)).contains(&count) {
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
            count,
        };
        let mut joint = Self::of(links, ports, ties);
        let start = joint.ties.start::<f64>();
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
    fn spread(&self, q: &Coordinates<f64>) -> f64 {
        let count = self.ties.count;
        let mut equations = self.equations(q);
        let (_, own) = equations.split_mut();
        let mut own = DMatrix::from_column_slice(count, count, own);
        let length = linkage_length(&self.links, &self.ties.ties);
        let ties = self.ties.ties.iter();
        let kinds = ties.flat_map(|tie| tie.lengths(&self.links));
        for (i, _) in kinds.enumerate().filter(|(_, is_length)| *is_length) {
            own.row_mut(i).scale_mut(1.0 / length);
        }
        let mut inverse = DMatrix::identity(count, count);
        finite::solve(count, own.clone().as_mut_slice(), inverse.as_mut_slice());
        let sines = (0..count).map(|k| 1.0 / (own.column(k).norm() * inverse.row(k).norm()));
        sines.fold(1.0, |least, sine| if sine < least { sine } else { least })
    }

    /// B.
    pub(super) fn tangent<T: Scalar>(&self, q: &Coordinates<T>) -> Tangent<T, K> {
        let mut rates = SMatrix::<T, MOST_LINKS, K>::zeros();
        for k in 0..K {
            rates[(k, k)] = T::one();
        }
        let count = self.ties.count;
        if count > 0 {
            let mut equations = self.equations(q);
            let (independent, dependent) = equations.split_mut();
            finite::solve(count, dependent, independent);
            for (k, column) in independent.chunks_exact(count).enumerate() {
                for (i, rate) in column.iter().enumerate() {
                    rates[(K + i, k)] = -*rate;
                }
            }
        }
        Tangent {
            rates,
            coordinates: K + count,
        }
    }

    /// The dependent rows of ∂B along a direction of the coordinates, except for their sign: `(∂g_d)⁻¹ (∂²g d) B`.
    pub(super) fn bend<T: Scalar>(
        &self,
        q: &Coordinates<T>,
        direction: &Coordinates<T>,
        tangent: &Tangent<T, K>,
    ) -> Sides<T> {
        let count = self.ties.count;
        if count == 0 {
            return Sides::new(0, K);
        }
        let moved = self.equations(&q.zip_map(direction, Dual::new));
        let mut bend = moved.changes(&tangent.rates);
        let mut dependent = moved.dependent();
        finite::solve(count, dependent.as_mut_slice(), bend.as_mut_slice());
        bend
    }

    /// The λ at which the relations hold, to first order, after Q is led on by `ahead`; and the sign of the determinant of the dependent columns.
    pub(super) fn correction<T: Scalar>(
        &self,
        q: &Coordinates<T>,
        ahead: &Coordinates<T>,
    ) -> (SVector<T, MOST_RELATIONS>, T) {
        let count = self.ties.count;
        let mut equations = self.equations(q);
        let mut lambda = equations.led(ahead);
        let side = &mut lambda.as_mut_slice()[..count];
        let (_, triangle) = equations.split_mut();
        finite::triangulate(count, triangle, side);
        let sign = finite::orientation(count, triangle);
        finite::substitute_back(count, triangle, side);
        (-lambda, sign)
    }

    /// Displacements of the dependent coordinates, among those of all.
    pub(super) fn dependent<T: Scalar>(
        &self,
        lambda: &SVector<T, MOST_RELATIONS>,
    ) -> Coordinates<T> {
        let mut all = Coordinates::zeros();
        for i in 0..self.ties.count {
            all[K + i] = lambda[i];
        }
        all
    }

    /// det ∂g/∂y of the dependent coordinates, in m and numbers.
    pub(super) fn determinant<T: Scalar>(&self, q: &Coordinates<T>) -> T {
        let mut equations = self.equations(q);
        let (_, triangle) = equations.split_mut();
        finite::triangulate(self.ties.count, triangle, &mut []);
        finite::determinant(self.ties.count, triangle)
    }

    /// For each relation the displacement of the dependent coordinates at which it changes at unit rate, and no other: a matrix by columns.
    pub(super) fn relation_displacements<T: Scalar>(&self, q: &Coordinates<T>) -> Square<T> {
        let count = self.ties.count;
        let mut inverse = Square::new(count, count);
        for (i, column) in inverse.columns_mut().enumerate() {
            column[i] = T::one();
        }
        let mut equations = self.equations(q);
        let (_, dependent) = equations.split_mut();
        finite::solve(count, dependent, inverse.as_mut_slice());
        inverse
    }
}

/// B: rates of the independent coordinates to those of all.
pub(super) struct Tangent<T, const K: usize> {
    /// Zero below the coordinates that there are.
    rates: SMatrix<T, MOST_LINKS, K>,
    coordinates: usize,
}

impl<T: Scalar, const K: usize> Tangent<T, K> {
    /// What is given for rates of all coordinates, for those of the independent ones.
    pub(super) fn along<const R: usize>(
        &self,
        map: &SMatrix<T, R, MOST_LINKS>,
    ) -> SMatrix<T, R, K> {
        SMatrix::from_fn(|i, k| {
            (K..self.coordinates).fold(map[(i, k)], |sum, d| {
                map[(i, d)].mul_add(self.rates[(d, k)], sum)
            })
        })
    }

    /// What changes as the dependent coordinates bend.
    pub(super) fn bent<const R: usize>(
        &self,
        map: &SMatrix<T, R, MOST_LINKS>,
        bend: &Sides<T>,
    ) -> SMatrix<T, R, K> {
        let mut bent = SMatrix::zeros();
        for (k, column) in bend.columns().enumerate() {
            for (d, change) in column.iter().enumerate() {
                for i in 0..R {
                    bent[(i, k)] = (-map[(i, K + d)]).mul_add(*change, bent[(i, k)]);
                }
            }
        }
        bent
    }

    /// The rates of all coordinates.
    pub(super) fn rates(&self, v: &SVector<T, K>) -> Coordinates<T> {
        let mut rates = Coordinates::zeros();
        for k in 0..K {
            rates[k] = v[k];
        }
        for i in K..self.coordinates {
            rates[i] = (0..K).fold(T::zero(), |sum, k| self.rates[(i, k)].mul_add(v[k], sum));
        }
        rates
    }

    /// The rates of all coordinates at unit rate of one.
    pub(super) fn direction(&self, k: usize) -> Coordinates<T> {
        self.rates.column(k).into_owned()
    }

    /// The rate of a coordinate by those of the independent ones.
    pub(super) fn row(&self, coordinate: usize) -> [T; K] {
        core::array::from_fn(|k| self.rates[(coordinate, k)])
    }
}
