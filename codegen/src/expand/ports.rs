//! The rates of ports: w = P v, from the derivatives of their values along ϕ.

use super::Motion;
use crate::expr::Expr;
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::{Declared, Port, PortValue};

/// ∂y/∂ϕ at ϕ = 0, one row for each port. That of an angle is cos ∂sin − sin ∂cos, which needs no quotient.
pub fn gradient(ports: &[Declared<Port>], motion: &Motion, ideal: &Ideal) -> Matrix {
    let slope = |port: &Port, k: usize| match &port.value {
        PortValue::Scalar(value) => motion.along(value, k),
        PortValue::Angle { cos, sin } => {
            let (of_cos, of_sin) = (motion.along(cos, k), motion.along(sin, k));
            &(cos * &of_sin) - &(sin * &of_cos)
        }
    };
    let count = motion.freedoms();
    Matrix::from_fn(ports.len(), count, |i, k| {
        ideal.simplest(&slope(&ports[i].value, k))
    })
}

/// The values, as a column: angles are between −π and π.
pub fn values(ports: &[Declared<Port>]) -> Matrix {
    let value = |port: &Declared<Port>| match &port.value.value {
        PortValue::Scalar(value) => value.clone(),
        PortValue::Angle { cos, sin } => sin.atan2(cos),
    };
    let values: Vec<Expr> = ports.iter().map(value).collect();
    Matrix::column_vector(values)
}
