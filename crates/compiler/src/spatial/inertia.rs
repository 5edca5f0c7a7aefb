//! Inertias of rigid bodies, and those that mechanisms show at one of their bodies.

use super::{Mat3, Step, Twist, Vec3, Wrench, apply, cross, product, symmetric, tilde};
use crate::graph::Sym;
use num_traits::Zero;

/// A rigid body's inertia about the origin of its axes: 10 parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Rigid {
    /// Mass.
    pub mass: Sym,
    /// Mass times position of its centre.
    pub first: Vec3,
    /// Second moments `J = ∫ r rᵀ dm`: of all forms of the ten parameters the one that takes the fewest operations to shift and to turn
    /// with.
    pub second: Mat3,
}

impl Rigid {
    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first: self.first + other.first,
            second: symmetric(|i, j| self.second[(i, j)] + other.second[(i, j)]),
        }
    }

    /// The same inertia, read at the parent of a placement.
    #[must_use]
    pub fn to_parent(&self, steps: &[Step]) -> Self {
        steps
            .iter()
            .rev()
            .fold(self.clone(), |inertia, step| match step {
                Step::Shift(by) => inertia.shifted(by),
                _ => Self {
                    mass: inertia.mass,
                    first: step.to_parent(&inertia.first),
                    second: step.turned(&inertia.second, true),
                },
            })
    }

    /// About a point from which the present one stands at `by`: `J + p kᵀ + k pᵀ` with `k = h + m p / 2`.
    fn shifted(&self, by: &Vec3) -> Self {
        let half = Sym::from(0.5);
        let k = self.first + by * (self.mass * half);
        let twice = by + by;
        Self {
            mass: self.mass,
            first: self.first + by * self.mass,
            second: symmetric(|i, j| {
                let own = self.second[(i, j)];
                match i == j {
                    true => own + twice[i] * k[i],
                    false => own + (by[i] * k[j] + k[i] * by[j]),
                }
            }),
        }
    }

    /// The same without signs beside its scalars ([`Sym::settled`]).
    #[must_use]
    pub fn settled(&self) -> Self {
        Self {
            mass: self.mass.settled(),
            first: self.first.map(Sym::settled),
            second: self.second.map(Sym::settled),
        }
    }

    /// Moments and products of inertia, `I = tr(second) 1 − second`.
    pub fn moments(&self) -> Mat3 {
        let second = &self.second;
        symmetric(|i, j| match i == j {
            true => second[((i + 1) % 3, (i + 1) % 3)] + second[((i + 2) % 3, (i + 2) % 3)],
            false => -second[(i, j)],
        })
    }

    /// The momentum of a twist.
    pub fn of(&self, twist: &Twist) -> Wrench {
        Wrench {
            moment: apply(&self.moments(), &twist.angular) + cross(&self.first, &twist.linear),
            force: twist.linear * self.mass + cross(&twist.angular, &self.first),
        }
    }
}

/// The inertia that a mechanism shows at one of its bodies: `[A B; Bᵀ M]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Articulated {
    /// Angular block A.
    pub angular: Mat3,
    /// Block B, from linear to moment.
    pub coupling: Mat3,
    /// Linear block M.
    pub linear: Mat3,
}

impl Articulated {
    /// The same without signs beside its scalars ([`Sym::settled`]).
    #[must_use]
    pub fn settled(&self) -> Self {
        Self {
            angular: self.angular.map(Sym::settled),
            coupling: self.coupling.map(Sym::settled),
            linear: self.linear.map(Sym::settled),
        }
    }

    /// That of a rigid body.
    pub fn rigid(inertia: &Rigid) -> Self {
        let zero = Sym::zero();
        Self {
            angular: inertia.moments(),
            coupling: tilde(&inertia.first),
            linear: symmetric(|i, j| if i == j { inertia.mass } else { zero }),
        }
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            angular: symmetric(|i, j| self.angular[(i, j)] + other.angular[(i, j)]),
            coupling: self.coupling + other.coupling,
            linear: symmetric(|i, j| self.linear[(i, j)] + other.linear[(i, j)]),
        }
    }

    /// An entry of the 6×6 matrix.
    fn at(&self, i: usize, j: usize) -> Sym {
        match (i < 3, j < 3) {
            (true, true) => self.angular[(i, j)],
            (true, false) => self.coupling[(i, j - 3)],
            (false, true) => self.coupling[(j, i - 3)],
            (false, false) => self.linear[(i - 3, j - 3)],
        }
    }

    fn from_upper(entry: impl Fn(usize, usize) -> Sym) -> Self {
        Self {
            angular: symmetric(&entry),
            coupling: Mat3::from_fn(|i, j| entry(i, j + 3)),
            linear: symmetric(|i, j| entry(i + 3, j + 3)),
        }
    }

    /// The wrench that an acceleration takes.
    pub fn of(&self, twist: &Twist) -> Wrench {
        Wrench {
            moment: apply(&self.angular, &twist.angular) + apply(&self.coupling, &twist.linear),
            force: apply(&self.coupling.transpose(), &twist.angular)
                + apply(&self.linear, &twist.linear),
        }
    }

    /// `I − y yᵀ / d`, with `scaled = y / d`; of an entry of twists that is said to be `free` nothing is left, exactly.
    #[must_use]
    pub fn without(&self, free: Option<usize>, y: &Wrench, scaled: &Wrench) -> Self {
        let entries =
            |w: &Wrench| -> Vec<Sym> { w.moment.iter().chain(&w.force).copied().collect() };
        let (y, scaled) = (entries(y), entries(scaled));
        Self::from_upper(|i, j| match free == Some(i) || free == Some(j) {
            true => Sym::zero(),
            false => self.at(i, j) - y[i] * scaled[j],
        })
    }

    /// The same inertia, read at the parent of a placement.
    #[must_use]
    pub fn to_parent(&self, steps: &[Step]) -> Self {
        steps
            .iter()
            .rev()
            .fold(self.clone(), |inertia, step| match step {
                Step::Shift(by) => inertia.shifted(by),
                _ => Self {
                    angular: step.turned(&inertia.angular, true),
                    coupling: step.turned(&inertia.coupling, false),
                    linear: step.turned(&inertia.linear, true),
                },
            })
    }

    /// `B′ = B + p~ M`, `A′ = A − B p~ + p~ B′ᵀ`, with what an entry of p~ multiplies added up first.
    fn shifted(&self, by: &Vec3) -> Self {
        let (p, before) = (tilde(by), &self.coupling);
        let coupling = before + product(&p, &self.linear);
        let diagonal = |i: usize| -> Sym {
            let others = (0..3).filter(|&k| k != i);
            let terms = others.map(|k| p[(i, k)] * (coupling[(i, k)] + before[(i, k)]));
            terms.sum()
        };
        let beside = |i: usize, j: usize| {
            let k = 3 - i - j;
            p[(i, j)] * (coupling[(j, j)] - before[(i, i)])
                + (p[(i, k)] * coupling[(j, k)] - before[(i, k)] * p[(k, j)])
        };
        Self {
            angular: symmetric(|i, j| {
                let more = if i == j { diagonal(i) } else { beside(i, j) };
                self.angular[(i, j)] + more
            }),
            coupling,
            linear: self.linear,
        }
    }
}
