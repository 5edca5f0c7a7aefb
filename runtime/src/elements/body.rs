//! Springs between bodies, and wrenches from outside.

use super::error::{body, values};
use super::{
    Action, Curvature, Curvatures, Element, ElementError, HyperDual, PointForce, Slope, Slopes,
    View,
};
use crate::mechanism::Mechanism;
use crate::scalar::Scalar;
use crate::spatial::fused::{apply, dot};
use crate::spatial::split;
use alloc::string::String;
use nalgebra::{Matrix3, Vector3};

/// A spring with a damper beside it, between two points: force `k (l − l₀) + c l̇` along the line that joins them.
///
/// Where the points coincide the line has no direction, and the force is zero.
#[derive(Clone, Debug)]
pub struct BodySpring {
    /// Name, for messages.
    pub name: String,
    /// The body of each end; `None` is the world.
    pub bodies: [Option<usize>; 2],
    /// The point of each end, in its body frame, m.
    pub points: [Vector3<f64>; 2],
    /// k, N/m; not negative.
    pub stiffness: f64,
    /// c, N·s/m; not negative.
    pub damping: f64,
    /// l₀, m; not negative.
    pub length: f64,
}

impl BodySpring {
    /// Direction from the first end to the second, length and its rate.
    fn line(&self, view: &View<'_>) -> (Vector3<f64>, f64, f64) {
        let (from, from_velocity) = view.point(self.bodies[0], &self.points[0]);
        let (to, to_velocity) = view.point(self.bodies[1], &self.points[1]);
        let (between, rate) = (to - from, to_velocity - from_velocity);
        let length = between.norm();
        if length == 0.0 {
            return (Vector3::zeros(), 0.0, 0.0);
        }
        let direction = between / length;
        (direction, length, dot(&direction, &rate))
    }

    /// The force on the second end as a function of the way between them and of its rate. Along the way it is linear; only what depends on the direction
    /// divides by the length.
    fn force(&self, way: &Vector3<HyperDual>, rate: &Vector3<HyperDual>) -> Vector3<HyperDual> {
        let linear = way * HyperDual::from_f64(-self.stiffness);
        if self.is_linear() {
            return linear;
        }
        let length = Scalar::sqrt(dot(way, way));
        let direction = way.map(|entry| entry / length);
        let along = HyperDual::from_f64(self.stiffness * self.length)
            - HyperDual::from_f64(self.damping) * dot(&direction, rate);
        linear + direction * along
    }

    /// Whether the force is `−k x`, which needs no direction.
    fn is_linear(&self) -> bool {
        self.damping == 0.0 && (self.length == 0.0 || self.stiffness == 0.0)
    }
}

impl Element for BodySpring {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        for index in self.bodies.into_iter().flatten() {
            body(&self.name, mechanism, index)?;
        }
        for point in &self.points {
            values(&self.name, "point", point.as_slice(), 3, true)?;
        }
        values(&self.name, "stiffness", &[self.stiffness], 1, false)?;
        values(&self.name, "damping", &[self.damping], 1, false)?;
        values(&self.name, "length", &[self.length], 1, false)
    }

    fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        let (direction, length, rate) = self.line(view);
        let pull = self.stiffness * (length - self.length) + self.damping * rate;
        for ((end, point), sign) in self.bodies.iter().zip(&self.points).zip([1.0, -1.0]) {
            if let Some(end) = *end {
                action.add_force(end, &view.arm(end, point), &(direction * (sign * pull)));
            }
        }
    }

    fn energy(&self, view: &View<'_>) -> f64 {
        let stretch = self.line(view).1 - self.length;
        0.5 * self.stiffness * stretch * stretch
    }

    fn power(&self, view: &View<'_>) -> f64 {
        let rate = self.line(view).2;
        -self.damping * rate * rate
    }

    fn slope(&self) -> Option<&dyn Slope> {
        Some(self)
    }

    fn curvature(&self) -> Option<&dyn Curvature> {
        Some(self)
    }
}

impl Slope for BodySpring {
    /// With u along the line, `F = −k x + (k l₀ − c l̇) u` on the second end: `∂F/∂x = −k 1 + ((k l₀ − c l̇)/l) (1 − uuᵀ) − c u (u̇)ᵀ`,
    /// `∂F/∂ẋ = −c uuᵀ`, where `u̇ = (ẋ − l̇ u)/l`. Where the points coincide, what depends on u is left out.
    fn add_slopes(&self, view: &View<'_>, slopes: &mut Slopes<'_>) {
        let (u, length, rate) = self.line(view);
        let along = u * u.transpose();
        let linear = Matrix3::identity() * -self.stiffness;
        let by_way = match self.is_linear() || length == 0.0 {
            true => linear,
            false => {
                let velocity = |end: usize| view.point(self.bodies[end], &self.points[end]).1;
                let turn = (velocity(1) - velocity(0) - u * rate) / length;
                let push = self.stiffness * self.length - self.damping * rate;
                let across = Matrix3::identity() - along;
                linear + across * (push / length) - u * turn.transpose() * self.damping
            }
        };
        let pull = self.stiffness * (length - self.length) + self.damping * rate;
        let end = |end: usize| {
            let body = self.bodies[end]?;
            Some((body, view.arm(body, &self.points[end])))
        };
        let force = PointForce {
            ends: [end(0), end(1)],
            force: -u * pull,
            by_way,
            by_rate: -along * self.damping,
        };
        slopes.add_point_force(view, &force);
    }

    fn missing(&self, view: &View<'_>) -> Option<&'static str> {
        let coincide = self.line(view).1 == 0.0 && !self.is_linear();
        coincide.then_some("its points coincide, so that its force has no direction")
    }
}

impl Curvature for BodySpring {
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>) {
        let [from, to] = [0, 1].map(|end: usize| view.point(self.bodies[end], &self.points[end]));
        let ends = [0, 1].map(|end: usize| {
            let body = self.bodies[end]?;
            Some((body, view.arm(body, &self.points[end])))
        });
        let motion = (&(to.0 - from.0), &(to.1 - from.1));
        curvatures.add_point_force(view, ends, motion, &|way, rate| self.force(way, rate));
    }
}

/// The axes in which a wrench from outside is constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrenchAxes {
    /// World axes.
    World,
    /// Axes of the body.
    Body,
}

/// A constant force and moment on a body, from outside.
#[derive(Clone, Debug)]
pub struct BodyWrench {
    /// Name, for messages.
    pub name: String,
    /// The body.
    pub body: usize,
    /// Where the force acts, in the body frame, m.
    pub point: Vector3<f64>,
    /// Force, N.
    pub force: Vector3<f64>,
    /// Moment beside that of the force, N·m.
    pub moment: Vector3<f64>,
    /// The axes of both.
    pub axes: WrenchAxes,
}

/// A force and a moment at one time.
pub(super) struct Pull<'a> {
    pub(super) body: usize,
    pub(super) point: &'a Vector3<f64>,
    pub(super) force: Vector3<f64>,
    pub(super) moment: Vector3<f64>,
    pub(super) axes: WrenchAxes,
}

impl Pull<'_> {
    /// Force and moment in world axes.
    fn in_the_world(&self, view: &View<'_>) -> (Vector3<f64>, Vector3<f64>) {
        if self.axes == WrenchAxes::World {
            return (self.force, self.moment);
        }
        let rotation = view.pose(Some(self.body)).rotation;
        (
            apply(&rotation, &self.force),
            apply(&rotation, &self.moment),
        )
    }

    pub(super) fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        let (force, moment) = self.in_the_world(view);
        action.add_force(self.body, &view.arm(self.body, self.point), &force);
        action.add_wrench(self.body, &moment, &Vector3::zeros());
    }

    pub(super) fn power(&self, view: &View<'_>) -> f64 {
        let (force, moment) = self.in_the_world(view);
        let (_, velocity) = view.point(Some(self.body), self.point);
        let turn = view.motions.twist(self.body).map(|twist| split(twist).0);
        turn.map_or(f64::NAN, |turn| {
            dot(&force, &velocity) + dot(&moment, &turn)
        })
    }
}

impl BodyWrench {
    fn pull(&self) -> Pull<'_> {
        Pull {
            body: self.body,
            point: &self.point,
            force: self.force,
            moment: self.moment,
            axes: self.axes,
        }
    }
}

impl Element for BodyWrench {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        body(&self.name, mechanism, self.body)?;
        values(&self.name, "point", self.point.as_slice(), 3, true)?;
        values(&self.name, "force", self.force.as_slice(), 3, true)?;
        values(&self.name, "moment", self.moment.as_slice(), 3, true)
    }

    fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        self.pull().act(view, action);
    }

    /// Work depends on the path in general: none is counted.
    fn energy(&self, _view: &View<'_>) -> f64 {
        0.0
    }

    fn power(&self, view: &View<'_>) -> f64 {
        self.pull().power(view)
    }

    fn slope(&self) -> Option<&dyn Slope> {
        Some(self)
    }

    fn curvature(&self) -> Option<&dyn Curvature> {
        Some(self)
    }
}

impl Slope for BodyWrench {
    fn add_slopes(&self, view: &View<'_>, slopes: &mut Slopes<'_>) {
        add_wrench_slopes(&self.pull(), view, slopes);
    }
}

impl Curvature for BodyWrench {
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>) {
        add_wrench_curvatures(&self.pull(), view, curvatures);
    }
}

/// A wrench in body axes is carried along with the body, so that nothing changes beside that.
pub(super) fn add_wrench_slopes(pull: &Pull<'_>, view: &View<'_>, slopes: &mut Slopes<'_>) {
    if pull.axes == WrenchAxes::Body {
        return;
    }
    let force = PointForce {
        ends: [None, Some((pull.body, view.arm(pull.body, pull.point)))],
        force: pull.force,
        by_way: Matrix3::zeros(),
        by_rate: Matrix3::zeros(),
    };
    slopes.add_point_force(view, &force);
    slopes.add_moment(view, pull.body, &pull.moment);
}

/// The same of second derivatives.
pub(super) fn add_wrench_curvatures(
    pull: &Pull<'_>,
    view: &View<'_>,
    curvatures: &mut Curvatures<'_>,
) {
    if pull.axes == WrenchAxes::Body {
        return;
    }
    let end = (pull.body, view.arm(pull.body, pull.point));
    let force = pull.force.map(HyperDual::from_f64);
    let still = Vector3::zeros();
    curvatures.add_point_force(view, [None, Some(end)], (&still, &still), &|_, _| force);
    curvatures.add_moment(view, pull.body, &pull.moment);
}
