//! Inverse dynamics: what efforts an acceleration takes (recursive Newton–Euler).

use super::{Tree, Wrench, number, to_child, wrench_to_parent};
use crate::graph::{Argument, Sym, section};
use crate::spatial::{Mat3, Rigid, Step, Twist, Vec3, apply, cross, symmetric};
use num_traits::Zero;

/// `α~ + ω~ω~`: the acceleration of a point of the body from that of its origin.
pub struct Spin {
    matrix: Mat3,
    /// `ω ωᵀ`.
    squares: Mat3,
    omega: Vec3,
    alpha: Vec3,
}

impl Spin {
    /// From angular velocity and acceleration.
    pub fn new(omega: &Vec3, alpha: &Vec3) -> Self {
        let squares = symmetric(|i, j| omega[i] * omega[j]);
        let matrix = Mat3::from_fn(|i, j| {
            if i == j {
                return -(squares[((i + 1) % 3, (i + 1) % 3)]
                    + squares[((i + 2) % 3, (i + 2) % 3)]);
            }
            let k = 3 - i - j;
            let positive = (i + 1) % 3 == k;
            squares[(i, j)] + if positive { alpha[k] } else { -alpha[k] }
        });
        Self {
            matrix,
            squares,
            omega: *omega,
            alpha: *alpha,
        }
    }

    /// Acceleration that the spin adds at a point.
    pub fn at(&self, point: &Vec3) -> Vec3 {
        apply(&self.matrix, point)
    }

    /// V̇ of a body whose origin moves at `v` and is accelerated by `a`: what is left of it without `ω × v`.
    pub fn rate(&self, a: &Vec3, v: &Vec3) -> Twist {
        Twist {
            angular: self.alpha,
            linear: a - cross(&self.omega, v),
        }
    }

    /// What it takes to move a body so, with its origin accelerated by `a`.
    pub fn wrench(&self, inertia: &Rigid, a: &Vec3) -> Wrench {
        Wrench {
            moment: self.moment(inertia) + cross(&inertia.first, a),
            force: a * inertia.mass + self.at(&inertia.first),
        }
    }

    /// `I α + ω × I ω = ∫ r × U r dm` with `U = α~ + ω~ω~`, which its second moments J make in fewer products: two for a square, three for
    /// another.
    fn moment(&self, inertia: &Rigid) -> Vec3 {
        let (u, second) = (&self.matrix, &inertia.second);
        Vec3::from_fn(|i, _| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let squares = self.squares[(k, k)] - self.squares[(j, j)];
            self.moment_of_squares(inertia, i)
                + u[(k, i)] * second[(i, j)]
                + squares * second[(j, k)]
                - u[(j, i)] * second[(i, k)]
        })
    }

    /// `U_kj J_jj − U_jk J_kk`. Where neither second moment vanishes their sum is what is known well, a moment of inertia.
    fn moment_of_squares(&self, inertia: &Rigid, i: usize) -> Sym {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let (first, second) = (inertia.second[(j, j)], inertia.second[(k, k)]);
        let products = self.squares[(j, k)];
        let is_whole = !self.alpha[i].is_zero() && !products.is_zero();
        match (first.is_zero(), second.is_zero()) {
            (false, true) if is_whole => self.matrix[(k, j)] * first,
            (true, false) if is_whole => -self.matrix[(j, k)] * second,
            _ => self.alpha[i] * (first + second) + products * (first - second),
        }
    }
}

impl Tree<'_> {
    /// The efforts τ̄ that inputs must exert, beside those that the scene applies, for the given accelerations, `None` for none.
    pub fn needed_efforts(&self, accelerations: Option<Argument>) -> Vec<Sym> {
        let count = self.model.sizes()[2];
        let rates = accelerations.map(|argument| {
            (0..count)
                .map(|i| Sym::input(argument, i))
                .collect::<Vec<_>>()
        });
        let mut efforts = self.inverse_dynamics(rates.as_deref());
        for (index, body) in self.joints() {
            section(number(index), "effort");
            for (place, applied) in body.share.speeds.clone().zip(self.efforts(index, None)) {
                efforts[place] -= applied;
            }
        }
        efforts
    }

    /// The efforts τ̄ that the given v̄̇ takes in all, beside what acts on the bodies.
    pub(super) fn inverse_dynamics(&self, rates: Option<&[Sym]>) -> Vec<Sym> {
        let external = self.external();
        let (spins, linear) = self.accelerations(rates, &self.ground());
        let mut wrenches: Vec<Wrench> = vec![];
        for (index, external) in external.iter().enumerate() {
            section(number(index), "force");
            let inertia = self.links[index].inertia.on_graph();
            let needed = spins[index].wrench(&inertia, &linear[index]);
            wrenches.push(needed.plus(&external.times(Sym::Number(-1.0))));
        }
        self.efforts_of(wrenches, rates)
    }

    /// How each body turns, and the acceleration of its origin, at the given v̄̇ and an acceleration of the world.
    pub(super) fn accelerations(
        &self,
        rates: Option<&[Sym]>,
        world: &Vec3,
    ) -> (Vec<Spin>, Vec<Vec3>) {
        let velocities = self.angular_velocities();
        let mut spins: Vec<Spin> = vec![];
        let mut linear: Vec<Vec3> = vec![];
        for (index, body) in self.bodies.iter().enumerate() {
            section(number(index), "acceleration");
            let mut acceleration = self.bias(index, &velocities);
            let (alpha, a) = match body.parent {
                Some(parent) => (
                    spins[parent].alpha,
                    self.carried_origin(index, &spins[parent], &linear[parent]),
                ),
                None => (Vec3::zeros(), to_child(&body.steps, world)),
            };
            if let Some(rates) = rates {
                let own = self.along(index, &rates[body.share.speeds.clone()]);
                acceleration = acceleration.plus(&own);
            }
            let alpha = (to_child(&body.steps, &alpha) + acceleration.angular).map(Sym::settled);
            spins.push(Spin::new(&velocities[index].0, &alpha));
            linear.push((a + acceleration.linear).map(Sym::settled));
        }
        (spins, linear)
    }

    /// Acceleration of a child's origin as its parent carries it, in the child's axes: `Rᵀ (a + (α~ + ω~ω~) p)`, with shifts that
    /// stand behind turns carried along.
    fn carried_origin(&self, index: usize, spin: &Spin, a: &Vec3) -> Vec3 {
        let steps = &self.bodies[index].steps;
        let mut place = Vec3::zeros();
        for step in steps.iter().rev() {
            place = match step {
                Step::Shift(by) => place + by,
                turn => turn.to_parent(&place),
            };
        }
        to_child(steps, &(a + spin.at(&place)))
    }

    /// τ̄ from the wrench of each body.
    pub(super) fn efforts_of(&self, mut wrenches: Vec<Wrench>, rates: Option<&[Sym]>) -> Vec<Sym> {
        let mut efforts = vec![Sym::zero(); self.model.sizes()[2]];
        let mut seen: Vec<Vec<Wrench>> = self.bodies.iter().map(|_| vec![]).collect();
        for (index, body) in self.bodies.iter().enumerate().rev() {
            section(number(index), "effort");
            for wrench in std::mem::take(&mut seen[index]) {
                wrenches[index] = wrenches[index].plus(&wrench);
            }
            for (j, place) in body.share.speeds.clone().enumerate() {
                let mut effort = body.columns[j].dot(&wrenches[index]);
                if let Some(rates) = rates {
                    for (k, other) in body.share.speeds.clone().enumerate() {
                        effort += self.armature(index, j, k) * rates[other];
                    }
                }
                efforts[place] += effort;
            }
            if let Some(parent) = body.parent {
                seen[parent].push(wrench_to_parent(&body.steps, &wrenches[index]).settled());
            }
        }
        efforts
    }

    /// Acceleration of a body's origin that the turning of its parent alone makes.
    pub(super) fn centripetal(&self, index: usize, omega: &Vec3) -> Twist {
        let spin = Spin::new(omega, &Vec3::zeros());
        Twist {
            angular: Vec3::zeros(),
            linear: self.carried_origin(index, &spin, &Vec3::zeros()),
        }
    }
}
