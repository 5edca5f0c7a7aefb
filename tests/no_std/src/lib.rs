//! Every kernel of every joint of the library, and a compiled scene, in a program without standard library, allocator and unsafe code.
//!
//! That it builds is the proof: `cargo build --manifest-path tests/no_std/Cargo.toml`.
#![no_std]
#![forbid(unsafe_code)]

mod kernels;
#[path = "../../emitted/src/snakeboard.rs"]
#[rustfmt::skip]
pub mod scene;

use core::panic::PanicInfo;
use hamel::scalar::Dual;

#[panic_handler]
fn stop(_: &PanicInfo) -> ! {
    loop {}
}

/// The sum of all that the kernels give at this configuration's displacement from home, in doubles.
pub fn in_doubles(displacement: f64) -> f64 {
    kernels::of_library(displacement)
}

/// The same in single precision.
pub fn in_singles(displacement: f32) -> f32 {
    kernels::of_library(displacement)
}

/// The same in dual numbers.
pub fn in_duals(displacement: f64) -> Dual<f64> {
    kernels::of_library(Dual::variable(displacement))
}

/// The sum of the accelerations of a compiled scene, all of whose arguments are the same number.
pub fn of_scene(number: f64) -> f64 {
    let rates = scene::forward_dynamics(
        &[number; scene::CONFIGURATION],
        &[number; scene::SPEEDS],
        &[number; scene::FREEDOMS],
    );
    rates.iter().sum()
}
