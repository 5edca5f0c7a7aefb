//! Coordinates and speeds of joints in the quantities that people read, with the names that they have in tables.

mod attitude;
mod coordinates;
mod endings;
mod turns;

pub use attitude::{quaternion, unit_quaternion};
pub use coordinates::{Factor, Kind};
pub use endings::{Ending, coordinate_endings, speed_endings, suffix};
pub use turns::{Angle, Turn, Turns, port_rate, turns, velocity};
