//! The law suite over every joint of the library, one test per joint; a new spec enters by itself.
//!
//! `everywhere` searches for a place where a kernel is not what the spec defines. Its sweep looks at more parameters, more lines and more
//! places: `cargo test --release --package hamel-tests --test kernels laws -- --ignored`.

macro_rules! law_test {
    ($module:ident, $joint:ty, $example:expr, $n:literal, $k:literal, $s:literal, $c:literal) => {
        #[test]
        fn $module() {
            hamel_tests::laws::check_all::<$joint, $n, $k, $s, $c>(&$example);
        }
    };
}

hamel_joints::for_each_joint!(law_test);

mod everywhere {
    use hamel_tests::laws::search::{Effort, check_everywhere};

    macro_rules! search_test {
        (
            $module:ident, $joint:ty, $library:tt::joints::$name:ident $(::new($($value:expr),*))?,
            $n:literal, $k:literal, $s:literal, $c:literal
        ) => {
            mod $module {
                use super::*;

                fn check(effort: Effort) {
                    let example: &[f64] = &[$($($value),*)?];
                    let build = |_values: &[f64]| {
                        let _values = &mut _values.iter().copied().chain(std::iter::repeat(f64::NAN));
                        $library::joints::$name $(::new($({
                            let _: f64 = $value;
                            _values.next().unwrap_or(f64::NAN)
                        }),*))?
                    };
                    let derived = hamel_tests::derived(stringify!($module));
                    check_everywhere::<$joint, $n, $k, $s, $c>(&derived, build, example, effort);
                }

                #[test]
                fn kernels_are_their_definitions() {
                    check(Effort::PLAIN);
                }

                #[test]
                #[ignore = "minutes: thousands of cases in 256 bits"]
                fn kernels_are_their_definitions_in_a_sweep() {
                    check(Effort::SWEEP);
                }
            }
        };
    }

    hamel_joints::for_each_joint!(search_test);
}
