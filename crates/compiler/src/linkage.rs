//! Kernels of a body of links that move together, on the graph.
//!
//! The first K coordinates are independent. [`Ties`] are relations `G q̇ = 0`, so that `q̇ = B v` with `B = [I; −G_d⁻¹ G_i]`; without them B is the identity. With w(d) the twist of the body at rates d of the
//! coordinates, and its derivatives w(d; e) along a direction e ([`Chain`]), the columns of X^c are `w(B_k)`. G and w are linear in d: along a tangent direction e a tangent direction d bends by D(d, e),
//! and both again by T(d, e, f), whose dependent entries are
//!
//! ```text
//! G D(d, e)    = −G(d; e)
//! G T(d, e, f) = −(G(d; e, f) + G(D(d, f); e) + G(d; D(e, f)) + G(D(d, e); f))
//! ```
//!
//! and w changes by `w(d; e) + w(D(d, e))`, then by the same four terms and w(T). All systems have the matrix G_d, which is found and solved once.

use super::chain::Chain;
use super::equations::solve::square;
use super::graph::Sym;
use super::spatial::{Mat3, Step, Twist, Vec3, Wrench, cross};
use super::ties::Ties;
use hamel_runtime::joint::Link;
use hamel_scene::Coupling;
use num_traits::{One, Zero};
use std::rc::Rc;

/// The links of a joint, as one of its bodies sees them.
#[derive(Clone, Debug)]
pub(crate) struct Linkage {
    /// From the joint's parent to the body.
    chain: Chain,
    joint: Rc<Whole>,
}

/// What all bodies of the joint share.
#[derive(Debug)]
pub(super) struct Whole {
    ties: Ties,
    /// Coordinate and ratio of each link.
    ports: Vec<(usize, f64)>,
    home: Vec<f64>,
}

/// The linkage at one state.
pub(super) struct At<'a> {
    linkage: &'a Linkage,
    q: Vec<Sym>,
    speeds: Vec<Sym>,
    /// G_d by rows.
    followed: Vec<Vec<Sym>>,
    /// The columns of B.
    columns: Vec<Vec<Sym>>,
}

/// Rates of the coordinates, times a scalar: with one degree of freedom all are multiples of the one column of B.
#[derive(Clone)]
struct Direction {
    rates: Vec<Sym>,
    times: Sym,
}

/// What is linear in rates of the coordinates, with its derivatives along directions.
type Linear<'f> = &'f dyn Fn(&[Sym], &[&[Sym]]) -> Vec<Sym>;

impl Whole {
    /// Of a coupling whose joint has this home.
    pub(super) fn new(coupling: &Coupling, home: Vec<f64>) -> Self {
        let links = coupling.links.iter();
        let port = |link: &Link| (link.coordinate, link.ratio);
        Self {
            ties: Ties::new(&coupling.links, &coupling.ties, &coupling.start),
            ports: links.map(port).collect(),
            home,
        }
    }

    fn coordinates(&self) -> usize {
        self.home.len()
    }

    /// How many coordinates are independent.
    pub(super) fn freedoms(&self) -> usize {
        self.coordinates().saturating_sub(self.ties.count())
    }
}

impl Linkage {
    /// A body of the joint of a coupling.
    pub(super) fn new(coupling: &Coupling, body: usize, joint: &Rc<Whole>) -> Self {
        Self {
            chain: Chain::of(&coupling.links, body),
            joint: Rc::clone(joint),
        }
    }

    /// Whether its body hangs on no other link.
    pub(super) fn is_one_link(&self) -> bool {
        self.chain.is_one_link()
    }

    /// How many coordinates are independent.
    pub(super) fn freedoms(&self) -> usize {
        self.joint.freedoms()
    }

    /// The stored scalars of the home configuration.
    pub(super) fn home(&self) -> Vec<Sym> {
        self.joint.home.iter().copied().map(Sym::from).collect()
    }

    /// At Q and v.
    pub(super) fn at(&self, q: &[Sym], speeds: &[Sym]) -> At<'_> {
        let mut at = At {
            linkage: self,
            q: q.to_vec(),
            speeds: speeds.to_vec(),
            followed: vec![],
            columns: vec![],
        };
        at.fill();
        at
    }
}

impl At<'_> {
    fn freedoms(&self) -> usize {
        self.linkage.freedoms()
    }

    /// Finds G and B.
    fn fill(&mut self) {
        let (all, own) = (self.linkage.joint.coordinates(), self.freedoms());
        let alone = |k: usize| -> Vec<Sym> { (0..all).map(|i| one_where(i == k)).collect() };
        let matrix: Vec<Vec<Sym>> = (0..all).map(|k| self.ties(&alone(k), &[])).collect();
        let row = |i: usize| matrix[own..].iter().map(|column| column[i]).collect();
        self.followed = (own..all).map(|k| row(k - own)).collect();
        let column = |k: usize| {
            let follow = self.solved(&matrix[k]);
            alone(k).into_iter().take(own).chain(follow).collect()
        };
        self.columns = (0..own).map(column).collect();
    }

    /// The columns of B.
    pub(super) fn tangent(&self) -> Vec<Vec<Sym>> {
        self.columns.clone()
    }

    /// `−G_d⁻¹` times what is given, one entry per dependent coordinate.
    fn solved(&self, given: &[Sym]) -> Vec<Sym> {
        let right: Vec<Vec<Sym>> = given.iter().map(|&entry| vec![-entry]).collect();
        square(&self.followed, &right).concat()
    }

    /// `G d`, and its derivatives.
    fn ties(&self, d: &[Sym], along: &[&[Sym]]) -> Vec<Sym> {
        self.linkage.joint.ties.rates(&self.q, d, along)
    }

    /// w(d), and its derivatives.
    fn twist(&self, d: &[Sym], along: &[&[Sym]]) -> Vec<Sym> {
        let twist = self.linkage.chain.twist(&self.q, d, along);
        twist.angular.iter().chain(&twist.linear).copied().collect()
    }

    /// `B x`.
    fn direction(&self, x: &[Sym]) -> Direction {
        match (self.columns.as_slice(), x) {
            ([column], [x]) => Direction {
                rates: column.clone(),
                times: *x,
            },
            _ => Direction {
                rates: self.configuration_rate(x),
                times: Sym::one(),
            },
        }
    }

    /// B_k.
    fn unit(&self, k: usize) -> Direction {
        Direction {
            rates: self.columns[k].clone(),
            times: Sym::one(),
        }
    }

    /// D(d, e), or what else bends: dependent entries for what the relations ask for.
    fn following(&self, asked: &[Sym], times: Sym) -> Direction {
        let still = (0..self.freedoms()).map(|_| Sym::zero());
        Direction {
            rates: still.chain(self.solved(asked)).collect(),
            times,
        }
    }

    /// D(d, e).
    fn bend(&self, d: &Direction, e: &Direction) -> Direction {
        self.following(&self.ties(&d.rates, &[&e.rates]), d.times * e.times)
    }

    /// `F(d; e) + F(D(d, e))`.
    fn moved(&self, of: Linear<'_>, d: &Direction, e: &Direction) -> Vec<Sym> {
        plus(value(of, d, &[e]), value(of, &self.bend(d, e), &[]))
    }

    /// The four terms of the second derivative along e and f.
    fn moved_again(&self, of: Linear<'_>, d: &Direction, [e, f]: [&Direction; 2]) -> Vec<Sym> {
        let own = value(of, d, &[e, f]);
        let turned = value(of, &self.bend(d, f), &[e]);
        let along = value(of, d, &[&self.bend(e, f)]);
        let bent = value(of, &self.bend(d, e), &[f]);
        plus(plus(own, turned), plus(along, bent))
    }

    fn twists(&self, d: &Direction, e: &Direction) -> Twist {
        to_twist(&self.moved(&|d, along| self.twist(d, along), d, e))
    }

    /// H(Q) in factors.
    pub(super) fn pose(&self) -> Vec<Step> {
        self.linkage.chain.pose(&self.q)
    }

    /// The rotation of H(Q).
    pub(super) fn rotation(&self) -> Mat3 {
        self.linkage.chain.rotation(&self.q)
    }

    /// The columns of X^c, and of X^c S₀.
    pub(super) fn freedoms_in_child(&self) -> Vec<Twist> {
        let columns = self.columns.iter();
        columns
            .map(|column| to_twist(&self.twist(column, &[])))
            .collect()
    }

    /// The columns of X.
    pub(super) fn freedoms_in_parent(&self) -> Vec<Twist> {
        let steps = self.pose();
        let to_parent = |twist: Twist| {
            steps.iter().rev().fold(twist, |twist, step| match step {
                Step::Shift(by) => Twist {
                    linear: twist.linear + cross(by, &twist.angular),
                    angular: twist.angular,
                },
                _ => Twist {
                    angular: step.to_parent(&twist.angular),
                    linear: step.to_parent(&twist.linear),
                },
            })
        };
        self.freedoms_in_child()
            .into_iter()
            .map(to_parent)
            .collect()
    }

    /// ∂(X^c x)/∂ϕ, one column per degree of freedom.
    pub(super) fn gradient(&self, x: &[Sym]) -> Vec<Twist> {
        let d = self.direction(x);
        let along = |l| self.twists(&d, &self.unit(l));
        (0..self.freedoms()).map(along).collect()
    }

    /// ∂(X^cᵀ h)/∂ϕ by rows, one per degree of freedom.
    pub(super) fn effort_gradient(&self, wrench: &Wrench) -> Vec<Vec<Sym>> {
        let entry = |k, l| self.twists(&self.unit(k), &self.unit(l)).dot(wrench);
        let row = |k| (0..self.freedoms()).map(|l| entry(k, l)).collect();
        (0..self.freedoms()).map(row).collect()
    }

    /// `c = Ẋ^c v`.
    pub(super) fn bias(&self) -> Twist {
        let d = self.direction(&self.speeds);
        self.twists(&d, &d)
    }

    /// `Ẋ^cᵀ h`, one per degree of freedom.
    pub(super) fn bias_momentum(&self, momentum: &Wrench) -> Vec<Sym> {
        let d = self.direction(&self.speeds);
        let entry = |k| self.twists(&self.unit(k), &d).dot(momentum);
        (0..self.freedoms()).map(entry).collect()
    }

    /// ∂c/∂v, one column per degree of freedom.
    pub(super) fn bias_slope(&self) -> Vec<Twist> {
        let d = self.direction(&self.speeds);
        let column = |l| {
            let unit = self.unit(l);
            self.twists(&unit, &d).plus(&self.twists(&d, &unit))
        };
        (0..self.freedoms()).map(column).collect()
    }

    /// ∂c/∂ϕ, one column per degree of freedom.
    pub(super) fn bias_gradient(&self) -> Vec<Twist> {
        let d = self.direction(&self.speeds);
        let column = |l| {
            let pair = [&d, &self.unit(l)];
            let asked = self.moved_again(&|d, along| self.ties(d, along), &d, pair);
            let bent = self.following(&asked, Sym::one());
            let twist: Linear<'_> = &|d, along| self.twist(d, along);
            let moved = self.moved_again(twist, &d, pair);
            to_twist(&plus(moved, value(twist, &bent, &[])))
        };
        (0..self.freedoms()).map(column).collect()
    }

    /// `Q̇ = B v`.
    pub(super) fn configuration_rate(&self, v: &[Sym]) -> Vec<Sym> {
        let rate = |i: usize| {
            let terms = self.columns.iter().zip(v);
            terms.map(|(column, &v)| column[i] * v).sum()
        };
        (0..self.q.len()).map(rate).collect()
    }

    /// Coordinates ϕ of a target: the dependent ones are those along which Φ comes back.
    pub(super) fn local(&self, target: &[Sym]) -> Vec<Sym> {
        let own = target.iter().zip(&self.q).take(self.freedoms());
        own.map(|(&target, &q)| target - q).collect()
    }

    /// P by rows, one per link.
    pub(super) fn port_map(&self) -> Vec<Vec<Sym>> {
        let row = |&(coordinate, ratio): &(usize, f64)| {
            let columns = self.columns.iter();
            columns
                .map(|column| Sym::from(ratio) * column[coordinate])
                .collect()
        };
        self.linkage.joint.ports.iter().map(row).collect()
    }
}

/// F(d), differentiated along directions.
fn value(of: Linear<'_>, d: &Direction, along: &[&Direction]) -> Vec<Sym> {
    let directions: Vec<&[Sym]> = along.iter().map(|own| own.rates.as_slice()).collect();
    let times = along.iter().fold(d.times, |times, own| times * own.times);
    let entries = of(&d.rates, &directions).into_iter();
    entries.map(|entry| entry * times).collect()
}

fn plus(a: Vec<Sym>, b: Vec<Sym>) -> Vec<Sym> {
    a.into_iter().zip(b).map(|(a, b)| a + b).collect()
}

fn to_twist(entries: &[Sym]) -> Twist {
    let entry = |i: usize| entries.get(i).copied().unwrap_or_else(Sym::zero);
    Twist {
        angular: Vec3::from_fn(|i, _| entry(i)),
        linear: Vec3::from_fn(|i, _| entry(i + 3)),
    }
}

/// 1 where it is so.
fn one_where(is_so: bool) -> Sym {
    if is_so { Sym::one() } else { Sym::zero() }
}
