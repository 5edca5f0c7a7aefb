//! By which instructions a process computes. Mathematical functions are those of the C library, which has versions with and without fused products and chooses by the processor: their last bits differ.

use hamel::nalgebra::DMatrix;
use hamel::scalar::Scalar;
use pyo3::prelude::*;
use std::env;

/// Arguments of each function.
const ARGUMENTS: usize = 2000;

/// Rows of the matrices that are multiplied.
const SIZE: usize = 12;

/// The level of instructions, and the sum of the bits of mathematical functions at many arguments: processes of one version of the package with the same sum compute the same numbers.
#[pyfunction]
pub fn arithmetic(py: Python<'_>) -> (&'static str, String) {
    let sum = py.detach(sum);
    (level(), format!("{sum:016x}"))
}

/// Fused products need FMA, and the C library asks for AVX2 besides: both belong to x86-64-v3. `GLIBC_TUNABLES` can hide them from it.
#[cfg(target_arch = "x86_64")]
fn level() -> &'static str {
    let tunables = env::var("GLIBC_TUNABLES").unwrap_or_default();
    let is_hidden = ["-FMA", "-AVX2"].iter().any(|name| tunables.contains(name));
    let is_there = is_x86_feature_detected!("fma") && is_x86_feature_detected!("avx2");
    match is_there && !is_hidden {
        true => "x86-64-v3",
        false => "x86-64",
    }
}

/// Other processors have one level.
#[cfg(not(target_arch = "x86_64"))]
fn level() -> &'static str {
    env::consts::ARCH
}

fn sum() -> u64 {
    let mut sum = Sum::new();
    let mut numbers = Numbers(1);
    for _ in 0..ARGUMENTS {
        let (a, b) = (numbers.next(), numbers.next());
        for value in functions(a, b) {
            sum.add(value);
        }
    }
    let mut matrix = || DMatrix::from_fn(SIZE, SIZE, |_, _| numbers.next());
    let (left, right) = (matrix(), matrix());
    for value in &(left * right) {
        sum.add(*value);
    }
    sum.0
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

/// FNV-1a, 64 bits.
struct Sum(u64);

impl Sum {
    const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, value: f64) {
        for byte in value.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
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
