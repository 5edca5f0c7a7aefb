//! The level of instructions: by which instructions a process computes.
//!
//! Mathematical functions are those of the C library. That of Linux for x86-64, glibc, has versions of them with fused products and without, and chooses by the processor: last bits of motions depend on which.

use fnv::FnvHasher;
use hamel::scalar::Scalar;
use nalgebra::DMatrix;
use std::env;
use std::hash::Hasher;

/// Levels of x86-64, the lowest first. Other processors have one level each, called as the architecture.
pub const LEVELS: [&str; 2] = ["x86-64", "x86-64-v3"];

/// What hides features of the processor from glibc, in the environment that a process starts with.
pub const VARIABLE: &str = "GLIBC_TUNABLES";

/// Its value for the lowest level. The names with `_Usable` are those before glibc 2.33.
const HIDDEN: &str = "glibc.cpu.hwcaps=-AVX2,-AVX2_Usable,-FMA,-FMA_Usable,-FMA4,-FMA4_Usable";

/// Arguments of each function.
const ARGUMENTS: usize = 2000;

/// Rows of the matrices that are multiplied.
const SIZE: usize = 12;

/// How a process computes: motions have the same bits in all processes of one version of Hamel for which these are the same.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arithmetic {
    /// The level of instructions.
    pub level: &'static str,
    /// FNV-1a of the bits of 38 000 values of mathematical functions, and of a product of matrices, in 16 hexadecimal digits.
    pub sum: String,
}

impl Arithmetic {
    /// That of this process.
    pub fn own() -> Self {
        Self {
            level: level(),
            sum: format!("{:016x}", sum()),
        }
    }
}

/// The value of [`VARIABLE`] with which a process starts at `level`: none where nothing is to be hidden.
pub fn environment(level: &str) -> Option<&'static str> {
    (level == LEVELS[0]).then_some(HIDDEN)
}

/// The level of this process. Fused products need FMA, and the C library asks for AVX2 besides: both belong to x86-64-v3. [`VARIABLE`] can hide them from it.
#[cfg(target_arch = "x86_64")]
pub fn level() -> &'static str {
    let hidden = env::var(VARIABLE).unwrap_or_default();
    let is_hidden = ["-FMA", "-AVX2"].iter().any(|name| hidden.contains(name));
    let is_there = is_x86_feature_detected!("fma") && is_x86_feature_detected!("avx2");
    LEVELS[usize::from(is_there && !is_hidden)]
}

/// The level of this process: other processors have one.
#[cfg(not(target_arch = "x86_64"))]
pub fn level() -> &'static str {
    env::consts::ARCH
}

fn sum() -> u64 {
    let mut hasher = FnvHasher::default();
    let mut add = |value: f64| hasher.write(&value.to_le_bytes());
    let mut numbers = Numbers(1);
    for _ in 0..ARGUMENTS {
        let (a, b) = (numbers.next(), numbers.next());
        functions(a, b).into_iter().for_each(&mut add);
    }
    let mut matrix = || DMatrix::from_fn(SIZE, SIZE, |_, _| numbers.next());
    let (left, right) = (matrix(), matrix());
    (left * right).iter().copied().for_each(add);
    hasher.finish()
}

/// Of two numbers between 0 and 1.
fn functions(a: f64, b: f64) -> [f64; 19] {
    let angle = 20.0 * a - 10.0;
    [
        angle.sin(),
        angle.cos(),
        angle.tan(),
        a.asin(),
        a.acos(),
        angle.atan(),
        a.atan2(b),
        angle.exp(),
        a.exp_m1(),
        a.ln(),
        a.ln_1p(),
        a.log10(),
        a.sinh(),
        a.cosh(),
        a.tanh(),
        a.powf(b),
        a.cbrt(),
        a.hypot(b),
        Scalar::mul_add(a, b, -0.3),
    ]
}

/// Numbers between 0 and 1, always the same ones: a linear congruence with the constants of Knuth's MMIX.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        let next = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = next.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}
