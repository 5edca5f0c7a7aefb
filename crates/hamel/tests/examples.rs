//! The programs of `examples`, run.

#[path = "../examples/robot.rs"]
mod robot;
#[path = "../examples/simulation.rs"]
mod simulation;

#[test]
fn robot() {
    robot::main().expect("it ends well");
}

#[test]
fn simulation() {
    simulation::main().expect("it ends well");
}
