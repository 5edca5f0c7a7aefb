//! Elements and rotors in dual numbers: their forces as their definitions have them, and the same for the library.

use super::DualForm;
use super::kernels::constants;
use crate::random::numbers;
use chacha20::ChaCha8Rng;
use hamel::elements::{
    BodySpring, BodyWrench, Element, JointDamper, JointEffort, JointSpring, PortEffort, PortSpring,
    RotationSpring, WrenchAxes,
};
use hamel::mechanism::{Body, Mechanism};
use hamel::nalgebra::{Matrix3, Vector3, Vector6};
use hamel::scalar::Scalar;
use hamel::spatial::{Pose, join, so3, split, vee};
use rand::{RngExt, SeedableRng};
use std::ops::Range;
use std::sync::Arc;

/// What a mechanism carries besides its bodies; nothing by default.
#[derive(Clone, Debug, Default)]
pub struct Actuation {
    springs: Vec<JointSpring>,
    turns: Vec<RotationSpring>,
    dampers: Vec<JointDamper>,
    motors: Vec<JointEffort>,
    port_motors: Vec<PortEffort>,
    port_springs: Vec<PortSpring>,
    ropes: Vec<BodySpring>,
    wrenches: Vec<BodyWrench>,
    /// One entry a speed.
    armature: Vec<f64>,
    /// Rotors at ports.
    port_rotors: Vec<Rotor>,
}

/// A rotor at a port.
#[derive(Clone, Debug)]
struct Rotor {
    body: usize,
    port: usize,
    inertia: f64,
}

fn vector(random: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.random_range(-1.0..1.0))
}

fn product<D: Scalar>(a: &[D], b: &[D]) -> D {
    let terms = a.iter().zip(b);
    terms.fold(D::from_f64(0.0), |sum, (a, b)| sum + *a * *b)
}

/// `H Hᵀ` of a random H, by rows.
fn stiffness(random: &mut ChaCha8Rng, size: usize) -> Vec<f64> {
    let half = numbers(random, size * size);
    let row = |i: usize| &half[i * size..(i + 1) * size];
    let product = |i, j| row(i).iter().zip(row(j)).map(|(x, y)| x * y).sum();
    (0..size * size)
        .map(|n| product(n / size, n % size))
        .collect()
}

/// A place about `near` of the joint's own, nearer where ϕ would not be found back from there: half as far as it is found from, because
/// motions go on from Q.
fn rest(owner: &Body, q: &[f64], mut near: Vec<f64>) -> Vec<f64> {
    let (joint, q) = (owner.joint(), owner.configuration(q));
    let (mut rest, mut back) = (vec![0.0; q.len()], near.clone());
    loop {
        joint.retract(q, &near, &mut rest);
        let is_found = joint.local(&rest, q, &mut back).is_ok();
        near.iter_mut().for_each(|entry| *entry *= 0.5);
        if is_found {
            joint.retract(q, &near, &mut rest);
            // Newton's method may find a place and none half way to it.
            if rest.iter().all(|entry| entry.is_finite()) {
                return rest;
            }
        }
    }
}

impl Actuation {
    /// Everything at every body, of order 1.
    pub fn random(mechanism: &Mechanism, q: &[f64], seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut all = Self::default();
        let bodies = mechanism.bodies();
        for (body, owner) in bodies.iter().enumerate() {
            let ranges = owner.ranges();
            let size = ranges.freedoms.len();
            let near = numbers(&mut random, size);
            let rest = rest(owner, q, near);
            let name = |kind: &str| format!("{kind} {body}");
            all.springs.push(JointSpring {
                name: name("spring"),
                body,
                stiffness: stiffness(&mut random, size),
                rest,
            });
            all.turns.push(RotationSpring {
                name: name("rotation spring"),
                body,
                stiffness: 1.7,
                rest: so3::exp(&vector(&mut random)),
            });
            all.dampers.push(JointDamper {
                name: name("damper"),
                body,
                coefficients: numbers(&mut random, size).iter().map(|c| c.abs()).collect(),
            });
            all.motors.push(JointEffort {
                name: name("motor"),
                body,
                efforts: numbers(&mut random, size),
            });
            let anywhere = random.random_range(0..=bodies.len());
            all.ropes.push(BodySpring {
                name: name("rope"),
                bodies: [(anywhere < bodies.len()).then_some(anywhere), Some(body)],
                points: [vector(&mut random), vector(&mut random) * 2.0],
                stiffness: 3.0,
                damping: 0.6,
                length: 0.4,
            });
            for axes in [WrenchAxes::World, WrenchAxes::Body] {
                all.wrenches.push(BodyWrench {
                    name: name("push"),
                    body,
                    point: vector(&mut random),
                    force: vector(&mut random),
                    moment: vector(&mut random),
                    axes,
                });
            }
            if !owner.leads() {
                continue;
            }
            for (port, named) in owner.joint().ports().iter().enumerate() {
                let value = owner.joint().port_value(owner.configuration(q), port);
                all.port_motors.push(PortEffort {
                    name: name(named.name),
                    body,
                    port,
                    effort: random.random_range(-1.0..1.0).into(),
                });
                all.port_springs.push(PortSpring {
                    name: name(named.name),
                    body,
                    port,
                    stiffness: random.random_range(0.0..2.0),
                    damping: random.random_range(0.0..1.0),
                    rest: value + random.random_range(-1.0..1.0),
                });
                all.port_rotors.push(Rotor {
                    body,
                    port,
                    inertia: 0.3 + 0.2 * port as f64,
                });
            }
            let holonomic = owner.joint().structures().speed_basis.is_identity();
            let inertia = numbers(&mut random, ranges.speeds.len());
            let inertia = inertia.iter().map(|a| f64::from(holonomic) * a.abs());
            all.armature.extend(inertia);
        }
        all
    }

    /// The mechanism with it.
    ///
    /// # Panics
    /// Where the mechanism is another.
    pub fn equip(&self, mechanism: &Mechanism) -> Arc<Mechanism> {
        fn shared<E: Element + Clone + 'static>(all: &[E]) -> Vec<Arc<dyn Element>> {
            let shared = |element: &E| -> Arc<dyn Element> { Arc::new(element.clone()) };
            all.iter().map(shared).collect()
        }
        let elements = [
            shared(&self.springs),
            shared(&self.turns),
            shared(&self.dampers),
            shared(&self.motors),
            shared(&self.port_motors),
            shared(&self.port_springs),
            shared(&self.ropes),
            shared(&self.wrenches),
        ];
        let equipped = mechanism.clone().with_elements(elements.concat());
        let mut equipped = equipped.expect("it fits");
        for (body, owner) in mechanism.joints() {
            let holonomic = owner.joint().structures().speed_basis.is_identity();
            let own = self.armature.get(owner.ranges().speeds.clone());
            if let Some(own) = own.filter(|_| holonomic) {
                equipped = equipped.with_armature(body, own).expect("it fits");
            }
            let rotors = self.port_rotors.iter().filter(|rotor| rotor.body == body);
            let inertias: Vec<f64> = rotors.map(|rotor| rotor.inertia).collect();
            if !inertias.is_empty() {
                let geared = equipped.with_port_armature(body, &inertias);
                equipped = geared.expect("it fits");
            }
        }
        Arc::new(equipped)
    }

    /// p̄ and p̄̇ of each rotor at a port, with its inertia and the speeds of its joint.
    fn at_ports<'a, D: Scalar>(
        &'a self,
        form: &'a DualForm<D>,
        q: &'a [D],
        speeds: &'a [D],
    ) -> impl Iterator<Item = ([Vec<D>; 2], D, Range<usize>)> + 'a {
        self.port_rotors.iter().map(move |rotor| {
            let body = &form.bodies[rotor.body];
            let own = &speeds[body.speeds.clone()];
            let q = &q[body.configuration.clone()];
            let motion = body.joint.port_motion(q, own, rotor.port);
            (motion, D::from_f64(rotor.inertia), body.speeds.clone())
        })
    }

    /// Kinetic energy of rotors at ports.
    pub fn rotor_energy<D: Scalar>(&self, form: &DualForm<D>, q: &[D], speeds: &[D]) -> D {
        let half = D::from_f64(0.5);
        let each = self.at_ports(form, q, speeds);
        each.fold(D::from_f64(0.0), |sum, ([row, _], inertia, own)| {
            let rate = product(&row, &speeds[own]);
            sum + half * inertia * rate * rate
        })
    }

    /// How the momenta of rotors at ports change while v̄ stays, onto rates of momenta.
    pub fn add_rotor_rates<D: Scalar>(
        &self,
        form: &DualForm<D>,
        (q, speeds): (&[D], &[D]),
        rates: &mut [D],
    ) {
        for ([row, rate], inertia, own) in self.at_ports(form, q, speeds) {
            let v = &speeds[own.clone()];
            let (speed, turned) = (product(&row, v), product(&rate, v));
            for ((sum, row), rate) in rates[own].iter_mut().zip(row).zip(rate) {
                *sum += inertia * (rate * speed + row * turned);
            }
        }
    }

    /// Adds `a v̄̇`, and of rotors at ports `a p̄ᵀ p̄ v̄̇`, to inverse dynamics.
    pub fn add_rotors<D: Scalar>(
        &self,
        form: &DualForm<D>,
        q: &[D],
        accelerations: &[D],
        efforts: &mut [D],
    ) {
        for ([row, _], inertia, own) in self.at_ports(form, q, accelerations) {
            let along = product(&row, &accelerations[own.clone()]);
            for (effort, entry) in efforts[own].iter_mut().zip(row) {
                *effort += inertia * entry * along;
            }
        }
        let terms: Vec<D> = constants(&self.armature);
        let terms = terms.iter().zip(accelerations).map(|(a, x)| *a * *x);
        for (effort, term) in efforts.iter_mut().zip(terms) {
            *effort += term;
        }
    }

    /// Generalised forces, one per speed.
    pub fn forces<D: Scalar>(&self, form: &DualForm<D>, q: &[D], speeds: &[D]) -> Vec<D> {
        let mut forces = form.reduced(q, &self.efforts(form, q, speeds));
        for ([row, rate], inertia, own) in self.at_ports(form, q, speeds) {
            let turned = product(&rate, &speeds[own.clone()]);
            for (force, entry) in forces[own].iter_mut().zip(row) {
                *force -= inertia * entry * turned;
            }
        }
        let poses = form.poses(q);
        let wrenches = form.gathered(&poses, self.on_bodies(form, &poses, q, speeds));
        for (body, wrench) in form.bodies.iter().zip(&wrenches) {
            let columns = body.joint.columns(&q[body.configuration.clone()]);
            let own = forces[body.speeds.clone()].iter_mut();
            for (force, column) in own.zip(&columns) {
                *force += column.dot(wrench);
            }
            if let Some(inertia) = self.armature.get(body.speeds.clone())
                && body.leads
                && body.speeds.len() == body.freedoms.len()
            {
                let (q, v) = (&q[body.configuration.clone()], &speeds[body.speeds.clone()]);
                let own = forces[body.speeds.clone()].iter_mut();
                for (force, term) in own.zip(body.joint.rotors(q, v, inertia)) {
                    *force -= term;
                }
            }
        }
        forces
    }

    /// τ of all joints.
    fn efforts<D: Scalar>(&self, form: &DualForm<D>, q: &[D], speeds: &[D]) -> Vec<D> {
        let size = form.joints().map(|body| body.freedoms.len()).sum();
        let mut efforts = vec![D::from_f64(0.0); size];
        let mut add = |body: usize, own: Vec<D>| {
            let sum = efforts[form.bodies[body].freedoms.clone()].iter_mut();
            sum.zip(own).for_each(|(sum, own)| *sum += own);
        };
        let at = |body: usize| &q[form.bodies[body].configuration.clone()];
        for spring in &self.springs {
            let joint = &form.bodies[spring.body].joint;
            add(
                spring.body,
                joint.spring(at(spring.body), &spring.rest, &spring.stiffness),
            );
        }
        for spring in &self.turns {
            let joint = &form.bodies[spring.body].joint;
            let back: Matrix3<D> = spring.rest.transpose().map(D::from_f64);
            let turn = vee(&(joint.pose(at(spring.body)).rotation * back));
            let moment = turn * D::from_f64(-spring.stiffness);
            add(spring.body, joint.moment(at(spring.body), &moment));
        }
        for damper in &self.dampers {
            let body = &form.bodies[damper.body];
            let v = body
                .joint
                .velocity(at(damper.body), &speeds[body.speeds.clone()]);
            let damped = v.iter().zip(constants::<D>(&damper.coefficients));
            add(damper.body, damped.map(|(v, c)| -(c * *v)).collect());
        }
        for motor in &self.motors {
            add(motor.body, constants(&motor.efforts));
        }
        for motor in &self.port_motors {
            let joint = &form.bodies[motor.body].joint;
            let (_, row) = joint.port(at(motor.body), motor.port, 0.0);
            let effort = D::from_f64(motor.effort.constant().unwrap_or(f64::NAN));
            add(motor.body, row.iter().map(|p| *p * effort).collect());
        }
        for spring in &self.port_springs {
            let body = &form.bodies[spring.body];
            let (way, row) = body.joint.port(at(spring.body), spring.port, spring.rest);
            let v = body
                .joint
                .velocity(at(spring.body), &speeds[body.speeds.clone()]);
            let rates = row.iter().zip(&v);
            let rate = rates.fold(D::from_f64(0.0), |sum, (p, v)| sum + *p * *v);
            let [stiffness, damping] = [spring.stiffness, spring.damping].map(D::from_f64);
            let effort = -(stiffness * way) - damping * rate;
            add(spring.body, row.iter().map(|p| *p * effort).collect());
        }
        efforts
    }

    /// Wrenches on the bodies, in their joints' child frames.
    fn on_bodies<D: Scalar>(
        &self,
        form: &DualForm<D>,
        poses: &[Pose<D>],
        q: &[D],
        speeds: &[D],
    ) -> Vec<Vector6<D>> {
        let twists = form.twists(poses, q, speeds);
        let mut placed: Vec<Pose<D>> = vec![];
        for (body, pose) in form.bodies.iter().zip(poses) {
            let pose = body.parent.map_or(*pose, |parent| placed[parent] * *pose);
            placed.push(pose);
        }
        let lift = |v: &Vector3<f64>| v.map(D::from_f64);
        let mut wrenches = vec![Vector6::zeros(); placed.len()];
        // A force in child axes at a point of the body frame.
        let mut push = |body: usize, point: &Vector3<D>, force: &Vector3<D>, moment: Vector3<D>| {
            let arm = form.bodies[body].fixed.transform_point(point);
            wrenches[body] += join(&(arm.cross(force) + moment), force);
        };
        for rope in &self.ropes {
            let end = |end: usize| {
                let point = lift(&rope.points[end]);
                let Some(body) = rope.bodies[end] else {
                    return (point, Vector3::zeros());
                };
                let arm = form.bodies[body].fixed.transform_point(&point);
                let (turn, slide) = split(&twists[body]);
                let velocity = placed[body].rotation * (slide + turn.cross(&arm));
                (placed[body].transform_point(&arm), velocity)
            };
            let ((from, slow), (to, fast)) = (end(0), end(1));
            let (way, rate) = (to - from, fast - slow);
            let length = Scalar::sqrt(way.dot(&way));
            let u = way / length;
            let pull = (length - D::from_f64(rope.length)) * D::from_f64(rope.stiffness)
                + u.dot(&rate) * D::from_f64(rope.damping);
            for (n, sign) in [(0, 1.0), (1, -1.0)] {
                if let Some(body) = rope.bodies[n] {
                    let force = placed[body].rotation.transpose() * u * (pull * D::from_f64(sign));
                    push(body, &lift(&rope.points[n]), &force, Vector3::zeros());
                }
            }
        }
        for wrench in &self.wrenches {
            let body = wrench.body;
            let turn = match wrench.axes {
                WrenchAxes::World => placed[body].rotation.transpose(),
                WrenchAxes::Body => form.bodies[body].fixed.rotation,
            };
            let (force, moment) = (turn * lift(&wrench.force), turn * lift(&wrench.moment));
            push(body, &lift(&wrench.point), &force, moment);
        }
        wrenches
    }
}
