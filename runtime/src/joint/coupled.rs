//! Joints that follow one another: [`Coupled`], one joint of several bodies, each of whose turns and slides is an affine function of one of K
//! coordinates.
//!
//! A gripper whose fingers close together, a finger whose phalanges curl by one tendon, the mimic joints of URDF: joint angles and displacements
//! y = ratio · q + offset. Each [`Link`] is a turn about, or a slide along, the z axis of a joint frame, which is fixed on the joint's parent or on a
//! link before it. The pose of a body is the product of what lies between it and the parent,
//!
//! ```text
//! H_b = E_1(y_1) F_2 E_2(y_2) … F_n E_n(y_n),   y_i = ratio_i q_{k(i)} + offset_i,   E_i = exp(y_i z),
//! ```
//!
//! with F_i the [`Link::frame`]s. The coordinates are real and v = q̇, so that S is the identity and Φ(Q, ϕ) = Q + ϕ. With `a_i = ratio_i Ad z`
//! the twist of link i at unit rate of its coordinate, in the frame of the body, X^c is the sum of the a_i in the columns k(i), and
//! `∂a_i/∂ϕ_l = Σ [a_i, a_j]` over the links j behind i that follow q_l. Nothing else has to be derived: the dynamics of several bodies in
//! one joint have the inertia and the efforts of every one of them, without multipliers.
//!
//! Each y_i is a [port](crate::joint::Port): springs, dampers and efforts act there, and its rate is `ratio_i v_{k(i)}`.

mod link;

pub use link::{Link, LinkFault, LinkMotion, MOST_LINKS};

use super::{Joint, Patterns, Port, Structure, Structures, Unit, Units, VelocityFrame};
use crate::erased::{Shared, erase};
use crate::scalar::Scalar;
use crate::spatial::{Pose, bracket_product};
use alloc::sync::Arc;
use core::iter::successors;
use nalgebra::{SMatrix, SVector, Vector6};

/// Most coordinates of a [`Coupled`] joint.
pub const MOST_COORDINATES: usize = 4;

/// Links that follow K coordinates, as one of their bodies sees them; the joint itself is that of the first.
#[derive(Clone, Debug)]
pub struct Coupled<const K: usize> {
    links: Arc<[Link]>,
    ports: &'static [Port],
    body: usize,
}

/// Names of bodies.
const BODIES: [&str; MOST_LINKS] = [
    "link_1", "link_2", "link_3", "link_4", "link_5", "link_6", "link_7", "link_8", "link_9",
    "link_10", "link_11", "link_12", "link_13", "link_14", "link_15", "link_16",
];

/// A joint of these links, of as many coordinates as they follow, whose bodies are `link_1`, `link_2` …; `ports` names their y, in their order. These names
/// live as long as the program, as those of other joints.
///
/// # Errors
/// Links that no joint can have, the first of them by its number.
pub fn coupled(links: &[Link], ports: &'static [Port]) -> Result<Shared, LinkFault> {
    Ok(match link::check(links, ports)? {
        1 => erase(Coupled::<1>::of(links, ports)),
        2 => erase(Coupled::<2>::of(links, ports)),
        3 => erase(Coupled::<3>::of(links, ports)),
        _ => erase(Coupled::<4>::of(links, ports)),
    })
}

impl<const K: usize> Coupled<K> {
    /// The joint of these links, which follow K coordinates.
    ///
    /// # Errors
    /// Those of [`coupled`], and another number of coordinates than K.
    pub fn new(links: &[Link], ports: &'static [Port]) -> Result<Self, LinkFault> {
        match link::check(links, ports)? {
            found if found == K => Ok(Self::of(links, ports)),
            found => Err(LinkFault::Coordinates { found, most: K }),
        }
    }

    /// Of links that have been checked.
    fn of(links: &[Link], ports: &'static [Port]) -> Self {
        Self {
            links: links.into(),
            ports,
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
    fn twists<T: Scalar>(&self, q: &SVector<T, K>) -> Filled<(usize, Vector6<T>)> {
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

    /// For each link from this body's upwards, its coordinate and `[a_i, w_i]`, with w_i the twist of what is behind it at v: the rate of a_i.
    fn twist_rates<T: Scalar>(
        &self,
        q: &SVector<T, K>,
        v: &SVector<T, K>,
    ) -> Filled<(usize, Vector6<T>)> {
        let mut rates = Filled::new((0, Vector6::zeros()));
        let mut behind = Vector6::zeros();
        for (k, twist) in self.twists(q).as_ref() {
            rates.push((*k, bracket_product(twist, &behind)));
            behind += twist * v[*k];
        }
        rates
    }
}

/// As many entries as a joint has links, without allocation.
struct Filled<E> {
    entries: [E; MOST_LINKS],
    count: usize,
}

impl<E: Copy> Filled<E> {
    fn new(empty: E) -> Self {
        Self {
            entries: [empty; MOST_LINKS],
            count: 0,
        }
    }

    fn push(&mut self, entry: E) {
        if let Some(place) = self.entries.get_mut(self.count) {
            *place = entry;
            self.count += 1;
        }
    }
}

impl<E> AsRef<[E]> for Filled<E> {
    fn as_ref(&self) -> &[E] {
        &self.entries[..self.count]
    }
}

/// Adds to a column.
fn add<T: Scalar, const K: usize>(map: &mut SMatrix<T, 6, K>, k: usize, twist: &Vector6<T>) {
    for i in 0..6 {
        map[(i, k)] += twist[i];
    }
}

/// Names of coordinates: `q` of one.
const fn coordinates<const K: usize>() -> [&'static str; K] {
    let known = ["q_1", "q_2", "q_3", "q_4"];
    let mut names = ["q"; K];
    let mut k = 0;
    while K > 1 && k < K {
        names[k] = known[k];
        k += 1;
    }
    names
}

/// All combinations of angles and lengths: coordinate k of combination n is a length where bit k of n is 1.
const UNITS: [[Unit; MOST_COORDINATES]; 1 << MOST_COORDINATES] = {
    let mut all = [[Unit::ANGLE; MOST_COORDINATES]; 1 << MOST_COORDINATES];
    let mut n = 0;
    while n < all.len() {
        let mut k = 0;
        while k < MOST_COORDINATES {
            if n >> k & 1 == 1 {
                all[n][k] = Unit::LENGTH;
            }
            k += 1;
        }
        n += 1;
    }
    all
};

impl<const K: usize> Joint<K, K, K, 0> for Coupled<K> {
    const NAME: &'static str = "coupled";
    const COORDINATES: [&'static str; K] = coordinates();
    const FREEDOMS: [&'static str; K] = coordinates();
    const SPEEDS: [&'static str; K] = coordinates();
    const VELOCITY_FRAME: VelocityFrame = VelocityFrame::Declared;
    const STRUCTURES: Structures = Structures {
        twist_map: Structure::General,
        twist_map_child: Structure::General,
        twist_map_child_gradient: Structure::General,
        bias_acceleration: Structure::General,
        bias_momentum: Structure::General,
        speed_map: Structure::General,
        ..Structures::TRIVIAL
    };
    const PATTERNS: Patterns<K, K> = Patterns::DENSE;
    const UNIDENTIFIABLE: &'static [[f64; 10]] = &[];
    const SINGULARITIES: &'static [&'static str] = &[];

    /// A coordinate is what the first link that follows it is moved by.
    fn units(&self) -> Units {
        let is_length = |k: usize| {
            let mut links = self.links.iter();
            let first = links.find(|link| link.coordinate == k);
            first.is_some_and(|link| link.motion == LinkMotion::Slide)
        };
        let combination = (0..K)
            .map(|k| usize::from(is_length(k)) << k)
            .sum::<usize>();
        let units = const { &UNITS }.get(combination);
        Units::of_rates(units.and_then(|units| units.get(..K)).unwrap_or_default())
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

    fn more(&self, visit: &mut dyn FnMut(Shared)) {
        for member in (1..self.links.len()).filter_map(|body| self.member(body)) {
            visit(erase(member));
        }
    }

    fn parameters(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let links = self.links.iter();
        links.flat_map(|link| [("ratio", link.ratio), ("offset", link.offset)])
    }

    fn home<T: Scalar>(&self) -> SVector<T, K> {
        SVector::zeros()
    }

    fn pose<T: Scalar>(&self, q: &SVector<T, K>) -> Pose<T> {
        let mut poses = self.upwards().map(|link| link.pose(q[link.coordinate]));
        let own = poses.next().unwrap_or_else(Pose::identity);
        poses.fold(own, |below, pose| pose * below)
    }

    fn twist_map<T: Scalar>(&self, q: &SVector<T, K>) -> SMatrix<T, 6, K> {
        self.pose(q).act_twist_columns(&self.twist_map_child(q))
    }

    fn twist_map_child<T: Scalar>(&self, q: &SVector<T, K>) -> SMatrix<T, 6, K> {
        let mut map = SMatrix::<T, 6, K>::zeros();
        for (k, twist) in self.twists(q).as_ref() {
            add(&mut map, *k, twist);
        }
        map
    }

    fn twist_map_child_gradient<T: Scalar>(&self, q: &SVector<T, K>) -> [SMatrix<T, 6, K>; K] {
        let mut slices = [SMatrix::<T, 6, K>::zeros(); K];
        let twists = self.twists(q);
        for (n, (k, above)) in twists.as_ref().iter().enumerate() {
            for (l, below) in &twists.as_ref()[..n] {
                add(&mut slices[*l], *k, &bracket_product(above, below));
            }
        }
        slices
    }

    fn bias_acceleration<T: Scalar>(
        &self,
        q: &SVector<T, K>,
        speeds: &SVector<T, K>,
    ) -> SVector<T, 6> {
        let rates = self.twist_rates(q, speeds);
        let parts = rates.as_ref().iter();
        parts.fold(SVector::zeros(), |sum, (k, rate)| sum + rate * speeds[*k])
    }

    fn bias_momentum<T: Scalar>(
        &self,
        q: &SVector<T, K>,
        speeds: &SVector<T, K>,
        h: &SVector<T, 6>,
    ) -> SVector<T, K> {
        let mut out = SVector::zeros();
        for (k, rate) in self.twist_rates(q, speeds).as_ref() {
            for i in 0..6 {
                out[*k] = rate[i].mul_add(h[i], out[*k]);
            }
        }
        out
    }

    fn port_map<T: Scalar>(&self, _q: &SVector<T, K>) -> impl AsRef<[[T; K]]> {
        let mut rows = Filled::new([T::zero(); K]);
        for link in self.links.iter() {
            let mut row = [T::zero(); K];
            row[link.coordinate] = T::from_f64(link.ratio);
            rows.push(row);
        }
        rows
    }

    fn port_values<T: Scalar>(&self, q: &SVector<T, K>) -> impl AsRef<[T]> {
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

    fn configuration_rate<T: Scalar>(
        &self,
        _q: &SVector<T, K>,
        v: &SVector<T, K>,
    ) -> SVector<T, K> {
        *v
    }

    fn retract<T: Scalar>(&self, q: &SVector<T, K>, phi: &SVector<T, K>) -> SVector<T, K> {
        q + phi
    }

    fn local<T: Scalar>(&self, q: &SVector<T, K>, target: &SVector<T, K>) -> SVector<T, K> {
        target - q
    }
}

#[cfg(test)]
mod tests {
    use super::{Link, LinkMotion, coupled};
    use crate::joint::{Port, Unit};
    use crate::spatial::Pose;

    const PORTS: [Port; 3] = [Port {
        name: "y",
        unit: "rad",
        wraps: false,
    }; 3];

    /// A turn, a slide, and a turn that follows the slide.
    #[test]
    fn a_coordinate_is_measured_as_what_follows_it_first() {
        let link = |motion, coordinate| Link {
            before: None,
            frame: Pose::identity(),
            motion,
            coordinate,
            ratio: 1.0,
            offset: 0.0,
        };
        let links = [
            link(LinkMotion::Turn, 0),
            link(LinkMotion::Slide, 1),
            link(LinkMotion::Turn, 1),
        ];
        let joint = coupled(&links, &PORTS).expect("links of a joint");
        let units = joint.units();
        assert_eq!(units.coordinates, [Unit::ANGLE, Unit::LENGTH]);
        assert_eq!(units.speed(1), Unit::LENGTH);
        assert_eq!(units.speed(2), Unit::UNKNOWN);
    }
}
