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
use super::spatial::{Mat3, Step, Twist, Vec3, Wrench};
use super::ties::Ties;
use hamel_runtime::joint::Link;
use hamel_scene::Coupling;
use num_traits::{One, Zero};
use rustc_hash::FxHashMap;
use std::cell::RefCell;
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
    /// Coordinate of each link, and ratio and offset: what its joint stands at is ratio times the coordinate, and the offset.
    ports: Vec<(usize, [f64; 2])>,
    /// The joint of the scene that each link moves by.
    names: Vec<&'static str>,
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
    columns: Vec<Direction>,
    /// D(B_k, B_l), by k ≤ l, of pairs that were asked for.
    bends: RefCell<FxHashMap<[usize; 2], Direction>>,
    /// How column k of X^c changes along ϕ_l, by k and l, in the same way.
    columns_moved: RefCell<FxHashMap<[usize; 2], Twist>>,
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
        let port = |link: &Link| (link.coordinate, [link.ratio, link.offset]);
        Self {
            ties: Ties::new(&coupling.links, &coupling.ties, &coupling.start),
            ports: links.map(port).collect(),
            names: coupling.ports.iter().map(|port| port.name).collect(),
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

    /// The joints of the scene that a coordinate moves, each with ratio and offset: it stands at ratio times the coordinate, and the offset.
    pub(crate) fn moved_by(
        &self,
        coordinate: usize,
    ) -> impl Iterator<Item = (&'static str, [f64; 2])> {
        let ports = self.joint.names.iter().zip(&self.joint.ports);
        let own = ports.filter(move |(_, (own, _))| *own == coordinate);
        own.map(|(name, (_, line))| (*name, *line))
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
            bends: RefCell::default(),
            columns_moved: RefCell::default(),
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
            let follow = self.solved(&matrix[k], "follows");
            Direction {
                rates: alone(k).into_iter().take(own).chain(follow).collect(),
                times: Sym::one(),
            }
        };
        self.columns = (0..own).map(column).collect();
    }

    /// The columns of B.
    pub(super) fn tangent(&self) -> Vec<Vec<Sym>> {
        self.columns.iter().map(Direction::whole).collect()
    }

    /// `−G_d⁻¹` times what is given, one entry per dependent coordinate, which are called so where they are written.
    fn solved(&self, given: &[Sym], name: &str) -> Vec<Sym> {
        let right: Vec<Vec<Sym>> = given.iter().map(|&entry| vec![-entry]).collect();
        let solution = square(&self.followed, &right).into_iter().flatten();
        solution.map(|entry| entry.named(name)).collect()
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
        sum(&self.columns, x)
    }

    /// D(d, e), or what else bends: dependent entries for what the relations ask for.
    fn following(&self, asked: &[Sym], times: Sym) -> Direction {
        let still = (0..self.freedoms()).map(|_| Sym::zero());
        Direction {
            rates: still.chain(self.solved(asked, "bend")).collect(),
            times,
        }
    }

    /// D(d, e).
    fn bend(&self, d: &Direction, e: &Direction) -> Direction {
        self.following(&self.ties(&d.rates, &[&e.rates]), d.times * e.times)
    }

    /// D(B_k, B_l), which is symmetric.
    fn bend_of_pair(&self, k: usize, l: usize) -> Direction {
        let pair = [k.min(l), k.max(l)];
        if let Some(known) = self.bends.borrow().get(&pair) {
            return known.clone();
        }
        let bend = self.bend(&self.columns[pair[0]], &self.columns[pair[1]]);
        self.bends.borrow_mut().insert(pair, bend.clone());
        bend
    }

    /// `D(B x, B_l)`, of the D of all pairs of columns.
    fn bend_of_columns(&self, x: &[Sym], l: usize) -> Direction {
        let bends: Vec<Direction> = (0..x.len()).map(|k| self.bend_of_pair(k, l)).collect();
        sum(&bends, x)
    }

    /// `F(d; e) + F(D(d, e))`.
    fn moved_along(&self, d: &Direction, e: &Direction, bend: &Direction) -> Twist {
        let of: Linear<'_> = &|d, along| self.twist(d, along);
        to_twist(&plus(value(of, d, &[e]), value(of, bend, &[])))
    }

    /// How column k of X^c changes along ϕ_l.
    fn column_moved(&self, k: usize, l: usize) -> Twist {
        if let Some(known) = self.columns_moved.borrow().get(&[k, l]) {
            return known.clone();
        }
        let bend = self.bend_of_pair(k, l);
        let twist = self.moved_along(&self.columns[k], &self.columns[l], &bend);
        self.columns_moved
            .borrow_mut()
            .insert([k, l], twist.clone());
        twist
    }

    /// The four terms of the derivative of `F(d; d) + F(D(d, d))` along column l, with D(d, B_l) and D(d, d).
    fn moved_again(
        &self,
        of: Linear<'_>,
        [d, column]: [&Direction; 2],
        [along_column, bend]: [&Direction; 2],
    ) -> Vec<Sym> {
        let own = value(of, d, &[d, column]);
        let turned = value(of, along_column, &[d]);
        let along = value(of, d, &[along_column]);
        plus(plus(own, turned), plus(along, value(of, bend, &[column])))
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
            .map(|column| to_twist(&self.twist(&column.rates, &[])))
            .collect()
    }

    /// The columns of X.
    pub(super) fn freedoms_in_parent(&self) -> Vec<Twist> {
        let steps = self.pose();
        let to_parent = |twist: Twist| {
            let steps = steps.iter().rev();
            steps.fold(twist, |twist, step| step.twist_to_parent(&twist))
        };
        self.freedoms_in_child()
            .into_iter()
            .map(to_parent)
            .collect()
    }

    /// ∂(X^c x)/∂ϕ, one column per degree of freedom.
    pub(super) fn gradient(&self, x: &[Sym]) -> Vec<Twist> {
        let along = |l| {
            let parts = x.iter().enumerate();
            let parts = parts.map(|(k, &x)| self.column_moved(k, l).times(x));
            parts.fold(Twist::zero(), |sum, part| sum.plus(&part))
        };
        (0..self.freedoms()).map(along).collect()
    }

    /// ∂(X^cᵀ h)/∂ϕ by rows, one per degree of freedom.
    pub(super) fn effort_gradient(&self, wrench: &Wrench) -> Vec<Vec<Sym>> {
        let entry = |k, l| self.column_moved(k, l).dot(wrench);
        let row = |k| (0..self.freedoms()).map(|l| entry(k, l)).collect();
        (0..self.freedoms()).map(row).collect()
    }

    /// `c = Ẋ^c v`.
    pub(super) fn bias(&self) -> Twist {
        let d = self.direction(&self.speeds);
        self.moved_along(&d, &d, &self.bend(&d, &d))
    }

    /// `Ẋ^cᵀ h`, one per degree of freedom.
    pub(super) fn bias_momentum(&self, momentum: &Wrench) -> Vec<Sym> {
        let d = self.direction(&self.speeds);
        let columns = self.columns.iter();
        let moved = columns.map(|column| self.moved_along(column, &d, &self.bend(column, &d)));
        moved.map(|twist| twist.dot(momentum)).collect()
    }

    /// ∂c/∂v, one column per degree of freedom.
    pub(super) fn bias_slope(&self) -> Vec<Twist> {
        let column = |l| {
            let speeds = self.speeds.iter().enumerate();
            let parts = speeds.map(|(k, &v)| {
                let both = self.column_moved(k, l).plus(&self.column_moved(l, k));
                both.times(v)
            });
            parts.fold(Twist::zero(), |sum, part| sum.plus(&part))
        };
        (0..self.freedoms()).map(column).collect()
    }

    /// ∂c/∂ϕ, one column per degree of freedom.
    pub(super) fn bias_gradient(&self) -> Vec<Twist> {
        let d = self.direction(&self.speeds);
        let bends: Vec<Direction> = (0..self.freedoms())
            .map(|l| self.bend_of_columns(&self.speeds, l))
            .collect();
        let bend = sum(&bends, &self.speeds);
        let column = |(l, along_column): (usize, &Direction)| {
            let (pair, bends) = ([&d, &self.columns[l]], [along_column, &bend]);
            let asked = self.moved_again(&|d, along| self.ties(d, along), pair, bends);
            let bent = self.following(&asked, Sym::one());
            let of: Linear<'_> = &|d, along| self.twist(d, along);
            to_twist(&plus(
                self.moved_again(of, pair, bends),
                value(of, &bent, &[]),
            ))
        };
        bends.iter().enumerate().map(column).collect()
    }

    /// `Q̇ = B v`.
    pub(super) fn configuration_rate(&self, v: &[Sym]) -> Vec<Sym> {
        sum(&self.columns, v).whole()
    }

    /// Coordinates ϕ of a target: the dependent ones are those along which Φ comes back.
    pub(super) fn local(&self, target: &[Sym]) -> Vec<Sym> {
        let own = target.iter().zip(&self.q).take(self.freedoms());
        own.map(|(&target, &q)| target - q).collect()
    }

    /// P by rows, one per link.
    pub(super) fn port_map(&self) -> Vec<Vec<Sym>> {
        let row = |&(coordinate, [ratio, _]): &(usize, [f64; 2])| {
            let columns = self.columns.iter();
            columns
                .map(|column| Sym::from(ratio) * column.rates[coordinate])
                .collect()
        };
        self.linkage.joint.ports.iter().map(row).collect()
    }
}

impl Direction {
    /// Its rates, with the scalar.
    fn whole(&self) -> Vec<Sym> {
        self.rates.iter().map(|&rate| rate * self.times).collect()
    }
}

/// `Σ d_k x_k`: where there is one, that one, times its x.
fn sum(directions: &[Direction], x: &[Sym]) -> Direction {
    if let ([one], [x]) = (directions, x) {
        return Direction {
            times: one.times * *x,
            ..one.clone()
        };
    }
    let wholes: Vec<Vec<Sym>> = directions.iter().map(Direction::whole).collect();
    let count = wholes.first().map_or(0, Vec::len);
    let rate = |i: usize| wholes.iter().zip(x).map(|(whole, &x)| whole[i] * x).sum();
    Direction {
        rates: (0..count).map(rate).collect(),
        times: Sym::one(),
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
