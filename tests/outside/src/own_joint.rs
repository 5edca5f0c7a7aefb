//! A bead on a wire: a joint that the library does not have.

#[allow(dead_code, unused_imports, reason = "generated: all that a joint has")]
mod joints {
    include!(concat!(env!("OUT_DIR"), "/joints.rs"));
}

pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut known = hamel::joints::registry();
    known.extend(joints::ENTRIES.iter().copied())?;
    let bead = hamel::Body::new("bead", "bead")
        .parameter("curvature", 2.0)
        .mass(0.1, [0.0; 3])
        .inertia([1e-5; 3]);
    let wire = hamel::Builder::new().registry(known).body(bead).build()?;
    let mut start = wire.state();
    wire.set_position(&mut start, "bead", &[0.2, 0.0])?;
    let motion = wire
        .simulate()
        .starting_at(start.clone())
        .until(1.0)
        .run()?;
    let drift = wire.energy(&motion.state)? - wire.energy(&start)?;
    println!(
        "bead at {:.6} m after 1 s, energy changed by {drift:.1e} J",
        motion.state.configuration[0]
    );
    assert!(
        drift.abs() < 1e-8,
        "the tolerance is 1e-10 a step, of some hundred steps"
    );
    Ok(())
}
