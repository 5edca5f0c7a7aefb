//! What springs between points and wrenches from outside exert on bodies.

use super::{Tree, number};
use crate::graph::{Sym, about, call, is_marked, section};
use crate::prune::clean;
use crate::spatial::{Step, Vec3, Wrench, apply, cross, dot};
use hamel_codegen::expr::Function;
use hamel_runtime::elements::{BodySpring, BodyWrench, WrenchAxes};
use nalgebra::Vector3;
use num_traits::Zero;

/// Added to squares of lengths, m²: so far below what is measured that it changes no digit, and enough for a spring whose points coincide
/// to exert no force instead of none that is a number. The smallest normal single.
const NO_LENGTH: f64 = f32::MIN_POSITIVE as f64;

/// A point as it is seen from a body that carries the joints under it.
struct Seen {
    place: Vec3,
    velocity: Vec3,
}

impl Tree<'_> {
    /// The wrench that acts on each body beside gravity, in its frame.
    pub(super) fn external(&self) -> Vec<Wrench> {
        let mut wrenches = vec![Wrench::zero(); self.bodies.len()];
        for spring in &self.model.elements.springs {
            about(&spring.name, || self.add_spring(spring, &mut wrenches));
        }
        for wrench in &self.model.elements.wrenches {
            about(&wrench.name, || self.add_wrench(wrench, &mut wrenches));
        }
        wrenches
    }

    /// The force of a spring is applied at the last body that carries both of its ends: what is between that and the root does not move it.
    fn add_spring(&self, spring: &BodySpring, wrenches: &mut [Wrench]) {
        let [from, to] = self.ends(spring);
        let (between, rate) = (to.place - from.place, to.velocity - from.velocity);
        let force = pull(spring, &between, &rate);
        let common = self.common(spring.bodies);
        for (end, sign) in [(0, 1.0), (1, -1.0)] {
            let Some(body) = spring.bodies[end] else {
                continue;
            };
            let force = self.carried_down(common, body, &(force * Sym::from(sign)));
            let arm = self.point(body, &spring.points[end]);
            let own = Wrench {
                moment: cross(&arm, &force),
                force,
            };
            wrenches[body] = wrenches[body].plus(&own);
        }
    }

    fn add_wrench(&self, wrench: &BodyWrench, wrenches: &mut [Wrench]) {
        let body = wrench.body;
        let own = |a: &Vector3<f64>| match wrench.axes {
            WrenchAxes::World => self.carried_down(None, body, &a.map(Sym::from)),
            WrenchAxes::Body => self.turned(body, a),
        };
        let (force, moment) = (own(&wrench.force), own(&wrench.moment));
        let arm = self.point(body, &wrench.point);
        let own = Wrench {
            moment: cross(&arm, &force) + moment,
            force,
        };
        wrenches[body] = wrenches[body].plus(&own);
    }

    /// `½ k (l − l₀)²`.
    pub(super) fn point_spring_energy(&self, spring: &BodySpring) -> Sym {
        let [from, to] = self.ends(spring);
        let between = to.place - from.place;
        let square = dot(&between, &between);
        let half = Sym::from(0.5 * spring.stiffness);
        if spring.length == 0.0 {
            return half * square;
        }
        let stretch = call(Function::Sqrt, square) - Sym::from(spring.length);
        half * stretch * stretch
    }

    /// Both ends of a spring, seen from the last body that carries both.
    fn ends(&self, spring: &BodySpring) -> [Seen; 2] {
        let common = self.common(spring.bodies);
        [0, 1].map(|end| match spring.bodies[end] {
            Some(body) => self.seen(common, body, self.point(body, &spring.points[end])),
            None => Seen {
                place: spring.points[end].map(Sym::from),
                velocity: Vec3::zeros(),
            },
        })
    }

    /// A point given in the body frame, in the frame of its equations.
    pub(super) fn point(&self, body: usize, point: &Vector3<f64>) -> Vec3 {
        let pose = &self.links[body].body;
        match is_marked() {
            false => clean(pose.transform_point(point)).map(Sym::from),
            true => self.turned(body, point) + pose.translation.map(Sym::from),
        }
    }

    /// A vector given in the axes of the body, in those of its equations. Numbers that stand for others are not computed with.
    fn turned(&self, body: usize, vector: &Vector3<f64>) -> Vec3 {
        let rotation = &self.links[body].body.rotation;
        match is_marked() {
            false => clean(rotation * vector).map(Sym::from),
            true => apply(&rotation.map(Sym::from), &vector.map(Sym::from)),
        }
    }

    /// A point that is fixed in a body, seen from one that carries it, or from the world.
    fn seen(&self, from: Option<usize>, body: usize, place: Vec3) -> Seen {
        let mut seen = Seen {
            place,
            velocity: Vec3::zeros(),
        };
        for index in self.path(from, body) {
            section(number(index), "spring");
            let own = &self.bodies[index];
            let turning = cross(&own.velocity.angular, &seen.place);
            seen.velocity += own.velocity.linear + turning;
            for step in own.steps.iter().rev() {
                match step {
                    Step::Shift(by) => seen.place += by,
                    turn => {
                        seen.place = turn.to_parent(&seen.place);
                        seen.velocity = turn.to_parent(&seen.velocity);
                    }
                }
            }
        }
        seen
    }

    /// A vector from the axes of a body that carries another, or of the world, to those of that.
    fn carried_down(&self, from: Option<usize>, body: usize, a: &Vec3) -> Vec3 {
        let mut path = self.path(from, body);
        path.reverse();
        path.into_iter().fold(*a, |a, index| {
            section(number(index), "spring");
            super::to_child(&self.bodies[index].steps, &a)
        })
    }

    /// The bodies from one to the last before `from`, which carries it.
    pub(super) fn path(&self, from: Option<usize>, body: usize) -> Vec<usize> {
        let parent = |&index: &usize| self.bodies[index].parent;
        let up = std::iter::successors(Some(body), parent);
        up.take_while(|&index| Some(index) != from).collect()
    }

    /// The last body that carries both, if the world alone does not.
    fn common(&self, [a, b]: [Option<usize>; 2]) -> Option<usize> {
        let first = self.path(None, a?);
        let second = self.path(None, b?);
        first.into_iter().find(|body| second.contains(body))
    }
}

/// The force on the first end: `(k (l − l₀) + c l̇) u` with u = x / l from it to the second, which is `(k − k l₀ / l + c xᵀẋ / l²) x`.
fn pull(spring: &BodySpring, between: &Vec3, rate: &Vec3) -> Vec3 {
    let (stiffness, damping) = (spring.stiffness, spring.damping);
    let one = Sym::Number(1.0);
    let square = dot(between, between) + Sym::from(NO_LENGTH);
    let slack = Sym::from(stiffness) * Sym::from(spring.length);
    let mut factor = Sym::from(stiffness);
    let mut inverse_square = one / square;
    if !slack.is_zero() {
        let inverse = (one / call(Function::Sqrt, square)).named("inverse_length");
        factor -= slack * inverse;
        inverse_square = inverse * inverse;
    }
    if damping != 0.0 {
        factor += Sym::from(damping) * dot(between, rate) * inverse_square;
    }
    between * factor
}
