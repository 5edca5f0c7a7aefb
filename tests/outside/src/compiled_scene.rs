//! A compiled scene, and a batch of its states.

#[allow(dead_code, reason = "generated: all functions of the scene")]
mod arm {
    include!(concat!(env!("OUT_DIR"), "/arm.rs"));
}

pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut model = hamel::load("arm.toml")?;
    let (q, v, tau) = ([0.4, -0.7], [1.0, 2.0], [0.5, 0.0]);
    let rates = arm::forward_dynamics(&q, &v, &tau);
    let count = 10_000;
    let mut all = vec![0.0; 2 * count];
    let batch = hamel::compiled::Batch::new(&arm::EQUATIONS);
    batch.par_forward_dynamics(
        &q.repeat(count),
        &v.repeat(count),
        &tau.repeat(count),
        &mut all,
    )?;
    println!("{count} states: {:?}, {rates:?} one by one", &all[..2]);
    let state = hamel::integrate::State {
        time: 0.0,
        configuration: q.into(),
        speeds: v.into(),
    };
    let tree = model.forward_dynamics(&state, &tau)?;
    for row in all.chunks_exact(2).chain([&rates[..]]) {
        // Some hundred operations of a well-conditioned system.
        assert!(
            (0..2).all(|i| (row[i] - tree[i]).abs() < 1e-12 * tree[i].abs()),
            "{row:?} {tree}"
        );
    }
    Ok(())
}
