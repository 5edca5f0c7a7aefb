//! The law suite over every joint of the library, one test per joint; a new spec enters by itself.
//!
//! `everywhere` searches for a place where a kernel is not what the spec defines. Its sweep looks at more parameters, more lines and more
//! places: `cargo test --release --package hamel-tests --test kernels laws -- --ignored`.

use hamel::joint::{Joint, Member};
use hamel_tests::laws::{Reach, check_within};

/// How far from home configurations are where Φ is found by Newton's method, and how far ϕ goes from them, in entries of ϕ: the library's linkages stay on
/// their branch there.
const BY_RELATIONS: f64 = 0.5;

/// The same of linkages with ends, which are nearer.
const WITH_ENDS: f64 = 0.2;

fn check<J, const N: usize, const K: usize, const S: usize, const C: usize>(joint: &J)
where
    J: Joint<N, K, S, C>,
{
    let reach = match (J::RELATIONS, J::SINGULARITIES) {
        ([], _) => Reach::HalfTurn,
        (_, []) => Reach::Around(BY_RELATIONS),
        _ => Reach::Around(WITH_ENDS),
    };
    check_within(joint, reach);
}

macro_rules! law_test {
    ($module:ident, $joint:ty, $example:expr, $n:literal, $k:literal, $s:literal, $c:literal) => {
        #[test]
        fn $module() {
            check::<$joint, $n, $k, $s, $c>(&$example);
        }
    };
}

macro_rules! body_test {
    ($module:ident, $joint:ty, $example:expr, $b:literal, $n:literal, $k:literal, $s:literal, $c:literal) => {
        #[test]
        fn $module() {
            check::<Member<$joint, $b>, $n, $k, $s, $c>(&Member($example));
        }
    };
}

hamel_joints::for_each_joint!(law_test);
hamel_joints::for_each_body!(body_test);

mod everywhere {
    use hamel::joint::{Joint, Member};
    use hamel_tests::laws::search::{Effort, check_everywhere};

    use std::iter::repeat;

    /// The two searches of one joint, or of one body of it.
    macro_rules! searches {
        ($module:ident, $joint:ty, $example:expr, $build:expr, $n:literal, $k:literal, $s:literal, $c:literal) => {
            mod $module {
                use super::*;

                fn check(effort: Effort) {
                    let derived = hamel_tests::derived(<$joint as Joint<$n, $k, $s, $c>>::NAME);
                    check_everywhere::<$joint, $n, $k, $s, $c>(&derived, $build, $example, effort);
                }

                #[test]
                fn kernels_are_their_definitions() {
                    check(match <$joint as Joint<$n, $k, $s, $c>>::RELATIONS {
                        [] => Effort::PLAIN,
                        _ => Effort::RELATIONS,
                    });
                }

                #[test]
                #[ignore = "minutes: thousands of cases in 256 bits"]
                fn kernels_are_their_definitions_in_a_sweep() {
                    check(Effort::SWEEP);
                }
            }
        };
    }

    macro_rules! search_test {
        (
            $module:ident, $joint:ty, $library:tt::joints::$name:ident $(::new($($value:expr),*))?,
            $n:literal, $k:literal, $s:literal, $c:literal
        ) => {
            searches!($module, $joint, &[$($($value),*)?], |_values: &[f64]| {
                let _values = &mut _values.iter().copied().chain(repeat(f64::NAN));
                $library::joints::$name $(::new($({
                    let _: f64 = $value;
                    _values.next().unwrap_or(f64::NAN)
                }),*))?
            }, $n, $k, $s, $c);
        };
    }

    macro_rules! body_test {
        (
            $module:ident, $joint:ty, $library:tt::joints::$name:ident $(::new($($value:expr),*))?,
            $b:literal, $n:literal, $k:literal, $s:literal, $c:literal
        ) => {
            searches!($module, Member<$joint, $b>, &[$($($value),*)?], |_values: &[f64]| {
                let _values = &mut _values.iter().copied().chain(repeat(f64::NAN));
                Member($library::joints::$name $(::new($({
                    let _: f64 = $value;
                    _values.next().unwrap_or(f64::NAN)
                }),*))?)
            }, $n, $k, $s, $c);
        };
    }

    hamel_joints::for_each_joint!(search_test);
    hamel_joints::for_each_body!(body_test);
}
