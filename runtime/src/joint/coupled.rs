//! Links that move together: [`Coupled`], one joint of several bodies, each of which turns or slides by an affine function of one of N
//! coordinates, and what else holds them together.
//!
//! A gripper whose fingers close together, a finger whose phalanges curl by one tendon, the mimic joints of URDF, and linkages whose loops are
//! closed: joint angles and displacements y = ratio · q + offset. Each [`Link`] is a turn about, or a slide along, the z axis of a joint frame,
//! which is fixed on the joint's parent or on a link before it. The pose of a body is the product of what lies between it and the parent,
//!
//! ```text
//! H_b = E_1(y_1) F_2 E_2(y_2) … F_n E_n(y_n),   y_i = ratio_i q_{k(i)} + offset_i,   E_i = exp(y_i z),
//! ```
//!
//! with F_i the [`Link::frame`]s. With `a_i = ratio_i Ad z` the twist of link i at unit rate of its coordinate, in the frame of the body, the map
//! X̂^c of the rates q̇ is the sum of the a_i in the columns k(i), and `∂a_i/∂q_l = Σ [a_i, a_j]` over the links j behind i that follow q_l.
//!
//! Where nothing else holds them, v = q̇: S is the identity and Φ(Q, ϕ) = Q + ϕ. [`Tie`]s are C relations g(q) = 0. The first K coordinates are then
//! independent, the others follow: `q̇ = B v` with `B = [I; −(∂g_d)⁻¹ ∂g_i]`, X^c = X̂^c B, and Φ moves along B and comes back along the
//! dependent coordinates, by [`finite::retract`](crate::finite::retract). The coordinates are real, so that S is the identity here as well. Along a direction d the relations bend by
//! `∂B/∂d = [0; −(∂g_d)⁻¹ (∂²g d) B]`, which is all that ∂X^c/∂ϕ and c need beyond the brackets. Where `det ∂g_d = 0` the joint ends: rounding ε of the relations is
//! ε/det³ in the second derivatives of the dependent coordinates, so that Φ has no value where that takes half of their digits.
//!
//! Nothing else has to be derived: the dynamics of several bodies in one joint have the inertia and the efforts of every one of them. Each y_i is
//! a [port](crate::joint::Port): springs, dampers and efforts act there, and its rate is ratio_i times that of its coordinate.

mod closed;
mod filled;
mod link;
mod names;
mod tie;

pub use closed::{MOST_INDEPENDENT, MOST_RELATIONS, closed, linkage_length, most_relations};
pub use link::{Link, LinkFault, LinkMotion, MOST_LINKS};
pub use tie::{Relation, Row, Tie};

use super::{Joint, Patterns, Port, Structure, Structures, Units, VelocityFrame};
use crate::erased::{Shared, erase};
use crate::finite;
use crate::scalar::Scalar;
use crate::spatial::{Pose, bracket_product};
use alloc::sync::Arc;
use closed::{Ties, dependent, split};
use core::iter::successors;
use filled::Filled;
use nalgebra::{SMatrix, SVector, Vector6};
use names::{BODIES, coordinates};

/// Most coordinates of a [`Coupled`] joint that no ties hold.
pub const MOST_COORDINATES: usize = 4;

/// Links that follow N coordinates, of which C relations leave K independent, as one of their bodies sees them; the joint itself is that of the first.
#[derive(Clone, Debug)]
pub struct Coupled<const N: usize, const K: usize, const C: usize> {
    links: Arc<[Link]>,
    ports: &'static [Port],
    ties: Arc<Ties>,
    body: usize,
}

/// A joint of these links, of as many coordinates as they follow, whose bodies are `link_1`, `link_2` …; `ports` names their y, in their order. These names
/// live as long as the program, as those of other joints.
///
/// # Errors
/// Links that no joint can have, the first of them by its number.
pub fn coupled(links: &[Link], ports: &'static [Port]) -> Result<Shared, LinkFault> {
    Ok(match link::check(links, ports)? {
        1 => erase(Coupled::<1, 1, 0>::of(links, ports, Ties::NONE)),
        2 => erase(Coupled::<2, 2, 0>::of(links, ports, Ties::NONE)),
        3 => erase(Coupled::<3, 3, 0>::of(links, ports, Ties::NONE)),
        _ => erase(Coupled::<4, 4, 0>::of(links, ports, Ties::NONE)),
    })
}

impl<const K: usize> Coupled<K, K, 0> {
    /// The joint of these links, which follow K coordinates.
    ///
    /// # Errors
    /// Those of [`coupled`], and another number of coordinates than K.
    pub fn new(links: &[Link], ports: &'static [Port]) -> Result<Self, LinkFault> {
        match link::check(links, ports)? {
            found if found == K => Ok(Self::of(links, ports, Ties::NONE)),
            found => Err(LinkFault::Coordinates { found, most: K }),
        }
    }
}

impl<const N: usize, const K: usize, const C: usize> Coupled<N, K, C> {
    /// Of links and ties that have been checked.
    fn of(links: &[Link], ports: &'static [Port], ties: Ties) -> Self {
        Self {
            links: links.into(),
            ports,
            ties: Arc::new(ties),
            body: 0,
        }
    }

    /// The joint as its body of that number sees it; `None` where there is no such body.
    pub fn member(&self, body: usize) -> Option<Self> {
        (body < self.links.len()).then(|| Self {
            body,
            ..self.clone()
        })
    }

    /// This body's link, and those that it hangs on.
    fn upwards(&self) -> impl Iterator<Item = &Link> {
        let before = |link: &&Link| self.links.get(link.before?);
        successors(self.links.get(self.body), before)
    }

    /// For this body's link, and those that it hangs on, the coordinate that it follows and its twist at unit rate of that, in the child frame.
    fn twists<T: Scalar>(&self, q: &SVector<T, N>) -> Filled<(usize, Vector6<T>)> {
        let mut twists = Filled::new((0, Vector6::zeros()));
        let mut below = Pose::identity();
        for link in self.upwards() {
            let own = link.axis() * T::from_f64(link.ratio);
            twists.push((link.coordinate, below.act_twist_inverse(&own)));
            // What stands above the last one does not matter.
            if link.before.is_some() {
                below = link.pose(q[link.coordinate]) * below;
            }
        }
        twists
    }

    /// For each link from this body's upwards, its coordinate and `[a_i, w_i]`, with w_i the twist of what is behind it at rates of the coordinates: the rate of a_i.
    fn twist_rates<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        rates: &SVector<T, N>,
    ) -> Filled<(usize, Vector6<T>)> {
        let mut changes = Filled::new((0, Vector6::zeros()));
        let mut behind = Vector6::zeros();
        for (k, twist) in self.twists(q).as_ref() {
            changes.push((*k, bracket_product(twist, &behind)));
            behind += twist * rates[*k];
        }
        changes
    }

    /// X̂^c: rates of the coordinates to the twist of the body, in its own frame.
    fn coordinate_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, N> {
        summed(&self.twists(q))
    }
}

/// Twists by coordinates.
fn summed<T: Scalar, const N: usize>(twists: &Filled<(usize, Vector6<T>)>) -> SMatrix<T, 6, N> {
    let mut map = SMatrix::<T, 6, N>::zeros();
    for (k, twist) in twists.as_ref() {
        add(&mut map, *k, twist);
    }
    map
}

/// Adds to a column.
fn add<T: Scalar, const K: usize>(map: &mut SMatrix<T, 6, K>, k: usize, twist: &Vector6<T>) {
    for i in 0..6 {
        map[(i, k)] += twist[i];
    }
}

impl<const N: usize, const K: usize, const C: usize> Joint<N, K, K, 0> for Coupled<N, K, C> {
    const NAME: &'static str = if C == 0 { "coupled" } else { "linkage" };
    const COORDINATES: [&'static str; N] = coordinates::<N, K>();
    const FREEDOMS: [&'static str; K] = coordinates::<K, K>();
    const SPEEDS: [&'static str; K] = coordinates::<K, K>();
    const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Declared;
    const STRUCTURES: Structures = Structures {
        twist_map: Structure::General,
        twist_map_child: Structure::General,
        twist_map_child_gradient: Structure::General,
        bias_acceleration: Structure::General,
        bias_momentum: Structure::General,
        speed_map: Structure::General,
        project: if C == 0 {
            Structure::Identity
        } else {
            Structure::General
        },
        residual: if C == 0 {
            Structure::Zero
        } else {
            Structure::General
        },
        ..Structures::TRIVIAL
    };
    const PATTERNS: Patterns<K, K> = Patterns::DENSE;
    const UNIDENTIFIABLE: &'static [[f64; 10]] = &[];
    const SINGULARITIES: &'static [&'static str] = closed::singularities(C);
    const RELATIONS: &'static [&'static str] = closed::relations(C);

    fn units(&self) -> Units {
        names::units::<N, K>(&self.links)
    }

    fn ports(&self) -> &'static [Port] {
        self.ports
    }

    fn bodies(&self) -> &'static [&'static str] {
        const { &BODIES }.get(..self.links.len()).unwrap_or(&[])
    }

    fn body(&self) -> usize {
        self.body
    }

    fn idle(&self) -> usize {
        self.ties.idle()
    }

    fn more(&self, visit: &mut dyn FnMut(Shared)) {
        for member in (1..self.links.len()).filter_map(|body| self.member(body)) {
            visit(erase(member));
        }
    }

    fn parameters(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let links = self.links.iter();
        links.flat_map(|link| [("ratio", link.ratio), ("offset", link.offset)])
    }

    fn home<T: Scalar>(&self) -> SVector<T, N> {
        match C {
            0 => SVector::zeros(),
            _ => self.project(&self.ties.start()),
        }
    }

    fn pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T> {
        let mut poses = self.upwards().map(|link| link.pose(q[link.coordinate]));
        let own = poses.next().unwrap_or_else(Pose::identity);
        poses.fold(own, |below, pose| pose * below)
    }

    fn twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        self.pose(q).act_twist_columns(&self.twist_map_child(q))
    }

    fn twist_map_child<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        self.tangent(q).along(&self.coordinate_map(q))
    }

    fn twist_map_child_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, 6, K>; K] {
        let tangent = self.tangent(q);
        let map = match C {
            0 => SMatrix::zeros(),
            _ => self.coordinate_map(q),
        };
        core::array::from_fn(|l| {
            let direction = tangent.direction(l);
            let turned = tangent.along(&summed(&self.twist_rates(q, &direction)));
            turned + tangent.bent(&map, &self.bend(q, &direction, &tangent))
        })
    }

    fn bias_acceleration<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, K>,
    ) -> SVector<T, 6> {
        let tangent = self.tangent(q);
        let rates = tangent.rates(speeds);
        let changes = self.twist_rates(q, &rates);
        let parts = changes.as_ref().iter();
        let turned = parts.fold(SVector::zeros(), |sum, (k, change)| {
            sum + change * rates[*k]
        });
        match C {
            0 => turned,
            _ => {
                let bend = self.bend(q, &rates, &tangent);
                turned + tangent.bent(&self.coordinate_map(q), &bend) * speeds
            }
        }
    }

    fn bias_momentum<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, K>,
        h: &SVector<T, 6>,
    ) -> SVector<T, K> {
        let tangent = self.tangent(q);
        let rates = tangent.rates(speeds);
        let mut all = SMatrix::<T, 1, N>::zeros();
        for (k, change) in self.twist_rates(q, &rates).as_ref() {
            for i in 0..6 {
                all[*k] = change[i].mul_add(h[i], all[*k]);
            }
        }
        let turned = tangent.along(&all).transpose();
        match C {
            0 => turned,
            _ => {
                let bend = self.bend(q, &rates, &tangent);
                turned + tangent.bent(&self.coordinate_map(q), &bend).tr_mul(h)
            }
        }
    }

    fn port_map<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[[T; K]]> {
        let tangent = self.tangent(q);
        let mut rows = Filled::new([T::zero(); K]);
        for link in self.links.iter() {
            let ratio = T::from_f64(link.ratio);
            rows.push(tangent.row(link.coordinate).map(|entry| ratio * entry));
        }
        rows
    }

    fn port_values<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[T]> {
        let mut values = Filled::new(T::zero());
        for (link, port) in self.links.iter().zip(self.ports) {
            let value = link.value(q[link.coordinate]);
            values.push(match port.wraps {
                true => {
                    let (sin, cos) = value.sin_cos();
                    sin.atan2(cos)
                }
                false => value,
            });
        }
        values
    }

    fn relation_twists<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[[T; 6]]> {
        let twists: [[T; 6]; C] = (self.coordinate_map(q) * self.relation_displacements(q)).into();
        twists
    }

    fn relation_ports<T: Scalar>(&self, q: &SVector<T, N>) -> impl AsRef<[T]> {
        let along = self.relation_displacements(q);
        let mut rates = alloc::vec::Vec::with_capacity(C * self.links.len());
        for relation in 0..C {
            let rate = |link: &Link| along[(link.coordinate, relation)] * T::from_f64(link.ratio);
            rates.extend(self.links.iter().map(rate));
        }
        rates
    }

    fn configuration_rate<T: Scalar>(&self, q: &SVector<T, N>, v: &SVector<T, K>) -> SVector<T, N> {
        self.tangent(q).rates(v)
    }

    fn retract<T: Scalar>(&self, q: &SVector<T, N>, phi: &SVector<T, K>) -> SVector<T, N> {
        let tangent = self.tangent(q);
        match C {
            0 => q + tangent.rates(phi),
            _ => {
                let moved = finite::retract(
                    phi,
                    (tangent.0, dependent()),
                    |xi| q + xi,
                    |q, _| self.relations(q),
                );
                let is_on = T::from_f64(self.ties.end()).less(self.singularity(&moved));
                moved.map(|entry| T::select(is_on, entry, T::from_f64(f64::NAN)))
            }
        }
    }

    fn local<T: Scalar>(&self, q: &SVector<T, N>, target: &SVector<T, N>) -> SVector<T, K> {
        // The dependent coordinates are those along which Φ comes back.
        SVector::from_fn(|k, _| target[k] - q[k])
    }

    fn project<T: Scalar>(&self, q: &SVector<T, N>) -> SVector<T, N> {
        match C {
            0 => *q,
            _ => finite::project_by_displacements(q, |q, xi| q + xi, |q| self.relations(q)),
        }
    }

    fn residual<T: Scalar>(&self, q: &SVector<T, N>) -> T {
        match C {
            0 => T::zero(),
            _ => self.ties.residual(&self.links, q.as_slice()),
        }
    }

    fn singularity<T: Scalar>(&self, q: &SVector<T, N>) -> T {
        match C {
            0 => finite::least_absolute([]),
            _ => {
                let (_, own) = split::<T, N, K, C>(&self.relations(q).1);
                let determinant = finite::determinant(&own);
                finite::least_absolute([determinant * T::from_f64(self.ties.scale())])
            }
        }
    }
}
