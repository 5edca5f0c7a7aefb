//! Forward dynamics by articulated bodies: each joint's degrees of freedom are eliminated from the inertia of what it carries.

use super::newton_euler::Spin;
use super::{Tree, carried, number, wrench_to_parent};
use crate::graph::{Argument, Sym, section};
use crate::spatial::{Articulated, Twist, Vec3, Wrench};
use num_traits::Zero;

/// The elimination of one speed.
struct Pivot {
    /// `y / d`, of the momentum y of one unit of it.
    scaled: Wrench,
    /// `u / d`, of the effort u that is left for it.
    share: Sym,
    /// What the rates of the joint's later speeds take from it, over d.
    later: Vec<Sym>,
}

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
        let links = self.links.iter();
        let mut inertias: Vec<Articulated> = links
            .map(|link| Articulated::rigid(&link.inertia.on_graph()))
            .collect();
        let mut wrenches = start.wrenches.clone();
        let mut pivots: Vec<Vec<Pivot>> = self.bodies.iter().map(|_| vec![]).collect();
        let mut seen: Vec<Vec<(Articulated, Wrench)>> =
            self.bodies.iter().map(|_| vec![]).collect();
        for index in (0..self.bodies.len()).rev() {
            section(number(index), "carried");
            for (inertia, wrench) in std::mem::take(&mut seen[index]) {
                inertias[index] = inertias[index].plus(&inertia);
                wrenches[index] = wrenches[index].plus(&wrench);
            }
            section(number(index), "effort");
            if let Some(given) = &given[index] {
                start.biases[index] = start.biases[index].plus(&self.along(index, given));
            } else {
                let efforts = (start.efforts)(index);
                pivots[index] =
                    self.eliminate(index, &mut inertias[index], &mut wrenches[index], efforts);
            }
            if let Some(parent) = self.bodies[index].parent {
                section(number(index), "seen by parent");
                let steps = &self.bodies[index].steps;
                let wrench = wrenches[index].plus(&inertias[index].of(&start.biases[index]));
                seen[parent].push((
                    inertias[index].to_parent(steps).settled(),
                    wrench_to_parent(steps, &wrench).settled(),
                ));
            }
        }
        self.outward(&start, &pivots, &given)
    }

    /// Takes the degrees of freedom of a body's joint out of what it carries.
    fn eliminate(
        &self,
        index: usize,
        inertia: &mut Articulated,
        wrench: &mut Wrench,
        efforts: Vec<Sym>,
    ) -> Vec<Pivot> {
        section(number(index), "articulated inertia");
        let columns = &self.bodies[index].columns;
        let has_armature = self.has_armature(index);
        let mut momenta: Vec<Wrench> = columns.iter().map(|column| inertia.of(column)).collect();
        let mut matrix: Vec<Vec<Sym>> = (0..columns.len())
            .map(|j| {
                (0..columns.len())
                    .map(|k| columns[j].dot(&momenta[k]) + self.armature(index, j, k))
                    .collect()
            })
            .collect();
        let given = efforts.clone();
        let mut efforts = efforts;
        for (j, column) in columns.iter().enumerate() {
            efforts[j] -= column.dot(wrench);
        }
        let mut pivots = vec![];
        for j in 0..columns.len() {
            let inverse = self.inverse_of_inertia(index, j, matrix[j][j]);
            let inverse = inverse.named("inverse_inertia");
            let mut scaled = momenta[j].times(inverse);
            if let Some(entry) = self.feels(index, j) {
                *scaled.entry_mut(entry) = Sym::Number(1.0);
            }
            let later: Vec<Sym> = matrix[j][j + 1..]
                .iter()
                .map(|&entry| entry * inverse)
                .collect();
            for k in j + 1..columns.len() {
                let factor = later[k - j - 1];
                let less = factor * efforts[j];
                efforts[k] -= less;
                momenta[k] = momenta[k].plus(&momenta[j].times(-factor));
                if let Some(entry) = self.feels(index, j) {
                    *momenta[k].entry_mut(entry) = Sym::zero();
                }
                let row: Vec<Sym> = matrix[j][k..].iter().map(|&entry| factor * entry).collect();
                for (entry, less) in matrix[k][k..].iter_mut().zip(row) {
                    *entry -= less;
                }
            }
            let column = if has_armature {
                Twist::zero()
            } else {
                columns[j].clone()
            };
            *inertia = inertia.without(&column, &momenta[j], &scaled);
            *wrench = wrench.plus(&momenta[j].times(efforts[j] * inverse));
            pivots.push(Pivot {
                share: efforts[j] * inverse,
                scaled,
                later,
            });
        }
        // Along a degree of freedom nothing is left but the effort at it.
        for (j, given) in given.into_iter().enumerate() {
            if let Some(entry) = self.feels(index, j) {
                *wrench.entry_mut(entry) = given;
            }
        }
        pivots
    }

    /// The entry of wrenches that is the effort of a joint's speed, where there is one and nothing but what the joint carries has inertia.
    fn feels(&self, index: usize, j: usize) -> Option<usize> {
        match self.has_armature(index) {
            true => None,
            false => self.bodies[index].columns[j].unit_entry(),
        }
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
            if let Some(given) = &given[index] {
                rates[places].copy_from_slice(given);
                accelerations.push(base);
                continue;
            }
            let mut acceleration = base.clone();
            for (j, place) in places.clone().enumerate().rev() {
                let Pivot {
                    scaled,
                    share,
                    later,
                } = &pivots[index][j];
                let taken: Sym = later
                    .iter()
                    .zip(&rates[place + 1..places.end])
                    .map(|(&factor, &rate)| factor * rate)
                    .sum();
                let column = &body.columns[j];
                let Some(entry) = self.feels(index, j) else {
                    let rate = *share - base.dot(scaled) - taken;
                    rates[place] = rate.named(start.sought);
                    acceleration = acceleration.plus(&column.times(rate));
                    continue;
                };
                // Its factor of the base is 1: the rate is what the whole differs by from the base.
                let mut others = base.clone();
                let along = std::mem::replace(others.entry_mut(entry), Sym::zero());
                let whole = *share - others.dot(scaled) - taken;
                rates[place] = (whole - along).named(start.sought);
                let sum = acceleration.entry_mut(entry);
                *sum = *sum - along + whole;
            }
            accelerations.push(acceleration.settled());
        }
        rates
    }
}
