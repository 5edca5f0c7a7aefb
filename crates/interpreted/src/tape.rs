//! Formulas as a list of operations that run in any scalar.
//!
//! Each operation writes its results behind those of the operations before it, and reads results by their places. The operations are those of the Rust that the
//! generator writes, in the same order, multiply–adds among them, so that rounding is the same.

mod assemble;

use hamel_codegen::expr::Function;
use hamel_runtime::curve::Curve;
use hamel_runtime::scalar::Scalar;
use hamel_runtime::spatial::nearest_rotation;
use nalgebra::{Matrix3, Vector3};

pub use assemble::{Inputs, assemble};
use hamel_runtime::nalgebra;

/// The place of a result.
type Place = u32;

/// One operation; its operands are places of results before it.
#[derive(Clone, Copy, Debug)]
enum Operation {
    /// An entry of an argument.
    Argument(u8, u16),
    /// A parameter of the joint.
    Parameter(u16),
    Constant(f64),
    Add(Place, Place),
    Subtract(Place, Place),
    Multiply(Place, Place),
    Divide(Place, Place),
    Negate(Place),
    /// First times second plus third, fused where the machine does that.
    MultiplyAdd(Place, Place, Place),
    /// Sine, then cosine.
    SinCos(Place),
    Call(Function, Place),
    CallTwo(Function, Place, Place),
    Curve(Curve, u8, Place),
    /// Of a matrix whose entries by rows are those here: three results.
    RotationVector([Place; 9]),
    /// Three results.
    QuaternionVector([Place; 4]),
    /// Nine results, by rows.
    NearestRotation([Place; 9]),
}

/// A list of operations, and the places of what they are for.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    operations: Vec<Operation>,
    outputs: Vec<Place>,
    /// How many results there are.
    size: usize,
}

/// Where outputs, which are matrices by rows, one after the other, stand in a slice of matrices by columns.
#[derive(Clone, Copy, Debug)]
pub struct Places {
    /// Columns of the outputs.
    pub columns: usize,
    /// Entries of a column in the slice.
    pub rows: usize,
    /// Entries of a matrix, where there are several.
    pub matrix: usize,
}

impl Places {
    /// One after the other.
    pub const IN_ORDER: Self = Self {
        columns: 1,
        rows: 0,
        matrix: usize::MAX,
    };

    const fn of(self, number: usize) -> usize {
        let (before, entry) = (number / self.matrix, number % self.matrix);
        before * self.matrix + entry % self.columns * self.rows + entry / self.columns
    }
}

/// Results of so many operations stand on the stack.
const FEW: usize = 48;
const SOME: usize = 256;

impl Tape {
    /// How many outputs it has.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// Runs the operations on arguments and parameters, and writes each output to its place in `out`.
    pub fn run<T: Scalar>(
        &self,
        arguments: &[&[T]],
        parameters: &[f64],
        (out, places): (&mut [T], Places),
    ) {
        let zero = T::zero();
        let to = (out, places);
        match self.size {
            size if size <= FEW => self.run_in(&mut [zero; FEW], arguments, parameters, to),
            size if size <= SOME => self.run_in(&mut [zero; SOME], arguments, parameters, to),
            size => self.run_in(&mut vec![zero; size], arguments, parameters, to),
        }
    }

    /// Once for each scalar: a copy for each size of results would make programs several times as large.
    #[inline(never)]
    fn run_in<T: Scalar>(
        &self,
        results: &mut [T],
        arguments: &[&[T]],
        parameters: &[f64],
        (out, places): (&mut [T], Places),
    ) {
        let mut next = 0;
        for operation in &self.operations {
            next += operation.run(results, next, arguments, parameters);
        }
        for (number, place) in self.outputs.iter().enumerate() {
            out[places.of(number)] = results[*place as usize];
        }
    }
}

impl Operation {
    /// How many results it has.
    const fn count(&self) -> usize {
        match self {
            Self::SinCos(_) => 2,
            Self::RotationVector(_) | Self::QuaternionVector(_) => 3,
            Self::NearestRotation(_) => 9,
            _ => 1,
        }
    }

    /// Writes its results from the place `next` on, and gives their number.
    #[inline(always)]
    fn run<T: Scalar>(
        &self,
        results: &mut [T],
        next: usize,
        arguments: &[&[T]],
        parameters: &[f64],
    ) -> usize {
        let at = |place: Place| results[place as usize];
        let value = match *self {
            Self::Argument(argument, entry) => arguments[usize::from(argument)][usize::from(entry)],
            Self::Parameter(parameter) => T::from_f64(parameters[usize::from(parameter)]),
            Self::Constant(value) => T::from_f64(value),
            Self::Add(a, b) => at(a) + at(b),
            Self::Subtract(a, b) => at(a) - at(b),
            Self::Multiply(a, b) => at(a) * at(b),
            Self::Divide(a, b) => at(a) / at(b),
            Self::Negate(a) => -at(a),
            Self::MultiplyAdd(a, b, c) => at(a).mul_add(at(b), at(c)),
            Self::Call(function, a) => call(function, at(a)),
            Self::CallTwo(function, a, b) => call_two(function, at(a), at(b)),
            Self::Curve(curve, 0, a) => curve.at(at(a)),
            Self::Curve(curve, order, a) => curve.derivative(at(a), order.into()),
            Self::SinCos(a) => {
                let (sin, cos) = at(a).sin_cos();
                return store(results, next, [sin, cos]);
            }
            Self::RotationVector(entries) => {
                let rotation = Matrix3::from_row_slice(&entries.map(at));
                let vector: Vector3<T> = T::rotation_vector(&rotation);
                return store(results, next, vector.into());
            }
            Self::QuaternionVector(entries) => {
                let vector: Vector3<T> = T::quaternion_vector(entries.map(at));
                return store(results, next, vector.into());
            }
            Self::NearestRotation(entries) => {
                let nearest = nearest_rotation(&Matrix3::from_row_slice(&entries.map(at)));
                let rows: [T; 9] = std::array::from_fn(|i| nearest[(i / 3, i % 3)]);
                return store(results, next, rows);
            }
        };
        store(results, next, [value])
    }
}

#[inline(always)]
fn store<T: Scalar, const M: usize>(results: &mut [T], next: usize, values: [T; M]) -> usize {
    results[next..next + M].copy_from_slice(&values);
    M
}

/// A function of one argument.
fn call<T: Scalar>(function: Function, x: T) -> T {
    match function {
        Function::Sin => x.sin_cos().0,
        Function::Cos => x.sin_cos().1,
        Function::Exp => x.exp(),
        Function::Sinh => x.sinh(),
        Function::Cosh => x.cosh(),
        Function::Sech => x.sech(),
        Function::Tanh => x.tanh(),
        Function::LnCosh => x.ln_cosh(),
        Function::Ln => x.ln(),
        Function::Sqrt => x.sqrt(),
        Function::Recip => T::one() / x,
        Function::Group => x,
        Function::Stumpff(order) => x.stumpff(order.into()),
        Function::DexpInverse(derivative) => x.dexp_inverse(derivative.into()),
        // Those of two arguments, of none, and curves are operations of their own.
        Function::Atan2
        | Function::Larger
        | Function::Ln1p
        | Function::Pi
        | Function::Curve(..) => T::from_f64(f64::NAN),
    }
}

fn call_two<T: Scalar>(function: Function, x: T, y: T) -> T {
    match function {
        Function::Atan2 => x.atan2(y),
        Function::Ln1p => x.ln_1p_scaled(y),
        Function::Larger => x.larger(y),
        _ => T::from_f64(f64::NAN),
    }
}
