//! Errors in units of the last place, the worst of each kernel kept.

use super::{Grid, Tracked, Wide};
use hamel::nalgebra::SMatrix;
use hamel::scalar::Scalar;
use std::collections::BTreeMap;

/// A type of numbers whose kernels are measured.
pub trait Measured: Scalar {
    /// Name of the type.
    const NAME: &'static str;
    /// One unit in the last place of 1.
    const ULP: f64;
    /// The smallest number with all its digits.
    const NORMAL: f64;
    /// The smallest positive number: nothing is more accurate than this.
    const TINY: f64;
    /// Decimal exponent of the smallest arguments: their products still are numbers.
    const SMALLEST: f64;
    /// Rounds to the type.
    fn round(value: f64) -> f64;
    /// The value, exactly.
    fn wide(self) -> f64;
}

impl Measured for f64 {
    const NAME: &'static str = "f64";
    const ULP: f64 = f64::EPSILON;
    const NORMAL: f64 = f64::MIN_POSITIVE;
    const TINY: f64 = 5e-324;
    const SMALLEST: f64 = -300.0;
    fn round(value: f64) -> f64 {
        value
    }
    fn wide(self) -> f64 {
        self
    }
}

impl Measured for f32 {
    const NAME: &'static str = "f32";
    const ULP: f64 = f32::EPSILON as f64;
    const NORMAL: f64 = f32::MIN_POSITIVE as f64;
    const TINY: f64 = 1.401_298_464_324_817e-45;
    const SMALLEST: f64 = -36.0;
    fn round(value: f64) -> f64 {
        f64::from(value as f32)
    }
    fn wide(self) -> f64 {
        self.into()
    }
}

/// The worst error of each kernel, and where it was met.
#[derive(Clone, Debug, Default)]
pub struct Worst {
    /// By kernel: error in ulp, and the place.
    pub errors: BTreeMap<&'static str, (f64, String)>,
}

impl Worst {
    /// Takes the error of one number.
    pub fn meet<T: Measured>(
        &mut self,
        kernel: &'static str,
        got: T,
        want: &Tracked,
        place: &dyn Fn() -> String,
    ) {
        let got = got.wide();
        let unit = T::ULP * want.scale;
        // Twice the smallest number: a product below it is rounded to it or to 0 at every step.
        let unit = if unit >= 2.0 * T::TINY {
            unit
        } else {
            2.0 * T::TINY
        };
        // An infinite scale would forgive everything.
        let unit = if unit.is_finite() { unit } else { f64::NAN };
        let distance = Wide::from_f64(got) - want.value;
        self.error(kernel, distance.to_f64().abs() / unit, || {
            format!(
                "got {got:e} for {:e} of scale {:e} at {}",
                want.value.to_f64(),
                want.scale,
                place()
            )
        });
    }

    /// Takes an error in ulp.
    pub fn error(&mut self, kernel: &'static str, error: f64, place: impl FnOnce() -> String) {
        let entry = self.errors.entry(kernel).or_default();
        // A NaN is worse than any number, and stays.
        if error.is_nan() || error > entry.0 {
            *entry = (error, place());
        }
    }

    /// Takes the errors of a matrix.
    pub fn matrix<T: Measured, const R: usize, const C: usize>(
        &mut self,
        kernel: &'static str,
        got: &SMatrix<T, R, C>,
        want: &Grid<Tracked>,
        place: &dyn Fn() -> String,
    ) {
        assert_eq!((want.rows, want.columns), (R, C), "{kernel}: shapes differ");
        self.entries(kernel, got.as_slice(), want, place);
    }

    /// The same for numbers column by column: compiled once for a type, not for each shape.
    fn entries<T: Measured>(
        &mut self,
        kernel: &'static str,
        got: &[T],
        want: &Grid<Tracked>,
        place: &dyn Fn() -> String,
    ) {
        for (at, number) in got.iter().enumerate() {
            let (i, j) = (at % want.rows, at / want.rows);
            self.meet(kernel, *number, want.at(i, j), &|| {
                format!("({i}, {j}), {}", place())
            });
        }
    }

    /// Takes the worse of both.
    pub fn merge(&mut self, other: Self) {
        for (kernel, (error, place)) in other.errors {
            self.error(kernel, error, || place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Measured, Worst};
    use crate::accuracy::{Tracked, Wide, check};

    fn want(scale: f64) -> Tracked {
        Tracked::computed(Wide::from_f64(1.0), scale)
    }

    fn error(got: f64, scale: f64) -> f64 {
        let mut worst = Worst::default();
        worst.meet("kernel", got, &want(scale), &String::new);
        worst.errors["kernel"].0
    }

    #[test]
    fn errors_are_in_ulp_of_the_scale() {
        assert_eq!(error(1.0 + 3.0 * f64::EPSILON, 0.0), 3.0);
        assert_eq!(error(1.0 + 3.0 * f64::EPSILON, 4.0), 0.75);
        assert!(error(f64::NAN, 1.0).is_nan());
        assert!(error(1.0, f64::INFINITY).is_nan());
        assert_eq!(<f32 as Measured>::round(0.1), f64::from(0.1_f32));
    }

    #[test]
    #[should_panic(expected = "joint.kernel: 17.0 ulp")]
    fn more_than_the_bound_is_refused() {
        let mut worst = Worst::default();
        worst.meet(
            "kernel",
            1.0 + 17.0 * f64::EPSILON,
            &want(1.0),
            &String::new,
        );
        check("joint", &worst, 16.0);
    }

    #[test]
    #[should_panic(expected = "joint.kernel: NaN ulp")]
    fn nan_is_refused() {
        let mut worst = Worst::default();
        worst.meet("kernel", f64::NAN, &want(1.0), &String::new);
        worst.meet("kernel", 1.0, &want(1.0), &String::new);
        check("joint", &worst, 16.0);
    }
}
