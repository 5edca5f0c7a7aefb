//! A block on a belt, held back by a spring: it sticks to the belt and slips on it in turn.

use super::{CLOSED, FORMS, accurate, assert_near, options, run, scene, slide, times_of};

const SPEED: f64 = 0.1;
const STIFFNESS: f64 = 40.0;
const MASS: f64 = 1.5;
const STICKING: f64 = 3.0;
const SLIDING: f64 = 2.0;

/// While it sticks it moves with the belt until `k x = F_s`. Then `m ẍ = −k x + F`, from there at the speed of the belt, which it has again after
/// `2 (π − atan(A ω/u))/ω`, mirrored at F/k: `A = (F_s − F)/k`.
#[test]
fn slips_begin_and_end_when_they_shall() {
    let text = slide(
        "belt",
        "world",
        10.0,
        &format!("motion = {{ speeds = [{SPEED:?}] }}"),
    ) + &slide(
        "block",
        "belt",
        MASS,
        &format!("friction = {{ sliding = {SLIDING:?}, sticking = {STICKING:?} }}"),
    ) + &format!(
        "[[spring]]\nfrom = {{ body = \"block\", point = [0.0, 0.0, 0.0] }}\n\
         to = {{ body = \"world\", point = [-5.0, 0.0, 0.0] }}\nstiffness = {STIFFNESS:?}\nlength = 5.0\n"
    );
    let scene = scene([0.0; 3], &text);
    let omega = (STIFFNESS / MASS).sqrt();
    let amplitude = (STICKING - SLIDING) / STIFFNESS;
    let slip = 2.0 * (std::f64::consts::PI - (amplitude * omega / SPEED).atan()) / omega;
    let stick = 2.0 * amplitude / SPEED;
    let first = STICKING / STIFFNESS / SPEED;
    for form in FORMS {
        let solution = run(&scene, &options(form, accurate(), 20.0));
        let slides = times_of(&solution.events, "block: slides");
        let sticks = times_of(&solution.events, "block: sticks");
        assert!(slides.len() > 10, "{} slips", slides.len());
        for (index, time) in slides.iter().enumerate() {
            let expected = first + index as f64 * (slip + stick);
            assert_near("slides", *time, expected, CLOSED);
        }
        for (index, time) in sticks.iter().enumerate() {
            let expected = first + slip + index as f64 * (slip + stick);
            assert_near("sticks", *time, expected, CLOSED);
        }
        let ends = solution
            .events
            .iter()
            .filter(|event| event.name == "block: sticks");
        for event in ends {
            let x: f64 = event.state.configuration.iter().sum();
            assert_near("x", x, SLIDING / STIFFNESS - amplitude, CLOSED);
        }
    }
}
