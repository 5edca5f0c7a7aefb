//! Forward dynamics by articulated bodies: each joint's degrees of freedom are eliminated from the inertia of what it carries.

use super::elimination::{Carried, Pivot};
use super::newton_euler::Spin;
use super::{Tree, carried, number, wrench_to_parent};
use crate::graph::{Argument, Sym, section};
use crate::spatial::{Articulated, Twist, Vec3, Wrench};
use num_traits::Zero;

/// Where the velocity-dependent forces are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bias {
    /// In the same recursion.
    Within,
    /// In a recursion of inverse dynamics before it.
    Before,
}

/// What the recursion starts from.
struct Start<'a> {
    /// What each body's velocity and what acts on it take, in its frame.
    wrenches: Vec<Wrench>,
    /// The part of each body's acceleration that neither its parent's nor v̄̇ makes.
    biases: Vec<Twist>,
    /// Acceleration of the world that stands for gravity.
    world: Twist,
    /// The efforts at a body's joint, one per speed.
    efforts: &'a dyn Fn(usize) -> Vec<Sym>,
    /// The argument that holds the rates of driven joints.
    given: Argument,
    /// What is solved for.
    sought: &'static str,
}

impl Tree<'_> {
    /// v̄̇ from the efforts of the argument and of the scene.
    pub fn articulated_accelerations(&self, bias: Bias) -> Vec<Sym> {
        let before = match bias {
            Bias::Before => self.inverse_dynamics(None),
            Bias::Within => vec![Sym::zero(); self.model.sizes()[2]],
        };
        let efforts = |index: usize| {
            let taken = &before[self.bodies[index].share.speeds.clone()];
            let efforts = self.efforts(index, Some(Argument::Efforts)).into_iter();
            efforts
                .zip(taken)
                .map(|(tau, &taken)| tau - taken)
                .collect()
        };
        self.articulated(match bias {
            Bias::Before => self.still(&efforts),
            Bias::Within => self.moving(&efforts),
        })
    }

    /// v̄ with M̄ v̄ = p̄, the argument.
    pub fn articulated_speeds(&self) -> Vec<Sym> {
        let momenta = |index: usize| {
            let places = self.bodies[index].share.speeds.clone();
            places.map(|i| Sym::input(Argument::Momenta, i)).collect()
        };
        self.articulated(Start {
            given: Argument::Momenta,
            sought: "speed",
            ..self.still(&momenta)
        })
    }

    /// Nothing but efforts acts, and nothing moves.
    fn still<'a>(&self, efforts: &'a dyn Fn(usize) -> Vec<Sym>) -> Start<'a> {
        let count = self.bodies.len();
        Start {
            wrenches: vec![Wrench::zero(); count],
            biases: vec![Twist::zero(); count],
            world: Twist::zero(),
            efforts,
            given: Argument::Efforts,
            sought: "acceleration",
        }
    }

    /// The bodies as they move, with all that acts on them.
    fn moving<'a>(&self, efforts: &'a dyn Fn(usize) -> Vec<Sym>) -> Start<'a> {
        let velocities = self.angular_velocities();
        let external = self.external();
        let mut wrenches: Vec<Wrench> = vec![];
        let mut biases: Vec<Twist> = vec![];
        for (index, external) in external.iter().enumerate() {
            section(number(index), "bias");
            let rigid = self.links[index].inertia.on_graph();
            let spin = Spin::new(&velocities[index].0, &Vec3::zeros());
            let needed = spin.wrench(&rigid, &Vec3::zeros());
            wrenches.push(needed.plus(&external.times(Sym::Number(-1.0))));
            let own = self.bias(index, &velocities);
            biases.push(match self.bodies[index].parent {
                None => own,
                Some(parent) => own.plus(&self.centripetal(index, &velocities[parent].0)),
            });
        }
        Start {
            wrenches,
            biases,
            world: Twist {
                angular: Vec3::zeros(),
                linear: self.ground(),
            },
            efforts,
            given: Argument::Efforts,
            sought: "acceleration",
        }
    }

    fn articulated(&self, mut start: Start<'_>) -> Vec<Sym> {
        let given: Vec<Option<Vec<Sym>>> = (0..self.bodies.len())
            .map(|index| self.prescribed(index, start.given))
            .collect();
        let mut pivots: Vec<Vec<Pivot>> = self.bodies.iter().map(|_| vec![]).collect();
        let mut seen: Vec<Vec<(Articulated, Wrench)>> =
            self.bodies.iter().map(|_| vec![]).collect();
        // Of a joint that carries several bodies, those that have come.
        let mut together: Option<Carried> = None;
        for (index, body) in self.bodies.iter().enumerate().rev() {
            section(number(index), "carried");
            let rigid = self.links[index].inertia.on_graph();
            let mut inertia = Articulated::rigid(&rigid);
            let mut wrench = start.wrenches[index].clone();
            let is_leaf = seen[index].is_empty();
            for (other, more) in std::mem::take(&mut seen[index]) {
                inertia = inertia.plus(&other);
                wrench = wrench.plus(&more);
            }
            section(number(index), "effort");
            if let Some(given) = &given[index] {
                start.biases[index] = start.biases[index].plus(&self.along(index, given));
            } else if self.carries_several(index) {
                let own = self.loaded(index, &inertia, wrench, &start.biases[index]);
                let mut own = Carried::new(&body.columns, inertia, own).at_parent(&body.steps);
                if is_leaf {
                    // A rigid body takes fewer operations.
                    own.inertia = Articulated::rigid(&rigid.to_parent(&body.steps));
                }
                let mut carried = match together.take() {
                    Some(others) => others.plus(&own),
                    None => own,
                };
                if !self.model.bodies[index].leads() {
                    together = Some(carried);
                    continue;
                }
                pivots[index] = self.eliminate(index, &mut carried, &(start.efforts)(index));
                if let Some(parent) = body.parent {
                    seen[parent].push((carried.inertia.settled(), carried.wrench.settled()));
                }
                continue;
            } else {
                let efforts = (start.efforts)(index);
                section(number(index), "articulated inertia");
                let mut carried = Carried::new(&body.columns, inertia, wrench);
                pivots[index] = self.eliminate(index, &mut carried, &efforts);
                Carried {
                    inertia,
                    wrench,
                    ..
                } = carried;
            }
            if let Some(parent) = body.parent {
                let wrench = self.loaded(index, &inertia, wrench, &start.biases[index]);
                seen[parent].push((
                    inertia.to_parent(&body.steps).settled(),
                    wrench_to_parent(&body.steps, &wrench).settled(),
                ));
            }
        }
        self.outward(&start, &pivots, &given)
    }

    /// The wrench that a body with this inertia takes at v̄̇ = 0 under a parent that stands still: `p + A c`.
    fn loaded(&self, index: usize, inertia: &Articulated, wrench: Wrench, bias: &Twist) -> Wrench {
        section(number(index), "seen by parent");
        wrench.plus(&inertia.of(bias))
    }

    fn outward(
        &self,
        start: &Start<'_>,
        pivots: &[Vec<Pivot>],
        given: &[Option<Vec<Sym>>],
    ) -> Vec<Sym> {
        let mut rates = vec![Sym::zero(); self.model.sizes()[2]];
        let mut accelerations: Vec<Twist> = vec![];
        for (index, body) in self.bodies.iter().enumerate() {
            section(number(index), start.sought);
            let from = body
                .parent
                .map_or(&start.world, |parent| &accelerations[parent]);
            let base = carried(&body.steps, from).plus(&start.biases[index]);
            let places = body.share.speeds.clone();
            let into = (start.sought, &mut rates[..]);
            accelerations.push(if let Some(given) = &given[index] {
                rates[places].copy_from_slice(given);
                base
            } else if self.carries_several(index) {
                if self.model.bodies[index].leads() {
                    // The eliminated inertia is at the parent's frame.
                    self.resolve(index, &pivots[index], from, into);
                }
                base.plus(&self.along(index, &rates[places])).settled()
            } else {
                self.resolve(index, &pivots[index], &base, into).settled()
            });
        }
        rates
    }
}
