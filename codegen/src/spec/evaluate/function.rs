//! The functions of the language: one table of names, dispatched by what each takes.

use super::super::ast::Name;
use super::super::value::Value;
use super::super::{Fallible, code, limits, names};
use super::{elementary, rotation};
use crate::algebra;
use crate::diagnostic::Diagnostic;
use crate::expr::Expr;
use crate::manifold::Kind;
use crate::matrix::Matrix;
use crate::model::PoseExpr;
use num_traits::ToPrimitive;
use std::ops::Range;

/// Names of the functions of the language.
pub const NAMES: &[&str] = &[
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sqrt",
    "exp",
    "log",
    "pow",
    "sinh",
    "cosh",
    "tanh",
    "I",
    "O",
    "transpose",
    "tilde",
    "hat",
    "cross",
    "dot",
    "norm",
    "rot",
    "rot_x",
    "rot_y",
    "rot_z",
    "trans",
    "trans_x",
    "trans_y",
    "trans_z",
    "pose",
    "derivative",
];

/// A call, for its errors.
pub(super) struct Call<'a> {
    pub name: &'a str,
    pub span: &'a Range<usize>,
}

impl Call<'_> {
    /// The error that the function does not take these arguments.
    pub fn refuse(&self, takes: &str, arguments: &[Value]) -> Box<Diagnostic> {
        let found = match arguments {
            [] => "nothing".to_owned(),
            _ => arguments
                .iter()
                .map(Value::describe)
                .collect::<Vec<_>>()
                .join(" and "),
        };
        let message = format!("`{}` takes {takes}, found {found}", self.name);
        let error = Diagnostic::new(code::ARGUMENTS, self.span.clone(), message)
            .label("these arguments do not fit");
        let of_group =
            |value: &Value| matches!(value, Value::Element(Kind::S1 | Kind::Se2 | Kind::S3, _));
        Box::new(match arguments.iter().any(of_group) {
            true => error.help("rot_z(Q) of a Q that turns in a plane, and rot(Q) of a quaternion, are rotation matrices"),
            false if self.name == "exp" => {
                error.help("exp(phi) of an algebra element, exp(tilde(a)) of a rotation vector")
            }
            false => error,
        })
    }

    /// The error that the function has no value there.
    pub fn undefined(&self, message: &str) -> Box<Diagnostic> {
        Box::new(
            Diagnostic::new(code::UNDEFINED_VALUE, self.span.clone(), message).label("no value"),
        )
    }

    /// The cosine and sine of an angle.
    pub fn cos_sin(&self, angle: &Expr) -> Fallible<(Expr, Expr)> {
        let (terms, limit) = (angle.terms().len(), limits::LONGEST_ANGLE);
        if terms <= limit {
            return Ok((angle.cos(), angle.sin()));
        }
        let message =
            format!("an angle that is a sum of {terms} terms, at most {limit} are possible");
        Err(Box::new(
            Diagnostic::new(code::TOO_LARGE, self.span.clone(), message)
                .label("too large to expand"),
        ))
    }
}

/// The value of `name(arguments)`.
pub(super) fn apply(name: &Name, arguments: &[Value], span: &Range<usize>) -> Fallible<Value> {
    let call = Call {
        name: &name.text,
        span,
    };
    match (name.text.as_str(), arguments) {
        ("exp", [Value::Tangent(kind, x)]) => exponential(&call, *kind, x),
        ("exp", [matrix]) if matrix.as_rotation().is_some() => skew(&call, matrix, arguments),
        (
            "sin" | "cos" | "tan" | "asin" | "acos" | "atan" | "sqrt" | "exp" | "log" | "sinh"
            | "cosh" | "tanh",
            _,
        ) => elementary::of_one(&call, arguments),
        ("atan2" | "pow", _) => elementary::of_two(&call, arguments),
        ("I" | "O", _) => constant(&call, arguments),
        ("transpose", _) => transpose(&call, arguments),
        ("tilde" | "hat" | "cross" | "dot" | "norm", _) => vectors(&call, arguments),
        ("rot" | "rot_x" | "rot_y" | "rot_z", _) => rotation::rotation(&call, arguments),
        ("trans" | "trans_x" | "trans_y" | "trans_z", _) => translation(&call, arguments),
        ("pose", _) => pose(&call, arguments),
        _ => Err(Box::new(unknown(name))),
    }
}

/// The group element of an algebra element.
fn exponential(call: &Call<'_>, kind: Kind, x: &[Expr]) -> Fallible<Value> {
    match algebra::exp(&algebra::hat(kind, x)) {
        Some(matrix) => Ok(Value::Element(kind, matrix)),
        None => Err(call.undefined("no closed form of exp is known for this element")),
    }
}

/// The rotation whose rotation vector is that of a skew 3×3 matrix.
fn skew(call: &Call<'_>, value: &Value, arguments: &[Value]) -> Fallible<Value> {
    let matrix = value.as_rotation().unwrap_or(Matrix::zeros(3, 3));
    match matrix.plus(&matrix.transpose()).is_zero() {
        true => exponential(call, Kind::So3, &algebra::vee(Kind::So3, &matrix)),
        false => {
            let error = call.refuse(
                "a scalar, an element of an algebra or a skew 3×3 matrix",
                arguments,
            );
            Err(Box::new(
                error
                    .note(format!("it is not skew:\n{matrix}"))
                    .help("exp(tilde(a)) is the rotation about a by the angle |a|"),
            ))
        }
    }
}

fn unknown(name: &Name) -> Diagnostic {
    let error = Diagnostic::new(
        code::FUNCTION,
        name.span.clone(),
        format!("there is no function `{}`", name.text),
    );
    let error = error.label("not a function");
    match (
        name.text.as_str(),
        names::suggestion(&name.text, NAMES.iter().copied()),
    ) {
        ("ln", _) => error.help("the natural logarithm is log(x)"),
        ("arcsin" | "arccos" | "arctan", _) => {
            error.help(format!("write `{}`", name.text.replace("arc", "a")))
        }
        ("arctan2", _) => error.help("write `atan2(y, x)`"),
        ("abs" | "sign" | "min" | "max" | "floor" | "mod", _) => error.help(
            "it is not smooth; sqrt(x * x) is |x| where x does not vanish, which `except x = 0;` declares",
        ),
        (_, Some(advice)) => error.help(advice),
        _ => error.help(format!("functions are {}", NAMES.join(", "))),
    }
}

/// `I(n)` and `O(m, n)`.
fn constant(call: &Call<'_>, arguments: &[Value]) -> Fallible<Value> {
    let size = |value: &Value| {
        let number = value
            .as_scalar()?
            .as_rational()
            .filter(crate::expr::Rational::is_integer)?;
        number
            .to_integer()
            .to_usize()
            .filter(|n| (1..=limits::LARGEST_MATRIX).contains(n))
    };
    let sizes: Option<Vec<usize>> = arguments.iter().map(size).collect();
    match (call.name, sizes.as_deref()) {
        ("I", Some(&[n])) => Ok(Value::matrix(Matrix::identity(n))),
        ("O", Some(&[rows, columns])) => Ok(Value::matrix(Matrix::zeros(rows, columns))),
        ("I", _) => Err(call.refuse(
            &format!("one integer from 1 to {}", limits::LARGEST_MATRIX),
            arguments,
        )),
        _ => Err(call.refuse(
            &format!("two integers from 1 to {}", limits::LARGEST_MATRIX),
            arguments,
        )),
    }
}

fn transpose(call: &Call<'_>, arguments: &[Value]) -> Fallible<Value> {
    match arguments {
        [Value::List(entries)] => Ok(Value::column(entries.clone())),
        [value] if value.as_matrix().is_some() => Ok(Value::matrix(
            value.as_matrix().unwrap_or(Matrix::zeros(1, 1)).transpose(),
        )),
        _ => Err(call.refuse("one matrix", arguments)),
    }
}

/// `tilde(a)`, `cross(a, b)`, `dot(a, b)`, `norm(a)`.
fn vectors(call: &Call<'_>, arguments: &[Value]) -> Fallible<Value> {
    let columns: Option<Vec<Vec<Expr>>> = arguments.iter().map(Value::as_column).collect();
    let dot = |a: &[Expr], b: &[Expr]| -> Expr { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    match (call.name, columns.as_deref()) {
        ("tilde" | "hat", Some([a])) if a.len() == 3 => Ok(Value::Matrix(Matrix::tilde(a))),
        ("cross", Some([a, b])) if a.len() == 3 && b.len() == 3 => Ok(Value::Matrix(
            Matrix::tilde(a).times(&Matrix::column_vector(b.clone())),
        )),
        ("dot", Some([a, b])) if a.len() == b.len() => Ok(Value::Scalar(dot(a, b))),
        ("norm", Some([a])) => Ok(Value::Scalar(dot(a, a).sqrt())),
        ("tilde" | "hat", _) => Err(call.refuse("one vector of 3", arguments)),
        ("cross", _) => Err(call.refuse("two vectors of 3", arguments)),
        ("dot", _) => Err(call.refuse("two vectors of one length", arguments)),
        _ => Err(call.refuse("one vector", arguments)),
    }
}

/// `trans(p)`, and `trans_x(a)` along one axis.
fn translation(call: &Call<'_>, arguments: &[Value]) -> Fallible<Value> {
    let axis = call
        .name
        .strip_prefix("trans_")
        .and_then(|axis| "xyz".find(axis));
    let along = |axis: usize, a: &Expr| {
        (0..3)
            .map(|i| if i == axis { a.clone() } else { Expr::zero() })
            .collect()
    };
    let translation: Vec<Expr> = match (axis, arguments) {
        (Some(axis), [Value::Scalar(a)]) => along(axis, a),
        (None, [p]) if p.as_vector3().is_some() => p.as_vector3().unwrap_or_default(),
        (Some(_), _) => return Err(call.refuse("one scalar", arguments)),
        (None, _) => return Err(call.refuse("one vector of 3", arguments)),
    };
    let translation = Matrix::column_vector(translation);
    Ok(Value::Pose(PoseExpr {
        rotation: Matrix::identity(3),
        translation,
    }))
}

/// `pose(R, p)`
fn pose(call: &Call<'_>, arguments: &[Value]) -> Fallible<Value> {
    let parts = match arguments {
        [rotation, translation] => rotation.as_rotation().zip(translation.as_vector3()),
        _ => None,
    };
    let (rotation, translation) =
        parts.ok_or_else(|| call.refuse("a 3×3 rotation and a vector of 3", arguments))?;
    Ok(Value::Pose(PoseExpr {
        rotation,
        translation: Matrix::column_vector(translation),
    }))
}
