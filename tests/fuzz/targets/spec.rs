//! The reader of specs, with its checks.

#![no_main]

use hamel_tests::fuzz;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| fuzz::check(&String::from_utf8_lossy(bytes)).sound());
