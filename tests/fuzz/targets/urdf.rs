//! The reader of robots in URDF, up to the mechanism and its state at time 0; and the way to a scene file.

#![no_main]

use hamel::registry::JointRegistry;
use hamel_tests::fuzz;
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static JOINTS: LazyLock<JointRegistry> = LazyLock::new(hamel_joints::registry);

fuzz_target!(|bytes: &[u8]| fuzz::robot(&String::from_utf8_lossy(bytes), &JOINTS).sound());
