//! What links obey beyond the tree that they are, on the graph: relations that are linear in the rates d of the coordinates, `G d = 0`, and the derivatives of G.
//!
//! A closure holds between frames P and S. With w the twist of P in S, in the axes of P, p the origin of S and c the directions of its axes, there as well,
//!
//! ```text
//! p_i = 0:   (v + ω × p)_i = 0        R_ij = 0:   (ω × c_j)_i = 0        ṗ = −(v + ω × p),   ċ = −ω × c
//! ```
//!
//! On the manifold the entries of p and c that relations make 0 are 0, and stay so: where a hinge or a ball closes the loop, p is 0, and G has entries of twists and no others. Entries that are
//! known are numbers here, so that G is that of the relations on the manifold alone, and its derivatives are those along the manifold.

use super::chain::{Chain, Direction};
use super::graph::Sym;
use super::spatial::{Step, Twist, Vec3, cross};
use hamel_runtime::joint::{self, Link, Relation};
use hamel_runtime::spatial::Pose;
use num_traits::Zero;
use rustc_hash::FxHashMap;
use std::cell::{OnceCell, RefCell};

/// The ties of a joint.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ties(Vec<Tie>);

#[derive(Clone, Debug, PartialEq)]
enum Tie {
    /// Coefficients of rates.
    Sum(Vec<(usize, f64)>),
    /// A loop is closed.
    Closure(Box<Closure>),
}

#[derive(Clone, Debug, PartialEq)]
struct Closure {
    /// From S to P.
    chain: Chain,
    relations: Vec<Relation>,
    /// p.
    origin: Mark,
    /// The c_j.
    axes: [Mark; 3],
}

/// The origin of S, or an axis, in the axes of P.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mark {
    /// The number of the axis; `None` of the origin.
    axis: Option<usize>,
    /// Entries that stay what they are.
    known: [Option<f64>; 3],
}

impl Ties {
    /// Those of a joint at its start.
    pub(super) fn new(links: &[Link], ties: &[joint::Tie], start: &[f64]) -> Self {
        let tie = |tie: &joint::Tie| match tie {
            joint::Tie::Sum { terms, .. } => {
                let terms = terms.iter().filter_map(|(link, weight)| {
                    let link = links.get(*link)?;
                    Some((link.coordinate, weight * link.ratio))
                });
                Tie::Sum(terms.collect())
            }
            joint::Tie::Closure {
                links: ends,
                frames,
                relations,
                implied,
            } => {
                let all = [relations.as_slice(), implied].concat();
                let turned = turned(links, start, (*ends, frames));
                Tie::Closure(Box::new(Closure {
                    chain: Chain::between(links, *ends, frames),
                    relations: relations.clone(),
                    origin: Mark::origin(&all),
                    axes: [0, 1, 2].map(|j| Mark::axis(j, &all, &turned)),
                }))
            }
        };
        Self(ties.iter().map(tie).collect())
    }

    /// How many relations there are.
    pub(super) fn count(&self) -> usize {
        let counts = self.0.iter().map(|tie| match tie {
            Tie::Sum(_) => 1,
            Tie::Closure(closure) => closure.relations.len(),
        });
        counts.sum()
    }

    /// `G d`, differentiated along each of the directions, of which all but the last are tangent to the manifold.
    pub(super) fn rates(&self, q: &[Sym], d: Direction<'_>, along: &[Direction<'_>]) -> Vec<Sym> {
        let rates = self.0.iter().flat_map(|tie| match tie {
            Tie::Sum(_) if !along.is_empty() => vec![Sym::zero()],
            Tie::Sum(terms) => {
                let terms = terms.iter();
                vec![terms.map(|(k, weight)| Sym::from(*weight) * d[*k]).sum()]
            }
            Tie::Closure(closure) => closure.rates(q, d, along),
        });
        rates.collect()
    }
}

/// R: the axes of S in those of P.
fn turned(
    links: &[Link],
    q: &[f64],
    (ends, frames): ([Option<usize>; 2], &[Pose<f64>; 2]),
) -> nalgebra::Matrix3<f64> {
    let [first, second] = [0, 1].map(|end: usize| {
        let stands = Link::stands::<f64>(links, q, ends[end]);
        stands.rotation * frames[end].rotation
    });
    first.transpose() * second
}

/// Each set of the directions, with those that are not in it, in their order.
fn sets(along: &[usize]) -> Vec<[Vec<usize>; 2]> {
    let of = |set: usize| {
        [1, 0].map(|is_in: usize| {
            let directions = along.iter().enumerate();
            let own = directions.filter(|(n, _)| set >> n & 1 == is_in);
            own.map(|(_, direction)| *direction).collect()
        })
    };
    (0..1 << along.len()).map(of).collect()
}

/// A chain at one configuration, of which what several relations ask for is computed once.
struct ChainAt<'a> {
    chain: &'a Chain,
    q: &'a [Sym],
    /// The rates d, then the directions along which is differentiated. They are named by their places here.
    directions: Vec<Direction<'a>>,
    pose: OnceCell<Vec<Step>>,
    twists: RefCell<FxHashMap<Vec<usize>, Twist>>,
}

impl ChainAt<'_> {
    /// The pose of P in S, in factors.
    fn pose(&self) -> &[Step] {
        self.pose.get_or_init(|| self.chain.pose(self.q))
    }

    /// w at the rates of place d, differentiated along those of the places `along`.
    fn twist(&self, d: usize, along: &[usize]) -> Twist {
        let key = [&[d], along].concat();
        if let Some(known) = self.twists.borrow().get(&key) {
            return known.clone();
        }
        let along: Vec<Direction<'_>> = along.iter().map(|&n| self.directions[n]).collect();
        let twist = self.chain.twist(self.q, self.directions[d], &along);
        self.twists.borrow_mut().insert(key, twist.clone());
        twist
    }
}

impl Closure {
    /// The rows of `G d`, differentiated.
    fn rates(&self, q: &[Sym], d: Direction<'_>, along: &[Direction<'_>]) -> Vec<Sym> {
        let at = ChainAt {
            chain: &self.chain,
            q,
            directions: [&[d], along].concat(),
            pose: OnceCell::new(),
            twists: RefCell::default(),
        };
        let along: Vec<usize> = (1..=along.len()).collect();
        // The origin, then the axes.
        let [x, y, z] = &self.axes;
        let marks = [&self.origin, x, y, z];
        let mut carried = [const { None::<Vec3> }; 4];
        let rate = |relation: &Relation| {
            let (i, mark) = match *relation {
                Relation::Meets(i) => (i, 0),
                Relation::Square(i, j) => (i, 1 + j),
            };
            carried[mark].get_or_insert_with(|| marks[mark].carried(&at, 0, &along))[i]
        };
        self.relations.iter().map(rate).collect()
    }
}

impl Mark {
    fn origin(relations: &[Relation]) -> Self {
        let known = |i| relations.contains(&Relation::Meets(i)).then_some(0.0);
        Self {
            axis: None,
            known: [0, 1, 2].map(known),
        }
    }

    /// Where two entries of an axis are 0 it is the third, this way or that.
    fn axis(j: usize, relations: &[Relation], turned: &nalgebra::Matrix3<f64>) -> Self {
        let known = |i| relations.contains(&Relation::Square(i, j)).then_some(0.0);
        let mut known = [0, 1, 2].map(known);
        if known.iter().flatten().count() == 2 {
            let third = (0..3).find(|i| known[*i].is_none());
            third
                .into_iter()
                .for_each(|i| known[i] = Some(turned[(i, j)].signum()));
        }
        Self {
            axis: Some(j),
            known,
        }
    }

    /// `v + ω × p`, or `ω × c`, at the rates of place d, differentiated along those of the places `along`.
    fn carried(&self, at: &ChainAt<'_>, d: usize, along: &[usize]) -> Vec3 {
        let still = match self.axis {
            None => at.twist(d, along).linear,
            Some(_) => Vec3::zeros(),
        };
        let parts = sets(along).into_iter().map(|[own, others]| {
            let angular = at.twist(d, &others).angular;
            cross(&angular, &self.stands(at, &own))
        });
        parts.fold(still, |sum, part| sum + part)
    }

    /// p or c, differentiated.
    fn stands(&self, at: &ChainAt<'_>, along: &[usize]) -> Vec3 {
        let own = match along {
            _ if self.known.iter().all(Option::is_some) => Vec3::zeros(),
            [] => self.value(at.pose()),
            [first, others @ ..] => -self.carried(at, *first, others),
        };
        let entry = |i: usize| match self.known[i] {
            Some(_) if !along.is_empty() => Sym::zero(),
            Some(known) => Sym::from(known),
            None => own[i],
        };
        Vec3::from_fn(|i, _| entry(i))
    }

    /// p or c, from the pose of P in S.
    fn value(&self, steps: &[Step]) -> Vec3 {
        let start = Vec3::from_fn(|i, _| Sym::from(f64::from(u8::from(self.axis == Some(i)))));
        steps.iter().fold(start, |mark, step| match step {
            Step::Shift(by) if self.axis.is_none() => mark - by,
            step => step.to_child(&mark),
        })
    }
}
