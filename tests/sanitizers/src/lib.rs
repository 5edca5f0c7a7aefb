//! What of compiled scenes touches memory, for tests under AddressSanitizer: batches of states in their lanes, and libraries in C behind the functions
//! that the program calls.
#![cfg(test)]

mod batches;
mod libraries;
/// How the program loads libraries, as it stands there.
#[path = "../../../crates/native/src/library.rs"]
mod library;
/// A compiled scene with functions of many states.
#[allow(dead_code, reason = "not all of its functions are called here")]
mod module {
    include!(concat!(env!("OUT_DIR"), "/plate_cart_arm.rs"));
}
