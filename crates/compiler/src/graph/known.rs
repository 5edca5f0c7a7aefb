//! Functions at numbers that are known.

use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::Function;
use hamel_codegen::expr::curve::{Curve, Outside};
use hamel_runtime::curve::{self, Curve as Table};
use hamel_runtime::scalar::Scalar;
use hamel_runtime::spatial::nearest_rotation;
use nalgebra::Matrix3;

/// A function of one or two numbers.
pub fn call(function: Function, a: f64, b: Option<f64>) -> f64 {
    match (function, b) {
        (Function::Sin, None) => a.sin(),
        (Function::Cos, None) => a.cos(),
        (Function::Exp, None) => a.exp(),
        (Function::Sinh, None) => Scalar::sinh(a),
        (Function::Cosh, None) => Scalar::cosh(a),
        (Function::Sech, None) => a.sech(),
        (Function::Tanh, None) => Scalar::tanh(a),
        (Function::LnCosh, None) => a.ln_cosh(),
        (Function::Ln, None) => a.ln(),
        (Function::Sqrt, None) => a.sqrt(),
        (Function::Stumpff(order), None) => a.stumpff(order.into()),
        (Function::DexpInverse(order), None) => a.dexp_inverse(order.into()),
        (Function::Curve(of, order), None) => curve(of).derivative(a, order.into()),
        (Function::Atan2, Some(x)) => a.atan2(x),
        (Function::Larger, Some(b)) => a.larger(b),
        (Function::Ln1p, Some(scale)) => a.ln_1p_scaled(scale),
        _ => f64::NAN,
    }
}

/// The curve as kernels have it, so that its values have their bits.
fn curve(of: Curve) -> Table {
    let table = of.table();
    let outside = match table.outside {
        Outside::Undefined => curve::Outside::Undefined,
        Outside::Periodic => curve::Outside::Periodic,
        Outside::Straight => curve::Outside::Straight,
        Outside::Polynomial => curve::Outside::Polynomial,
    };
    Table::new(&table.knots, &table.coefficients, outside)
}

/// The results of a function of the runtime; none where the number of arguments is another.
pub fn primitive(function: Primitive, arguments: &[f64]) -> Vec<f64> {
    let rotation = || (arguments.len() == 9).then(|| Matrix3::from_row_slice(arguments));
    match function {
        Primitive::RotationVector => rotation().map_or(vec![], |rotation| {
            f64::rotation_vector(&rotation).as_slice().to_vec()
        }),
        Primitive::QuaternionVector => arguments.first_chunk().map_or(vec![], |quaternion| {
            f64::quaternion_vector(*quaternion).as_slice().to_vec()
        }),
        Primitive::NearestRotation => rotation().map_or(vec![], |matrix| {
            let nearest = nearest_rotation(&matrix);
            nearest.transpose().as_slice().to_vec()
        }),
    }
}
