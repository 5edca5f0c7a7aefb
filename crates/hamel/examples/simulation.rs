//! A motion with samples and an event.

use hamel::integrate::Event;

#[allow(missing_docs, reason = "a program")]
pub fn main() -> Result<(), hamel::Error> {
    let rod = hamel::Body::new("rod", "revolute")
        .mass(1.0, [0.5, 0.0, 0.0])
        .inertia([0.0, 0.1, 0.1]);
    let pendulum = hamel::Builder::new()
        .gravity([0.0, -9.81, 0.0])
        .body(rod)
        .build()?;
    let lowest = Event::new("lowest", |_time, q, _speeds| {
        q[0] + std::f64::consts::FRAC_PI_2
    });
    let motion = pendulum
        .simulate()
        .until(2.0)
        .sample_every(0.5)
        .event(lowest)
        .run()?;
    for crossing in &motion.events {
        println!("lowest at {:.6} s", crossing.state.time);
    }
    for state in &motion.samples {
        println!(
            "{:.1} s: {:.6} rad, {:.6} J",
            state.time,
            state.configuration[0],
            pendulum.energy(state)?
        );
    }
    Ok(())
}
