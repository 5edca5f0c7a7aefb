//! What wheels and axles on a plane keep of velocities, from the poses of their bodies alone.

use super::Smooth;
use hamel_codegen::derived::Derived;
use hamel_codegen::expr::{Expr, Symbol};
use hamel_codegen::matrix::Matrix;

/// A constraint on velocities on the plane z = 0 of the joint's frame.
#[derive(Clone, Copy, Debug)]
pub enum Ground {
    /// The point of a wheel below its centre, by the parameter that is its radius, does not move along the wheel's heading. The wheel's axis is its y.
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
}

impl Ground {
    /// What multiplies the rate of each stored scalar, in a sum that is 0.
    pub(super) fn row(self, derived: &Derived) -> Vec<Smooth> {
        let coordinates = derived.space.manifold.coordinates();
        let row = match self {
            Self::Rolls { wheel, radius } => {
                let (rotation, translation) = pose(derived, wheel);
                let axis = rotation.column(1);
                let heading = [axis[1].clone(), -&axis[0], Expr::integer(0)];
                let below = [
                    Expr::integer(0),
                    Expr::integer(0),
                    -&parameter(derived, radius),
                ];
                let below = Matrix::column_vector(below.to_vec());
                let rate = |q: &Symbol| {
                    let turn = rotation.derivative(q).times(&rotation.transpose());
                    translation.derivative(q).plus(&turn.times(&below))
                };
                along(&heading, &coordinates, rate)
            }
            Self::Holds { body, ahead, axle } => {
                let (rotation, translation) = pose(derived, body);
                let ahead = ahead.map_or(Expr::integer(0), |name| parameter(derived, name));
                let x = Matrix::column_vector(rotation.column(0));
                let point = translation.plus(&x.scale(&ahead));
                let axis = pose(derived, axle).0.column(1);
                along(&axis, &coordinates, |q| point.derivative(q))
            }
        };
        row.iter()
            .map(|entry| Smooth::new(entry, &coordinates))
            .collect()
    }
}

/// Rotation and origin of a body.
fn pose(derived: &Derived, body: usize) -> (&Matrix, &Matrix) {
    let mut bodies = std::iter::once(derived).chain(&derived.more);
    let pose = &bodies.nth(body).expect("a body").spec.pose.value;
    (&pose.rotation, &pose.translation)
}

fn parameter(derived: &Derived, name: &str) -> Expr {
    let parameters = &derived.space.parameters;
    let found = parameters.iter().find(|own| &*own.symbol.name == name);
    Expr::symbol(&found.expect("a parameter of the spec").symbol)
}

/// The part along a direction of what each coordinate moves.
fn along(
    direction: &[Expr],
    coordinates: &[Symbol],
    moved: impl Fn(&Symbol) -> Matrix,
) -> Vec<Expr> {
    let part = |q: &Symbol| {
        let moved = moved(q);
        let terms = direction.iter().zip(moved.entries());
        terms.map(|(a, b)| a * b).sum()
    };
    coordinates.iter().map(part).collect()
}
