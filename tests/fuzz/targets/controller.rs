//! The reader of controllers in files of their own, up to the controller itself: for scenes of three kinds, of which the length of the text
//! chooses one. They are a carriage with a pole, a body on a ball joint, and a cart.

#![no_main]

use hamel_scene::Scene;
use hamel_tests::{fuzz, scenes};
use libfuzzer_sys::{Corpus, fuzz_target};
use std::sync::LazyLock;

static SCENES: LazyLock<Vec<Scene>> = LazyLock::new(|| {
    let names = ["balance_mpc", "ball_pendulum_upright", "cart_path"];
    names.into_iter().map(scenes::load).collect()
});

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let text = String::from_utf8_lossy(bytes);
    if has_long_horizon(&text) {
        return Corpus::Reject;
    }
    fuzz::controller(&text, &SCENES[text.len() % SCENES.len()]).sound();
    Corpus::Keep
});

/// Whether predictive control looks far ahead, which takes as long as thousands of other inputs and goes no other way.
fn has_long_horizon(text: &str) -> bool {
    let digits = |rest: &str| rest.bytes().filter(u8::is_ascii_digit).count();
    let lines = text.lines().filter_map(|line| line.split_once("horizon"));
    lines.map(|(_, rest)| digits(rest)).any(|digits| digits > 1)
}
