//! The equations of motion in dual numbers, joint by joint in child frames: what derivatives by recursion are held to.
//!
//! Of a joint only H, X^c, S̄, c and Ẋ̄ᵀh enter, as functions of Q; none of the kernels that hold derivatives.

mod actuation;
mod kernels;

pub use actuation::Actuation;
pub use kernels::{Kernels, Lookup, behind, library_kernels, of};

use hamel::mechanism::Mechanism;
use hamel::nalgebra::{Vector3, Vector6};
use hamel::scalar::{Dual, Scalar};
use hamel::spatial::{Pose, SpatialInertia, bracket_dual_product, bracket_product, join};
use kernels::constants;
use std::sync::Arc;

struct Body<D> {
    joint: Box<dyn Kernels<D>>,
    /// Whether it stands for its joint: it is the only body, or the first.
    leads: bool,
    parent: Option<usize>,
    frame: Pose<D>,
    /// The body frame in the joint's child frame.
    fixed: Pose<D>,
    inertia: SpatialInertia<D>,
    configuration: std::ops::Range<usize>,
    freedoms: std::ops::Range<usize>,
    speeds: std::ops::Range<usize>,
}

/// A mechanism in dual numbers.
pub struct DualForm<D = Dual<f64>> {
    bodies: Vec<Body<D>>,
    gravity: Vector3<D>,
    actuation: Actuation,
}

/// A state in dual numbers.
#[derive(Clone)]
pub struct DualState<D = Dual<f64>> {
    /// All joints' Q.
    pub q: Vec<D>,
    /// v̄.
    pub speeds: Vec<D>,
    /// τ.
    pub efforts: Vec<D>,
}

fn lifted<D: Scalar>(pose: &Pose<f64>) -> Pose<D> {
    Pose::new(
        pose.rotation.map(D::from_f64),
        pose.translation.map(D::from_f64),
    )
}

impl DualForm {
    /// A mechanism on joints of the library that carries what the description names.
    pub fn new(mechanism: &Arc<Mechanism>, actuation: Actuation) -> Self {
        Self::of(mechanism, actuation, library_kernels)
    }

    /// Q moved along one ϕ.
    pub fn moved(&self, q: &[f64], freedom: usize) -> Vec<Dual<f64>> {
        self.moved_along(q, |k| Dual::new(0.0, f64::from(u8::from(k == freedom))))
    }
}

impl<D: Scalar> DualForm<D> {
    /// A mechanism on joints whose kernels are found elsewhere.
    pub fn of(mechanism: &Arc<Mechanism>, actuation: Actuation, lookup: Lookup<D>) -> Self {
        let bodies = mechanism.bodies();
        let body = |body: &hamel::mechanism::Body| -> Body<D> {
            let above = body
                .parent()
                .map(|parent| *bodies[parent].child_placement());
            let above = above.unwrap_or_else(Pose::identity);
            let inertia = SpatialInertia::from(body.mass()).transform(body.child_placement());
            let ranges = body.ranges();
            let lift = |x: f64| D::from_f64(x);
            let i = &inertia.inertia;
            let mut lifted_inertia = SpatialInertia::<D>::zero();
            lifted_inertia.mass = lift(inertia.mass);
            lifted_inertia.first_moment = inertia.first_moment.map(lift);
            (lifted_inertia.inertia.xx, lifted_inertia.inertia.xy) = (lift(i.xx), lift(i.xy));
            (lifted_inertia.inertia.xz, lifted_inertia.inertia.yy) = (lift(i.xz), lift(i.yy));
            (lifted_inertia.inertia.yz, lifted_inertia.inertia.zz) = (lift(i.yz), lift(i.zz));
            Body {
                joint: lookup(body.joint()),
                leads: body.leads(),
                parent: body.parent(),
                frame: lifted(&(above * *body.placement())),
                fixed: lifted(body.child_placement()),
                inertia: lifted_inertia,
                configuration: ranges.configuration.clone(),
                freedoms: ranges.freedoms.clone(),
                speeds: ranges.speeds.clone(),
            }
        };
        Self {
            bodies: bodies.iter().map(body).collect(),
            gravity: mechanism.gravity().map(D::from_f64),
            actuation,
        }
    }

    /// (q, v̄, τ) without infinitesimals.
    pub fn state(&self, q: &[f64], speeds: &[f64], efforts: &[f64]) -> DualState<D> {
        DualState {
            q: constants(q),
            speeds: constants(speeds),
            efforts: constants(efforts),
        }
    }

    fn joints(&self) -> impl Iterator<Item = &Body<D>> {
        self.bodies.iter().filter(|body| body.leads)
    }

    /// Φ(Q, ϕ), ϕ of all joints.
    pub fn moved_along(&self, q: &[f64], phi: impl Fn(usize) -> D) -> Vec<D> {
        let each = self.joints().flat_map(|body| {
            let phi: Vec<D> = body.freedoms.clone().map(&phi).collect();
            body.joint.retract(&q[body.configuration.clone()], &phi)
        });
        each.collect()
    }

    /// H of each joint, its frame included, child to the parent's child frame.
    fn poses(&self, q: &[D]) -> Vec<Pose<D>> {
        let pose = |body: &Body<D>| body.frame * body.joint.pose(&q[body.configuration.clone()]);
        self.bodies.iter().map(pose).collect()
    }

    /// τ̄ of inverse dynamics; without gravity and elements if it does not fall.
    pub fn inverse(&self, q: &[D], speeds: &[D], accelerations: &[D], falls: bool) -> Vec<D> {
        let poses = self.poses(q);
        let zero = Vector3::zeros();
        let base = join(&zero, &if falls { -self.gravity } else { zero });
        let motions = self.motions(&poses, (q, speeds, accelerations), base);
        let wrench = |(body, (twist, rate)): (&Body<D>, &(_, _))| body.inertia.wrench(twist, rate);
        let own: Vec<Vector6<D>> = self.bodies.iter().zip(&motions).map(wrench).collect();
        let wrenches = self.gathered(&poses, own);
        let mut efforts = vec![D::from_f64(0.0); speeds.len()];
        for (body, wrench) in self.bodies.iter().zip(&wrenches) {
            let columns = body.joint.columns(&q[body.configuration.clone()]);
            for (effort, column) in efforts[body.speeds.clone()].iter_mut().zip(&columns) {
                *effort += column.dot(wrench);
            }
        }
        self.actuation
            .add_rotors(self, q, accelerations, &mut efforts);
        if falls {
            let acting = self.actuation.forces(self, q, speeds);
            for (effort, force) in efforts.iter_mut().zip(acting) {
                *effort -= force;
            }
        }
        efforts
    }

    /// Twists and their rates in child axes, for a world that accelerates with `base`.
    fn motions(
        &self,
        poses: &[Pose<D>],
        (q, speeds, accelerations): (&[D], &[D], &[D]),
        base: Vector6<D>,
    ) -> Vec<(Vector6<D>, Vector6<D>)> {
        let mut motions: Vec<(Vector6<D>, Vector6<D>)> = vec![];
        for (body, pose) in self.bodies.iter().zip(poses) {
            let (twist, rate) = body.parent.map_or((Vector6::zeros(), base), |p| motions[p]);
            let own = body.joint.columns(&q[body.configuration.clone()]);
            let speeds = &speeds[body.speeds.clone()];
            let relative = sum(&own, speeds);
            let twist = pose.act_twist_inverse(&twist) + relative;
            let rate = pose.act_twist_inverse(&rate)
                + sum(&own, &accelerations[body.speeds.clone()])
                + body.joint.bias(&q[body.configuration.clone()], speeds)
                + bracket_product(&twist, &relative);
            motions.push((twist, rate));
        }
        motions
    }

    /// S̄ᵀ τ.
    pub fn reduced(&self, q: &[D], efforts: &[D]) -> Vec<D> {
        let own = self.joints().flat_map(|body| {
            let efforts = &efforts[body.freedoms.clone()];
            body.joint.reduce(&q[body.configuration.clone()], efforts)
        });
        own.collect()
    }

    /// p̄̇ at v̄.
    pub fn momentum_rates(&self, state: &DualState<D>) -> Vec<D> {
        self.momentum_rates_beside(state, &[])
    }

    /// p̄̇ at v̄, where bodies are rid of momenta that are fixed in them: in the axes of the joints' child frames, at their origins.
    pub fn momentum_rates_beside(
        &self,
        state: &DualState<D>,
        rid: &[(usize, Vector6<D>)],
    ) -> Vec<D> {
        let DualState { q, speeds, efforts } = state;
        let poses = self.poses(q);
        let twists = self.twists(&poses, q, speeds);
        let rotations = self.rotations(&poses);
        let momentum = |(body, twist): (&Body<D>, &Vector6<D>)| body.inertia.apply(twist);
        let mut momenta: Vec<_> = self.bodies.iter().zip(&twists).map(momentum).collect();
        let weight = |(body, rotation): (&Body<D>, &hamel::nalgebra::Matrix3<D>)| {
            let fall = rotation.transpose() * self.gravity;
            body.inertia.apply(&join(&Vector3::zeros(), &fall))
        };
        let mut weights: Vec<_> = self.bodies.iter().zip(&rotations).map(weight).collect();
        for (body, momentum) in rid {
            momenta[*body] -= momentum;
            weights[*body] += bracket_dual_product(&twists[*body], momentum);
        }
        let (momenta, weights) = (
            self.gathered(&poses, momenta),
            self.gathered(&poses, weights),
        );
        let mut rates = self.reduced(q, efforts);
        for (i, body) in self.bodies.iter().enumerate() {
            let own = &q[body.configuration.clone()];
            let turned = weights[i] + bracket_dual_product(&twists[i], &momenta[i]);
            let speeds = &speeds[body.speeds.clone()];
            let more = body.joint.bias_momentum(own, speeds, &momenta[i]);
            let columns = body.joint.columns(own);
            let rates = rates[body.speeds.clone()].iter_mut();
            for ((rate, column), more) in rates.zip(&columns).zip(more) {
                *rate += column.dot(&turned) + more;
            }
        }
        for (rate, force) in rates.iter_mut().zip(self.actuation.forces(self, q, speeds)) {
            *rate += force;
        }
        self.actuation
            .add_rotor_rates(self, (q, speeds), &mut rates);
        rates
    }

    /// The power of wrenches that are fixed in bodies, as momenta are in [`DualForm::momentum_rates_beside`].
    pub fn powers(&self, q: &[D], speeds: &[D], wrenches: &[(usize, Vector6<f64>)]) -> Vec<D> {
        let twists = self.twists(&self.poses(q), q, speeds);
        let power =
            |(body, wrench): &(usize, Vector6<f64>)| wrench.map(D::from_f64).dot(&twists[*body]);
        wrenches.iter().map(power).collect()
    }

    /// The rates of [`DualForm::powers`] along a motion.
    pub fn power_rates(
        &self,
        (q, speeds, accelerations): (&[D], &[D], &[D]),
        wrenches: &[(usize, Vector6<f64>)],
    ) -> Vec<D> {
        let motion = (q, speeds, accelerations);
        let motions = self.motions(&self.poses(q), motion, Vector6::zeros());
        let rate = |(body, wrench): &(usize, Vector6<f64>)| {
            let (_, rate) = &motions[*body];
            wrench.map(D::from_f64).dot(rate)
        };
        wrenches.iter().map(rate).collect()
    }

    /// Kinetic energy, and potential energy in gravity.
    pub fn energies(&self, q: &[D], speeds: &[D]) -> (D, D) {
        let poses = self.poses(q);
        let twists = self.twists(&poses, q, speeds);
        let (mut kinetic, mut potential) = (D::from_f64(0.0), D::from_f64(0.0));
        let mut placed: Vec<Pose<D>> = vec![];
        for ((body, pose), twist) in self.bodies.iter().zip(&poses).zip(&twists) {
            let pose = body.parent.map_or(*pose, |parent| placed[parent] * *pose);
            placed.push(pose);
            kinetic += twist.dot(&body.inertia.apply(twist)) * D::from_f64(0.5);
            let inertia = &body.inertia;
            let moment = pose.rotation * inertia.first_moment + pose.translation * inertia.mass;
            potential -= self.gravity.dot(&moment);
        }
        (
            kinetic + self.actuation.rotor_energy(self, q, speeds),
            potential,
        )
    }

    /// The pose of a frame that is fixed in the child frame of the joint under `body`, and the frame's twist in its own axes.
    pub fn frame(
        &self,
        (q, speeds): (&[D], &[D]),
        body: usize,
        fixed: &Pose<f64>,
    ) -> (Pose<D>, Vector6<D>) {
        let (poses, fixed) = (self.poses(q), lifted(fixed));
        let twist = self.twists(&poses, q, speeds)[body];
        let mut pose = poses[body] * fixed;
        let mut next = self.bodies[body].parent;
        while let Some(parent) = next {
            pose = poses[parent] * pose;
            next = self.bodies[parent].parent;
        }
        (pose, fixed.act_twist_inverse(&twist))
    }

    fn twists(&self, poses: &[Pose<D>], q: &[D], speeds: &[D]) -> Vec<Vector6<D>> {
        let mut twists: Vec<Vector6<D>> = vec![];
        for (body, pose) in self.bodies.iter().zip(poses) {
            let above = body
                .parent
                .map_or_else(Vector6::zeros, |parent| twists[parent]);
            let own = body.joint.columns(&q[body.configuration.clone()]);
            let relative = sum(&own, &speeds[body.speeds.clone()]);
            twists.push(pose.act_twist_inverse(&above) + relative);
        }
        twists
    }

    fn rotations(&self, poses: &[Pose<D>]) -> Vec<hamel::nalgebra::Matrix3<D>> {
        let mut rotations: Vec<hamel::nalgebra::Matrix3<D>> = vec![];
        for (body, pose) in self.bodies.iter().zip(poses) {
            let above = body.parent.map(|parent| rotations[parent]);
            rotations.push(above.map_or(pose.rotation, |above| above * pose.rotation));
        }
        rotations
    }

    /// Wrenches or momenta summed over subtrees.
    fn gathered(&self, poses: &[Pose<D>], mut own: Vec<Vector6<D>>) -> Vec<Vector6<D>> {
        for i in (0..own.len()).rev() {
            if let Some(parent) = self.bodies[i].parent {
                let carried = poses[i].act_wrench(&own[i]);
                own[parent] += carried;
            }
        }
        own
    }
}

fn sum<D: Scalar>(columns: &[Vector6<D>], weights: &[D]) -> Vector6<D> {
    let terms = columns.iter().zip(weights);
    terms.fold(Vector6::zeros(), |sum, (column, weight)| {
        sum + column * *weight
    })
}
