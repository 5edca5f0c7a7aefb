//! Operations of the runtime's group functions, counted on numbers that count.

mod counted;

use counted::{Counted, operations_of};
use hamel::group::{s1, s2, s3, se2, se3, so2, so3};
use hamel::nalgebra::SVector;

/// A function of a group with its additions, multiplications, fused ones, divisions and function calls.
pub type Row = (&'static str, &'static str, [usize; 5]);

/// Any numbers: no function branches on them.
fn any<const N: usize>() -> SVector<Counted, N> {
    SVector::from_fn(|i, _| Counted(0.1 + 0.07 * i as f64))
}

macro_rules! rows {
    ($($group:ident: $($function:ident($($argument:tt),*)),*;)*) => {
        vec![$($((
            stringify!($group),
            stringify!($function),
            operations_of(|| $group::$function($(&any::<$argument>()),*)),
        )),*),*]
    };
}

/// Every function of every group but those of real vectors.
pub fn counted() -> Vec<Row> {
    rows! {
        s1: times_exp(2, 1), rate(2, 1), log_between(2, 2), nearest(2), residual_squared(2);
        so2: times_exp(4, 1), rate(4, 1), log_between(4, 4), nearest(4), residual_squared(4);
        se2: times_exp(6, 3), rate(6, 3), log_between(6, 6), differential(3), differential_inverse(3, 3), nearest(6), residual_squared(6);
        s2: nearest(3), residual_squared(3);
        s3: times_exp(4, 3), rate(4, 3), log_between(4, 4), differential(3), differential_inverse(3, 3), nearest(4), residual_squared(4);
        so3: times_exp(9, 3), rate(9, 3), log_between(9, 9), differential(3), differential_inverse(3, 3), nearest(9), residual_squared(9);
        se3: times_exp(12, 6), rate(12, 6), log_between(12, 12), differential(6), differential_inverse(6, 6), nearest(12), residual_squared(12);
    }
}
