//! The reader of scene files, up to the mechanism and its state at time 0; and the way back to text.

#![no_main]

use hamel::registry::JointRegistry;
use hamel_tests::fuzz;
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static JOINTS: LazyLock<JointRegistry> = LazyLock::new(hamel_joints::registry);

fuzz_target!(|bytes: &[u8]| fuzz::scene(&String::from_utf8_lossy(bytes), &JOINTS).sound());
