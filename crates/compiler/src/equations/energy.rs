//! Energies, momenta, and the port-Hamiltonian right-hand side.

use super::coupling::Coupling;
use super::{Tree, carried, number, to_child, wrench_to_parent};
use crate::graph::{Argument, Sym, section};
use crate::spatial::{Step, Twist, Vec3, Wrench, cross, dot};
use num_traits::Zero;

impl Tree<'_> {
    /// Kinetic and potential energy.
    pub fn energies(&self) -> Vec<Sym> {
        vec![self.kinetic_energy(), self.potential_energy()]
    }

    /// `½ Σ Vᵀ G V`, with that of rotors.
    fn kinetic_energy(&self) -> Sym {
        let (twists, momenta) = self.motions();
        let mut twice = Sym::zero();
        for (index, body) in self.bodies.iter().enumerate() {
            section(number(index), "kinetic energy");
            twice += twists[index].dot(&momenta[index]);
            for (j, &one) in body.speeds.iter().enumerate() {
                for (k, &other) in body.speeds.iter().enumerate() {
                    twice += self.armature(index, j, k) * one * other;
                }
            }
        }
        twice * Sym::from(0.5)
    }

    /// Of gravity, zero at the world's origin, and of all springs.
    fn potential_energy(&self) -> Sym {
        self.spring_energy() - dot(&self.model.gravity.map(Sym::from), &self.first_moment())
    }

    /// The mass of all bodies times the place of their centre in the world.
    fn first_moment(&self) -> Vec3 {
        let links = self.links.iter();
        let mut moments: Vec<(f64, Vec3)> = links
            .map(|link| (link.inertia.mass, link.inertia.first.map(Sym::from)))
            .collect();
        let mut whole = Vec3::zeros();
        for (index, body) in self.bodies.iter().enumerate().rev() {
            section(number(index), "first moment");
            let (mass, mut moment) = moments[index];
            for step in body.steps.iter().rev() {
                match step {
                    Step::Shift(by) => moment += by * Sym::from(mass),
                    turn => moment = turn.to_parent(&moment),
                }
            }
            match body.parent {
                Some(parent) => {
                    moments[parent].0 += mass;
                    moments[parent].1 += moment;
                }
                None => whole += moment + self.links[index].dropped.map(Sym::from),
            }
        }
        whole
    }

    /// Twist and momentum of each body, in its frame.
    pub(super) fn motions(&self) -> (Vec<Twist>, Vec<Wrench>) {
        let mut twists: Vec<Twist> = vec![];
        let mut momenta = vec![];
        for (index, body) in self.bodies.iter().enumerate() {
            section(number(index), "momentum");
            let base = body
                .parent
                .map(|parent| carried(&body.steps, &twists[parent]));
            let twist = base.map_or(body.velocity.clone(), |base| base.plus(&body.velocity));
            momenta.push(self.links[index].inertia.on_graph().of(&twist));
            twists.push(twist);
        }
        (twists, momenta)
    }

    /// p̄ = M̄ v̄; entries of driven joints are their speeds.
    pub fn momenta(&self) -> Vec<Sym> {
        let mut momenta = self.tree_momenta();
        if let Some(coupling) = self.coupling() {
            momenta = self.coupled_momenta(&coupling, &momenta);
        }
        for (index, body) in self.joints() {
            if self.model.bodies[index].driven {
                momenta[body.share.speeds.clone()].copy_from_slice(&body.speeds);
            }
        }
        momenta
    }

    /// `M v̄` of the tree.
    fn tree_momenta(&self) -> Vec<Sym> {
        let (_, mut composites) = self.motions();
        let mut momenta = vec![Sym::zero(); self.model.sizes()[2]];
        for (index, body) in self.bodies.iter().enumerate().rev() {
            section(number(index), "momentum");
            for (j, place) in body.share.speeds.clone().enumerate() {
                let rotors = body.speeds.iter().enumerate();
                let rotors = rotors.map(|(k, &speed)| self.armature(index, j, k) * speed);
                momenta[place] += body.columns[j].dot(&composites[index]) + rotors.sum::<Sym>();
            }
            if let Some(parent) = body.parent {
                let carried = wrench_to_parent(&body.steps, &composites[index]);
                composites[parent] = composites[parent].plus(&carried);
            }
        }
        momenta
    }

    /// v̄ and p̄̇ from p̄, by a way to solve M̄ v̄ = p̄.
    pub fn port_hamiltonian(&self, solve: fn(&Self) -> Vec<Sym>) -> Vec<Sym> {
        let mut speeds = solve(self);
        let moving = Tree::at(self.model, self.links.clone(), &speeds);
        speeds.extend(moving.momentum_rates());
        speeds
    }

    /// H = ½ p̄ᵀ v̄ + V from p̄, by a way to solve M̄ v̄ = p̄; energies, where joints are driven and p̄ is not all momenta.
    pub fn hamiltonian(&self, solve: fn(&Self) -> Vec<Sym>) -> Sym {
        let speeds = solve(self);
        if self.model.bodies.iter().any(|body| body.driven) {
            let moving = Tree::at(self.model, self.links.clone(), &speeds);
            return moving.energies().into_iter().sum();
        }
        let dependent = &self.model.coupling.dependent;
        let speeds = speeds.into_iter().enumerate();
        let speeds = speeds.filter(|(place, _)| !dependent.contains(place));
        let twice: Sym = speeds
            .map(|(i, speed)| Sym::input(Argument::Momenta, i) * speed)
            .sum();
        twice * Sym::from(0.5) + self.potential_energy()
    }

    /// p̄̇; entries of driven joints are their accelerations.
    fn momentum_rates(&self) -> Vec<Sym> {
        let coupling = self.coupling();
        let mut rates = self.tree_rates(coupling.as_ref());
        if let Some(coupling) = &coupling {
            rates = self.coupled_momenta(coupling, &rates);
        }
        for (index, body) in self.joints() {
            if let Some(given) = self.prescribed(index, Argument::Efforts) {
                rates[body.share.speeds.clone()].copy_from_slice(&given);
            }
        }
        rates
    }

    /// p̄̇ᵢ = τ̄ᵢ + X̄ᵢᵀ (fᵢ + ad_{Vᵢ}ᵀ hᵢ) + Ẋ̄ᵢᵀ hᵢ, with h and f the momenta of, and the wrenches on, all that a joint carries.
    fn tree_rates(&self, coupling: Option<&Coupling>) -> Vec<Sym> {
        let (twists, mut momenta) = self.motions();
        let mut wrenches = self.loads();
        if let Some(coupling) = coupling {
            for (body, weighted) in self.coupling_wrenches(coupling, &self.tree_momenta()) {
                wrenches[body] = wrenches[body].plus(&twists[body].bracket_dual(&weighted));
                momenta[body] = momenta[body].plus(&weighted.times(Sym::Number(-1.0)));
            }
        }
        let mut rates = vec![Sym::zero(); self.model.sizes()[2]];
        for (index, body) in self.bodies.iter().enumerate().rev() {
            let efforts = self.efforts(index, Some(Argument::Efforts));
            section(number(index), "momentum rate");
            let turned = wrenches[index].plus(&twists[index].bracket_dual(&momenta[index]));
            let moved = self.bias_momentum(index, &momenta[index]);
            let rotors = self.port_rotor_rates(index);
            for (j, place) in body.share.speeds.clone().enumerate() {
                rates[place] += efforts[j] + body.columns[j].dot(&turned) + moved[j] + rotors[j];
            }
            if let Some(parent) = body.parent {
                let [momentum, wrench] = [&momenta[index], &wrenches[index]]
                    .map(|wrench| wrench_to_parent(&body.steps, wrench));
                momenta[parent] = momenta[parent].plus(&momentum);
                wrenches[parent] = wrenches[parent].plus(&wrench);
            }
        }
        rates
    }

    /// Weight of, and what else acts on, each body.
    fn loads(&self) -> Vec<Wrench> {
        let mut down: Vec<Vec3> = vec![];
        let mut loads = self.external();
        for (index, body) in self.bodies.iter().enumerate() {
            section(number(index), "weight");
            let ground = self.model.gravity.map(Sym::from);
            let gravity = to_child(
                &body.steps,
                body.parent.map_or(&ground, |parent| &down[parent]),
            );
            let inertia = self.links[index].inertia.on_graph();
            loads[index] = loads[index].plus(&Wrench {
                moment: cross(&inertia.first, &gravity),
                force: gravity * inertia.mass,
            });
            down.push(gravity);
        }
        loads
    }
}
