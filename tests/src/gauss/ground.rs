//! What wheels, axles and contacts keep of velocities, from the poses of their bodies alone.

use super::Smooth;
use hamel_codegen::derived::Derived;
use hamel_codegen::expr::{Expr, Symbol};
use hamel_codegen::matrix::Matrix;

/// A vector of a joint in its frame, as a function of the stored scalars.
pub type Vector = fn(&Derived) -> [Expr; 3];

/// A constraint on velocities.
#[derive(Clone, Copy, Debug)]
pub enum Ground {
    /// On the plane z = 0 the point of a wheel below its centre, by the parameter that is its radius, does not move along the wheel's heading. The wheel's axis is its y.
    Rolls {
        /// The wheel.
        wheel: usize,
        /// Name of the parameter.
        radius: &'static str,
    },
    /// The point of a body ahead of its origin, by a parameter along its x, does not move along the y axis of another.
    Holds {
        /// The body whose point it is.
        body: usize,
        /// Name of the parameter, or the origin itself.
        ahead: Option<&'static str>,
        /// The body whose axis it is.
        axle: usize,
    },
    /// The point of the first body where it touches the ground is at rest.
    Sticks {
        /// From the body's origin to the point.
        point: Vector,
    },
    /// A point of the first body moves along a direction as fast as a coordinate says.
    Drives {
        /// From the body's origin to the point.
        point: Vector,
        /// The direction, a unit vector.
        along: Vector,
        /// Name of a coordinate and of the parameter that its rate is multiplied by; none where the point does not move along.
        by: Option<(&'static str, &'static str)>,
    },
}

impl Ground {
    /// What multiplies the rate of each stored scalar, in sums that are 0.
    pub(super) fn rows(self, derived: &Derived) -> Vec<Vec<Smooth>> {
        let zero = || Expr::integer(0);
        match self {
            Self::Rolls { wheel, radius } => {
                let axis = pose(derived, wheel).0.column(1);
                let heading = [axis[1].clone(), -&axis[0], zero()];
                let below = [zero(), zero(), -&parameter(derived, radius)];
                vec![row(derived, wheel, &below, &heading, None)]
            }
            Self::Holds { body, ahead, axle } => {
                let ahead = ahead.map_or(zero(), |name| parameter(derived, name));
                let x = pose(derived, body).0.column(0);
                let point = [0, 1, 2].map(|i| &x[i] * &ahead);
                let axis = pose(derived, axle).0.column(1);
                let axis = [0, 1, 2].map(|i| axis[i].clone());
                vec![row(derived, body, &point, &axis, None)]
            }
            Self::Sticks { point } => {
                let unit = |i| [0, 1, 2].map(|j| Expr::integer(i64::from(i == j)));
                let units = [0, 1, 2].map(unit);
                let rows = units.iter();
                rows.map(|unit| row(derived, 0, &point(derived), unit, None))
                    .collect()
            }
            Self::Drives { point, along, by } => {
                vec![row(derived, 0, &point(derived), &along(derived), by)]
            }
        }
    }
}

/// The velocity of a point of a body along a direction, less the rate of a coordinate times a parameter.
fn row(
    derived: &Derived,
    body: usize,
    point: &[Expr; 3],
    along: &[Expr; 3],
    less: Option<(&str, &str)>,
) -> Vec<Smooth> {
    let coordinates = derived.space.manifold.coordinates();
    let (rotation, translation) = pose(derived, body);
    let point = Matrix::column_vector(point.to_vec());
    let part = |q: &Symbol| {
        let turn = rotation.derivative(q).times(&rotation.transpose());
        let moved = translation.derivative(q).plus(&turn.times(&point));
        let terms = along.iter().zip(moved.entries());
        let velocity: Expr = terms.map(|(a, b)| a * b).sum();
        match less {
            Some((name, factor)) if q.name() == name => velocity - parameter(derived, factor),
            _ => velocity,
        }
    };
    let parts = coordinates.iter().map(part);
    parts
        .map(|entry| Smooth::new(&entry, &coordinates))
        .collect()
}

/// Rotation and origin of a body.
pub fn pose(derived: &Derived, body: usize) -> (&Matrix, &Matrix) {
    let mut bodies = std::iter::once(derived).chain(&derived.more);
    let pose = &bodies.nth(body).expect("a body").spec.pose.value;
    (&pose.rotation, &pose.translation)
}

/// A parameter by its name.
///
/// # Panics
/// Where the spec has none of that name.
pub fn parameter(derived: &Derived, name: &str) -> Expr {
    let parameters = &derived.space.parameters;
    let found = parameters.iter().find(|own| own.symbol.name() == name);
    Expr::symbol(&found.expect("a parameter of the spec").symbol)
}

/// A stored scalar by its name.
///
/// # Panics
/// Where the spec has none of that name.
pub fn coordinate(derived: &Derived, name: &str) -> Expr {
    let coordinates = derived.space.manifold.coordinates();
    let found = coordinates.iter().find(|own| own.name() == name);
    Expr::symbol(found.unwrap_or_else(|| panic!("{name} is none of {coordinates:?}")))
}
