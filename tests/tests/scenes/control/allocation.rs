//! After construction controllers allocate nothing, except for the predictive one.

use super::{controller, scene, watch};
use allocation_counter::measure;

/// Calls of one controller along its own motion; allocations, and how many calls there were.
fn allocations(name: &str) -> (u64, usize) {
    let scene = scene(name);
    let mut law = controller(&scene);
    let mut efforts = vec![0.0; scene.mechanism.layout().freedoms];
    let mut values = vec![0.0; law.measures().len()];
    let (mut count, mut calls) = (0, 0);
    watch(&scene, scene.settings.method, 0.5, &mut |step| {
        let (time, q, speeds) = (step.time, step.configuration, step.speeds);
        let info = measure(|| {
            let made = law.efforts(time, q, speeds, &mut efforts);
            made.expect("sizes fit");
            let measured = law.measure(time, q, speeds, &mut values);
            measured.expect("sizes fit");
        });
        count += info.count_total;
        calls += 1;
    });
    (count, calls)
}

#[test]
fn controllers_do_not_allocate() {
    assert!(measure(|| drop(std::hint::black_box(vec![0_u8; 9]))).count_total > 0);
    for name in [
        "panda7_tracking",
        "ball_pendulum_upright",
        "ball_pendulum_swing_up",
        "cart_path",
    ] {
        let (count, calls) = allocations(name);
        assert!(calls > 10, "{name}: {calls}");
        assert_eq!(count, 0, "{name}");
    }
}
