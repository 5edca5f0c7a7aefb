//! What the joints that close loops ask for, and how they let their second frame move in the first.

use crate::description::Closing;
use hamel_runtime::joint::Relation::{self, Meets, Square};
use nalgebra::Vector6;

/// Everything that must hold between both frames.
pub(super) fn all(closing: Closing) -> Vec<Relation> {
    let meets: &[usize] = match closing {
        Closing::Prismatic | Closing::Cylindrical => &[0, 1],
        Closing::Planar => &[2],
        _ => &[0, 1, 2],
    };
    let square: &[(usize, usize)] = match closing {
        Closing::Revolute | Closing::Cylindrical | Closing::Planar => &[(0, 2), (1, 2)],
        Closing::Prismatic | Closing::Fixed => &[(0, 2), (1, 2), (0, 1)],
        Closing::Spherical => &[],
        Closing::Universal => &[(2, 2)],
    };
    let meets = meets.iter().map(|&i| Meets(i));
    meets
        .chain(square.iter().map(|&(i, j)| Square(i, j)))
        .collect()
}

/// The twists of the second frame in the first that it allows, at any place: a basis of a Lie algebra. `None` of a universal joint, whose motions are no group.
pub(super) fn motions(closing: Closing) -> Option<Vec<Vector6<f64>>> {
    let axes: &[usize] = match closing {
        Closing::Revolute => &[2],
        Closing::Prismatic => &[5],
        Closing::Cylindrical => &[2, 5],
        Closing::Planar => &[2, 3, 4],
        Closing::Spherical => &[0, 1, 2],
        Closing::Fixed => &[],
        Closing::Universal => return None,
    };
    let unit = |&axis: &usize| Vector6::from_fn(|i, _| f64::from(u8::from(i == axis)));
    Some(axes.iter().map(unit).collect())
}

/// Which axes of both frames have one direction, where the relations alone do not tell it from the opposite one.
pub(super) fn directed(closing: Closing) -> &'static [usize] {
    match closing {
        Closing::Prismatic | Closing::Fixed => &[0, 1, 2],
        _ => &[],
    }
}
