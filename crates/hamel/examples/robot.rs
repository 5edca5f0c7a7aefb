//! A robot in URDF: forward dynamics, mass matrix and the Jacobian of a frame.

/// The robot, an arm with seven joints.
const ROBOT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../tests/data/urdf/panda7.urdf"
);

#[allow(missing_docs, reason = "a program")]
pub fn main() -> Result<(), hamel::Error> {
    let mut robot = hamel::load(ROBOT)?;
    let mut state = robot.state();
    robot.set_position(&mut state, "panda_joint4", &[-1.5])?;
    robot.set_speeds(&mut state, "panda_joint1", &[0.3])?;
    let torques = vec![0.0; robot.sizes().freedoms];
    println!(
        "accelerations {}",
        robot.forward_dynamics(&state, &torques)?.transpose()
    );
    println!("mass matrix {}", robot.mass_matrix(&state)?);
    println!(
        "Jacobian of the tool {}",
        robot.jacobian(&state, "panda_hand_tcp")?
    );
    Ok(())
}
