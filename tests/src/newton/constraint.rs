//! What joints forbid, as rows on the accelerations of bodies.

use super::number::{Real, Vector, real};
use super::system::{Inertia, Motion};

/// A direction that a body carries along, or that stands in the world.
#[derive(Clone, Debug)]
pub struct Direction {
    pub carrier: Option<usize>,
    /// In the carrier's axes.
    pub axis: Vector,
}

impl Direction {
    /// The direction in world axes, and its rate of change.
    fn at(&self, motions: &[Motion]) -> (Vector, Vector) {
        self.carrier.map_or((self.axis, Vector::zeros()), |body| {
            let axis = motions[body].rotation * self.axis;
            (axis, motions[body].turning.cross(&axis))
        })
    }
}

/// What a joint forbids.
#[derive(Clone, Debug)]
pub enum Constraint {
    /// A point of `body` has no velocity relative to `base` along a direction.
    Point {
        base: Option<usize>,
        body: usize,
        /// From the body's centre of mass, in its axes.
        point: Vector,
        direction: Direction,
    },
    /// `body` does not turn relative to `base` about a direction.
    Turn {
        base: Option<usize>,
        body: usize,
        direction: Direction,
    },
    /// A thin disk about its own z axis rolls on the plane z = 0 of the world.
    RollingDisk { body: usize, radius: Real },
    /// A ball rolls on a horizontal table that turns about the world's z axis.
    RollingBall {
        body: usize,
        radius: Real,
        /// Of the table, rad/s.
        rate: Real,
    },
}

/// One body's part of a row.
#[derive(Clone, Debug)]
pub struct End {
    pub body: usize,
    /// World axes.
    pub linear: Vector,
    /// Body axes.
    pub angular: Vector,
}

/// `Σ linear·v̇ + angular·ω̇ + bias = 0`.
#[derive(Clone, Debug)]
pub struct Row {
    pub ends: Vec<End>,
    bias: Real,
}

impl Row {
    /// Whether both rows hold one body.
    pub fn meets(&self, other: &Self) -> bool {
        let holds = |end: &End| other.ends.iter().any(|o| o.body == end.body);
        self.ends.iter().any(holds)
    }

    /// Every part divided by the inertia of its body.
    pub fn weighted(&self, bodies: &[Inertia]) -> Self {
        let ends = self.ends.iter().map(|end| End {
            body: end.body,
            linear: end.linear / bodies[end.body].mass,
            angular: bodies[end.body].inverse * end.angular,
        });
        Self {
            ends: ends.collect(),
            bias: self.bias,
        }
    }

    /// The sum of products of parts on the same body.
    pub fn product(&self, other: &Self) -> Real {
        let pairs = self.ends.iter().flat_map(|a| {
            let same = other.ends.iter().filter(move |b| a.body == b.body);
            same.map(move |b| a.linear.dot(&b.linear) + a.angular.dot(&b.angular))
        });
        pairs.fold(real(0.0), |sum, x| sum + x)
    }

    /// What is left of the row under given accelerations.
    pub fn residual(&self, accelerations: &[(Vector, Vector)]) -> Real {
        self.ends.iter().fold(self.bias, |sum, end| {
            let (linear, angular) = &accelerations[end.body];
            sum + end.linear.dot(linear) + end.angular.dot(angular)
        })
    }
}

/// Velocity at an arm from a body's centre, and the part of its acceleration that velocities make.
fn end(body: usize, motion: &Motion, linear: Vector, arm: &Vector) -> End {
    End {
        body,
        linear,
        angular: motion.rotation.transpose() * arm.cross(&linear),
    }
}

impl Constraint {
    /// The rows at one instant: the derivative of what is forbidden.
    pub fn rows(&self, motions: &[Motion]) -> Vec<Row> {
        match self {
            Self::Point {
                base,
                body,
                point,
                direction,
            } => vec![point_row(motions, *base, *body, point, direction)],
            Self::Turn {
                base,
                body,
                direction,
            } => vec![turn_row(motions, *base, *body, direction)],
            Self::RollingDisk { body, radius } => {
                let (arm, change) = disk_contact(&motions[*body], *radius);
                let turning = motions[*body].turning;
                rolling_rows(*body, &motions[*body], &arm, &turning.cross(&change))
            }
            Self::RollingBall { body, radius, rate } => {
                let motion = &motions[*body];
                let up = Vector::z();
                let table = -up.cross(&motion.velocity) * *rate;
                rolling_rows(*body, motion, &(-up * *radius), &table)
            }
        }
    }
}

fn point_row(
    motions: &[Motion],
    base: Option<usize>,
    body: usize,
    point: &Vector,
    direction: &Direction,
) -> Row {
    let (u, change) = direction.at(motions);
    let moving = &motions[body];
    let arm = moving.rotation * point;
    let place = moving.position + arm;
    let velocity = moving.velocity + moving.turning.cross(&arm);
    let mut relative = velocity;
    let mut bias = u.dot(&moving.turning.cross(&moving.turning.cross(&arm)));
    let mut ends = vec![end(body, moving, u, &arm)];
    if let Some(index) = base {
        let carrier = &motions[index];
        let arm = place - carrier.position;
        relative -= carrier.velocity + carrier.turning.cross(&arm);
        bias -= u.dot(&carrier.turning.cross(&(velocity - carrier.velocity)));
        ends.push(end(index, carrier, -u, &arm));
    }
    bias += change.dot(&relative);
    Row { ends, bias }
}

fn turn_row(motions: &[Motion], base: Option<usize>, body: usize, direction: &Direction) -> Row {
    let (axis, change) = direction.at(motions);
    let mut relative = motions[body].turning;
    let part = |body: usize, axis: Vector| End {
        body,
        linear: Vector::zeros(),
        angular: motions[body].rotation.transpose() * axis,
    };
    let mut ends = vec![part(body, axis)];
    if let Some(index) = base {
        relative -= motions[index].turning;
        ends.push(part(index, -axis));
    }
    Row {
        ends,
        bias: change.dot(&relative),
    }
}

/// `v + ω × arm` is prescribed: its derivative, with `bias` the part that holds no acceleration.
fn rolling_rows(body: usize, motion: &Motion, arm: &Vector, bias: &Vector) -> Vec<Row> {
    let axes = [Vector::x(), Vector::y(), Vector::z()];
    let rows = axes.iter().enumerate().map(|(i, axis)| Row {
        ends: vec![end(body, motion, *axis, arm)],
        bias: bias[i],
    });
    rows.collect()
}

/// From the centre of a disk to the lowest point of its rim, and the rate of that vector.
fn disk_contact(motion: &Motion, radius: Real) -> (Vector, Vector) {
    let normal = motion.rotation.column(2).into_owned();
    let normal_rate = motion.turning.cross(&normal);
    // The part of the vertical in the plane of the disk, upwards.
    let steep = Vector::z() - normal * normal.z;
    let steep_rate = -(normal * normal_rate.z + normal_rate * normal.z);
    let length = steep.dot(&steep).sqrt();
    let along = steep.dot(&steep_rate) / (length * length * length);
    (
        steep * (-radius / length),
        (steep_rate / length - steep * along) * -radius,
    )
}
