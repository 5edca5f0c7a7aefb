//! Motions in closed form, in 256 bits.

use super::number::{Matrix, Real, Vector, real};
use super::record::{BodyRecord, Record};
use super::scene::Unsupported;
use hamel::nalgebra::Vector3;
use hamel_codegen::precise::Precise;
use hamel_scene::{BodyDescription, Motion, PerFreedom, Position, SceneDescription, SpringEnergy};

const BITS: usize = 256;

fn exact(value: f64) -> Precise {
    Precise::from_f64(value, BITS)
}

/// The nearest double-double, up to its last bits.
fn rounded(value: &Precise) -> Real {
    let head = value.to_f64();
    Real::sum(head, (value - &exact(head)).to_f64())
}

/// Cosine and sine of a double.
pub fn cosine_and_sine(angle: f64) -> (Real, Real) {
    let angle = exact(angle);
    (rounded(&angle.cos()), rounded(&angle.sin()))
}

/// A reference in closed form: what it is made from, its samples, and the highest natural frequency, rad/s.
#[derive(Clone, Debug)]
pub struct Closed {
    /// How it moves at a time, s.
    motion: Kind,
    /// The highest natural frequency, rad/s; 0 if nothing swings.
    pub frequency: f64,
}

#[derive(Clone, Debug)]
enum Kind {
    Oscillator(Oscillator),
    SymmetricBody(SymmetricBody),
}

/// `I θ̈ + c θ̇ + k θ = τ` about the z axis, the centre of mass on it.
#[derive(Clone, Debug)]
struct Oscillator {
    inertia: f64,
    damping: f64,
    stiffness: f64,
    effort: f64,
    angle: f64,
    rate: f64,
}

/// A free body with two equal moments, at the origin, its axes those of the world at time 0.
#[derive(Clone, Debug)]
struct SymmetricBody {
    across: f64,
    along: f64,
    rate: Vector3<f64>,
}

impl Closed {
    /// The closed form of a scene of one body, if it is one of these.
    ///
    /// # Errors
    /// A scene whose motion is not known here.
    pub fn new(scene: &SceneDescription) -> Result<Self, Unsupported> {
        let [body] = scene.bodies.as_slice() else {
            return Err(unknown("it has several bodies"));
        };
        match body.joint.kind.value.as_str() {
            "revolute" | "revolute_circle" => Oscillator::new(body).map(|oscillator| Self {
                frequency: oscillator.frequency(),
                motion: Kind::Oscillator(oscillator),
            }),
            _ => SymmetricBody::new(scene, body).map(|body| Self {
                motion: Kind::SymmetricBody(body),
                frequency: 0.0,
            }),
        }
    }

    /// The energy, J, where it stays.
    pub fn energy(&self) -> Option<Real> {
        match &self.motion {
            Kind::Oscillator(oscillator) => oscillator.energy(),
            Kind::SymmetricBody(body) => Some(body.energy()),
        }
    }

    /// The record at a time, s, with all initial velocities greater by a part of them.
    pub fn record(&self, time: f64, faster: f64) -> Record {
        let faster = &exact(1.0) + &exact(faster);
        let body = match &self.motion {
            Kind::Oscillator(oscillator) => oscillator.record(&exact(time), &faster),
            Kind::SymmetricBody(body) => body.record(&exact(time), &faster),
        };
        Record {
            time,
            bodies: vec![body],
        }
    }
}

fn unknown(why: &str) -> Unsupported {
    Unsupported(format!("no closed form: {why}"))
}

impl Oscillator {
    fn new(body: &BodyDescription) -> Result<Self, Unsupported> {
        let forces = &body.forces;
        let stiffness = match forces.spring.as_ref().map(|spring| &spring.value.energy) {
            None => 0.0,
            Some(SpringEnergy::Diagonal(PerFreedom::All(stiffness))) => *stiffness,
            Some(_) => return Err(unknown("a spring that is no single number")),
        };
        let damping = match forces.damping.as_ref().map(|damping| &damping.value) {
            None => 0.0,
            Some(PerFreedom::All(damping)) => *damping,
            Some(_) => return Err(unknown("a damper that is no single number")),
        };
        let angle = match &body.initial.position {
            Position::Home => 0.0,
            Position::Phi(phi) => phi.value[0],
            _ => return Err(unknown("an angle given by other than phi")),
        };
        let rate = match &body.initial.motion {
            Motion::Rest => 0.0,
            Motion::Speeds(speeds) => speeds.value[0],
            _ => return Err(unknown("a rate given by other than speeds")),
        };
        if body.mass.com != Vector3::zeros() {
            return Err(unknown("the centre of mass is not on the axis"));
        }
        let Some(effort) = forces.constant_effort() else {
            return Err(unknown("an effort that changes with time"));
        };
        if forces.limit.is_some() {
            return Err(unknown("a limit"));
        }
        Ok(Self {
            inertia: body.mass.inertia_com[(2, 2)],
            damping,
            stiffness,
            effort: effort.first().copied().unwrap_or(0.0),
            angle,
            rate,
        })
    }

    /// rad/s; 0 where nothing swings.
    fn frequency(&self) -> f64 {
        let square = self.stiffness / self.inertia - (0.5 * self.damping / self.inertia).powi(2);
        square.max(0.0).sqrt()
    }

    fn energy(&self) -> Option<Real> {
        let half = |factor: f64, x: f64| real(0.5) * real(factor) * real(x) * real(x);
        let energy = half(self.inertia, self.rate) + half(self.stiffness, self.angle);
        (self.damping == 0.0 && self.effort == 0.0).then_some(energy)
    }

    fn record(&self, time: &Precise, faster: &Precise) -> BodyRecord {
        let rate = &exact(self.rate) * faster;
        let (angle, rate) = match self.stiffness == 0.0 {
            true => self.turned(time, &rate),
            false => self.swung(time, &rate),
        };
        let (cosine, sine) = (rounded(&angle.cos()), rounded(&angle.sin()));
        let (zero, one) = (real(0.0), real(1.0));
        BodyRecord {
            position: Vector::zeros(),
            velocity: Vector::zeros(),
            rate: Vector::new(zero, zero, rounded(&rate)),
            rotation: Matrix::new(cosine, -sine, zero, sine, cosine, zero, zero, zero, one),
        }
    }

    /// Angle and rate without spring and damper.
    fn turned(&self, time: &Precise, rate: &Precise) -> (Precise, Precise) {
        let gain = &(&exact(self.effort) / &exact(self.inertia)) * time;
        let mean = rate + &(&gain * &exact(0.5));
        (&exact(self.angle) + &(&mean * time), rate + &gain)
    }

    /// Angle and rate with a spring: about its rest under the effort, `e^(−dt) (x C + (ẋ + d x) S)` with C and S the cosine of what is
    /// left of the frequency and its sine over it, or the hyperbolic ones.
    fn swung(&self, time: &Precise, rate: &Precise) -> (Precise, Precise) {
        let inertia = exact(self.inertia);
        let rest = &exact(self.effort) / &exact(self.stiffness);
        let start = &exact(self.angle) - &rest;
        let decay = &(&exact(self.damping) / &inertia) * &exact(0.5);
        let stiffness = &exact(self.stiffness) / &inertia;
        let square = &stiffness - &(&decay * &decay);
        let frequency = square.abs().sqrt();
        let (even, odd) = match square.is_negative() {
            true => faded_hyperbolic(&decay, &frequency, time),
            false => faded_circular(&decay, &frequency, time),
        };
        let odd = &odd / &frequency;
        let lead = rate + &(&decay * &start);
        let angle = &(&start * &even) + &(&lead * &odd);
        let fall = &(&decay * rate) + &(&stiffness * &start);
        let change = &(rate * &even) - &(&fall * &odd);
        (&rest + &angle, change)
    }
}

impl SymmetricBody {
    fn new(scene: &SceneDescription, body: &BodyDescription) -> Result<Self, Unsupported> {
        let inertia = &body.mass.inertia_com;
        let free = scene.gravity == Vector3::zeros() && body.forces.is_empty();
        let symmetric = inertia[(0, 0)] == inertia[(1, 1)]
            && inertia.map(|x| x != 0.0).iter().filter(|&&x| x).count() == 3;
        let centred = body.mass.com == Vector3::zeros() && body.initial.position == Position::Home;
        let rate = match &body.initial.motion {
            Motion::Twist(twist) => twist.value.twist.fixed_rows::<3>(0).into_owned(),
            _ => return Err(unknown("a motion given by other than a twist")),
        };
        if !(free && symmetric && centred) {
            return Err(unknown("no free symmetric body at home"));
        }
        Ok(Self {
            across: inertia[(0, 0)],
            along: inertia[(2, 2)],
            rate,
        })
    }

    fn energy(&self) -> Real {
        let moments = [self.across, self.across, self.along];
        let parts = moments.iter().zip(&self.rate);
        let parts = parts.map(|(&moment, &rate)| real(moment) * real(rate) * real(rate));
        parts.fold(real(0.0), |sum, part| sum + part) * real(0.5)
    }

    /// `R = exp(t L/A) exp(t ω₃ (1 − C/A) e₃)`, and L is constant.
    fn record(&self, time: &Precise, faster: &Precise) -> BodyRecord {
        let [x, y, z] = [0, 1, 2].map(|i| &exact(self.rate[i]) * faster);
        let ratio = &exact(self.along) / &exact(self.across);
        let momentum = [x.clone(), y.clone(), &z * &ratio];
        let spin = &(&z - &(&z * &ratio)) * time;
        let (cosine, sine) = (spin.cos(), spin.sin());
        let rate = [
            &(&x * &cosine) + &(&y * &sine),
            &(&y * &cosine) - &(&x * &sine),
            z,
        ];
        let zero = exact(0.0);
        let own = [
            [cosine.clone(), -sine.clone(), zero.clone()],
            [sine, cosine, zero.clone()],
            [zero.clone(), zero, exact(1.0)],
        ];
        let precession = turn(&momentum, time);
        let rotation = Matrix::from_fn(|i, j| {
            let terms = (0..3).map(|k| &precession[i][k] * &own[k][j]);
            rounded(&terms.fold(exact(0.0), |sum, term| &sum + &term))
        });
        BodyRecord {
            position: Vector::zeros(),
            velocity: Vector::zeros(),
            rate: Vector::from_fn(|i, _| rounded(&rate[i])),
            rotation,
        }
    }
}

/// `e^(−dt) cos ωt` and `e^(−dt) sin ωt`.
fn faded_circular(decay: &Precise, frequency: &Precise, time: &Precise) -> (Precise, Precise) {
    let phase = frequency * time;
    let fade = (-(decay * time)).exp();
    (&fade * &phase.cos(), &fade * &phase.sin())
}

/// `e^(−dt) cosh ωt` and `e^(−dt) sinh ωt`, each exponential by itself: their parts are out of range.
fn faded_hyperbolic(decay: &Precise, frequency: &Precise, time: &Precise) -> (Precise, Precise) {
    // Below e^-10⁶ nothing is left of a number next to others.
    let power = |rate: Precise| {
        let exponent = -(&rate * time);
        match exponent.to_f64() < -1e6 {
            true => exact(0.0),
            false => exponent.exp(),
        }
    };
    let (slow, fast) = (power(decay - frequency), power(decay + frequency));
    let half = exact(0.5);
    (&(&slow + &fast) * &half, &(&slow - &fast) * &half)
}

/// `exp(t a~)`, by Rodrigues' formula.
fn turn(axis: &[Precise; 3], time: &Precise) -> [[Precise; 3]; 3] {
    let square = axis.iter().fold(exact(0.0), |sum, a| &sum + &(a * a));
    let length = square.sqrt();
    let [x, y, z] = [0, 1, 2].map(|i| &axis[i] / &length);
    let angle = &length * time;
    let (cosine, sine) = (angle.cos(), angle.sin());
    let rest = &exact(1.0) - &cosine;
    let even = |a: &Precise, b: &Precise| &(a * b) * &rest;
    let plus = |a: &Precise, b: &Precise, c: &Precise| &even(a, b) + &(c * &sine);
    let minus = |a: &Precise, b: &Precise, c: &Precise| &even(a, b) - &(c * &sine);
    [
        [&even(&x, &x) + &cosine, minus(&x, &y, &z), plus(&x, &z, &y)],
        [plus(&x, &y, &z), &even(&y, &y) + &cosine, minus(&y, &z, &x)],
        [minus(&x, &z, &y), plus(&y, &z, &x), &even(&z, &z) + &cosine],
    ]
}
