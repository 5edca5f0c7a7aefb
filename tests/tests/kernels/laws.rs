//! The law suite over every joint of the library, one test a joint; a new spec enters by itself.

macro_rules! law_test {
    ($module:ident, $joint:ty, $example:expr, $n:literal, $k:literal, $s:literal, $c:literal) => {
        #[test]
        fn $module() {
            hamel_tests::laws::check_all::<$joint, $n, $k, $s, $c>(&$example);
        }
    };
}

hamel_joints::for_each_joint!(law_test);
