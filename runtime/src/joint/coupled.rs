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
mod equations;
mod filled;
mod link;
mod names;
mod tie;

pub use closed::{MOST_INDEPENDENT, MOST_RELATIONS, closed, linkage_length, most_relations};
pub use link::{Link, LinkFault, LinkMotion, MOST_LINKS};
pub use tie::{Relation, Row, Tie};

use super::{Facts, Joint, Patterns, Port, Structure, Structures, Units, VelocityFrame};
use crate::erased::{Shared, erase};
use crate::finite;
use crate::scalar::Scalar;
use crate::spatial::{Pose, bracket_product};
use alloc::sync::Arc;
use closed::Ties;
use core::iter::successors;
use filled::Filled;
use nalgebra::{SMatrix, SVector, Vector6};
use names::BODIES;

/// Most coordinates of a [`Coupled`] joint that no ties hold.
pub const MOST_COORDINATES: usize = 4;

/// One entry for each coordinate; those that a joint does not have are [idle](Joint::idle), and zero.
type Coordinates<T> = SVector<T, MOST_LINKS>;

/// Links that follow coordinates, of which K are independent and the others depend on them by as many relations, as one of their bodies sees them; the joint itself is that of the first.
///
/// It has room for [`MOST_LINKS`] coordinates: a type for each number of relations would take its time to compile.
#[derive(Clone, Debug)]
pub struct Coupled<const K: usize> {
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
        1 => erase(Coupled::<1>::of(links, ports, Ties::NONE)),
        2 => erase(Coupled::<2>::of(links, ports, Ties::NONE)),
        3 => erase(Coupled::<3>::of(links, ports, Ties::NONE)),
        _ => erase(Coupled::<4>::of(links, ports, Ties::NONE)),
    })
}

impl<const K: usize> Coupled<K> {
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

    /// Of links and ties that have been checked.
    fn of(links: &[Link], ports: &'static [Port], ties: Ties) -> Self {
        Self {
            links: links.into(),
            ports,
            ties: Arc::new(ties),
            body: 0,
        }
    }

    /// How many relations hold the coordinates.
    fn relation_count(&self) -> usize {
        self.ties.count()
    }

    /// How many coordinates there are.
    fn coordinate_count(&self) -> usize {
        K + self.ties.count()
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
    fn twists<T: Scalar>(&self, q: &Coordinates<T>) -> Filled<(usize, Vector6<T>)> {
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
        q: &Coordinates<T>,
        rates: &Coordinates<T>,
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
    fn coordinate_map<T: Scalar>(&self, q: &Coordinates<T>) -> SMatrix<T, 6, MOST_LINKS> {
        summed(&self.twists(q))
    }
}

/// Twists by coordinates.
fn summed<T: Scalar>(twists: &Filled<(usize, Vector6<T>)>) -> SMatrix<T, 6, MOST_LINKS> {
    let mut map = SMatrix::<T, 6, MOST_LINKS>::zeros();
    for (k, twist) in twists.as_ref() {
        add(&mut map, *k, twist);
    }
    map
}

/// Adds to a column.
fn add<T: Scalar>(map: &mut SMatrix<T, 6, MOST_LINKS>, k: usize, twist: &Vector6<T>) {
    for i in 0..6 {
        map[(i, k)] += twist[i];
    }
}

impl<const K: usize> Joint<MOST_LINKS, K, K, 0> for Coupled<K> {
    const NAME: &'static str = "linkage";
    const COORDINATES: [&'static str; MOST_LINKS] = names::coordinates::<MOST_LINKS>(K);
    const FREEDOMS: [&'static str; K] = names::coordinates::<K>(K);
    const SPEEDS: [&'static str; K] = names::coordinates::<K>(K);
    const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Declared;
    const STRUCTURES: Structures = Structures {
        twist_map: Structure::General,
        twist_map_child: Structure::General,
        twist_map_child_gradient: Structure::General,
        bias_acceleration: Structure::General,
        bias_momentum: Structure::General,
        speed_map: Structure::General,
        project: Structure::General,
        residual: Structure::General,
        ..Structures::TRIVIAL
    };
    const PATTERNS: Patterns<K, K> = Patterns::DENSE;
    const HAS_PORTS: bool = true;
    const UNIDENTIFIABLE: &'static [[f64; 10]] = &[];
    const SINGULARITIES: &'static [&'static str] = closed::SINGULARITIES;
    const RELATIONS: &'static [&'static str] = closed::relations(MOST_LINKS - K);

    fn facts(&self) -> Facts {
        let facts = Facts::of::<Self, MOST_LINKS, K, K, 0>();
        match self.relation_count() {
            0 => Facts {
                name: "coupled",
                structures: Structures {
                    project: Structure::Identity,
                    residual: Structure::Zero,
                    ..Self::STRUCTURES
                },
                singularities: &[],
                ..facts
            },
            _ => facts,
        }
    }

    fn units(&self) -> Units {
        names::units::<K>(&self.links, self.coordinate_count())
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
        MOST_LINKS.saturating_sub(self.coordinate_count())
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

    fn home<T: Scalar>(&self) -> Coordinates<T> {
        match self.relation_count() {
            0 => SVector::zeros(),
            _ => self.project(&self.ties.start()),
        }
    }

    fn pose<T: Scalar>(&self, q: &Coordinates<T>) -> Pose<T> {
        let mut poses = self.upwards().map(|link| link.pose(q[link.coordinate]));
        let own = poses.next().unwrap_or_else(Pose::identity);
        poses.fold(own, |below, pose| pose * below)
    }

    fn twist_map<T: Scalar>(&self, q: &Coordinates<T>) -> SMatrix<T, 6, K> {
        self.pose(q).act_twist_columns(&self.twist_map_child(q))
    }

    fn twist_map_child<T: Scalar>(&self, q: &Coordinates<T>) -> SMatrix<T, 6, K> {
        self.tangent(q).along(&self.coordinate_map(q))
    }

    fn twist_map_child_gradient<T: Scalar>(&self, q: &Coordinates<T>) -> [SMatrix<T, 6, K>; K] {
        let tangent = self.tangent(q);
        let map = match self.relation_count() {
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
        q: &Coordinates<T>,
        speeds: &SVector<T, K>,
    ) -> SVector<T, 6> {
        let tangent = self.tangent(q);
        let rates = tangent.rates(speeds);
        let changes = self.twist_rates(q, &rates);
        let parts = changes.as_ref().iter();
        let turned = parts.fold(SVector::zeros(), |sum, (k, change)| {
            sum + change * rates[*k]
        });
        match self.relation_count() {
            0 => turned,
            _ => {
                let bend = self.bend(q, &rates, &tangent);
                turned + tangent.bent(&self.coordinate_map(q), &bend) * speeds
            }
        }
    }

    fn bias_momentum<T: Scalar>(
        &self,
        q: &Coordinates<T>,
        speeds: &SVector<T, K>,
        h: &SVector<T, 6>,
    ) -> SVector<T, K> {
        let tangent = self.tangent(q);
        let rates = tangent.rates(speeds);
        let mut all = SMatrix::<T, 1, MOST_LINKS>::zeros();
        for (k, change) in self.twist_rates(q, &rates).as_ref() {
            for i in 0..6 {
                all[*k] = change[i].mul_add(h[i], all[*k]);
            }
        }
        let turned = tangent.along(&all).transpose();
        match self.relation_count() {
            0 => turned,
            _ => {
                let bend = self.bend(q, &rates, &tangent);
                turned + tangent.bent(&self.coordinate_map(q), &bend).tr_mul(h)
            }
        }
    }

    fn port_map<T: Scalar>(&self, q: &Coordinates<T>) -> impl AsRef<[[T; K]]> {
        let tangent = self.tangent(q);
        let mut rows = Filled::new([T::zero(); K]);
        for link in self.links.iter() {
            let ratio = T::from_f64(link.ratio);
            rows.push(tangent.row(link.coordinate).map(|entry| ratio * entry));
        }
        rows
    }

    fn port_values<T: Scalar>(&self, q: &Coordinates<T>) -> impl AsRef<[T]> {
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

    fn relation_twists<T: Scalar>(&self, q: &Coordinates<T>) -> impl AsRef<[[T; 6]]> {
        let map = self.coordinate_map(q);
        let mut twists = Filled::new([T::zero(); 6]);
        for displacement in self.relation_displacements(q).columns() {
            let columns = displacement.iter().enumerate();
            let twist = columns.fold(Vector6::zeros(), |sum, (d, displacement)| {
                sum + map.column(K + d) * *displacement
            });
            twists.push(twist.into());
        }
        twists
    }

    fn relation_ports<T: Scalar>(&self, q: &Coordinates<T>) -> impl AsRef<[T]> {
        let count = self.relation_count();
        let mut rates = alloc::vec::Vec::with_capacity(count * self.links.len());
        for displacement in self.relation_displacements(q).columns() {
            rates.extend(self.links.iter().map(|link| {
                let dependent = link.coordinate.checked_sub(K);
                let along = dependent.and_then(|d| displacement.get(d));
                along.map_or(T::zero(), |along| *along * T::from_f64(link.ratio))
            }));
        }
        rates
    }

    fn configuration_rate<T: Scalar>(
        &self,
        q: &Coordinates<T>,
        v: &SVector<T, K>,
    ) -> Coordinates<T> {
        self.tangent(q).rates(v)
    }

    fn retract<T: Scalar>(&self, q: &Coordinates<T>, phi: &SVector<T, K>) -> Coordinates<T> {
        let tangent = self.tangent(q);
        if self.relation_count() == 0 {
            return q + tangent.rates(phi);
        }
        let moved = finite::along_branch(
            &tangent.rates(phi),
            |lambda| self.dependent(lambda),
            |xi| q + xi,
            |xi, ahead| self.correction(&(q + xi), ahead),
        );
        let is_on = T::from_f64(self.ties.end()).less(self.singularity(&moved));
        moved.map(|entry| T::select(is_on, entry, T::from_f64(f64::NAN)))
    }

    fn local<T: Scalar>(&self, q: &Coordinates<T>, target: &Coordinates<T>) -> SVector<T, K> {
        // The dependent coordinates are those along which Φ comes back.
        SVector::from_fn(|k, _| target[k] - q[k])
    }

    fn project<T: Scalar>(&self, q: &Coordinates<T>) -> Coordinates<T> {
        match self.relation_count() {
            0 => *q,
            _ => finite::by_shortest(q, |q, xi| q + xi, |q| self.equations(q).shortest()),
        }
    }

    fn residual<T: Scalar>(&self, q: &Coordinates<T>) -> T {
        match self.relation_count() {
            0 => T::zero(),
            _ => self.ties.residual(&self.links, q.as_slice()),
        }
    }

    fn singularity<T: Scalar>(&self, q: &Coordinates<T>) -> T {
        match self.relation_count() {
            0 => finite::least_absolute([]),
            _ => finite::least_absolute([self.determinant(q) * T::from_f64(self.ties.scale())]),
        }
    }
}
