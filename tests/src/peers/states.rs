//! `STATES.bin`: little-endian doubles, per state q, v and τ; and the way from Pinocchio's coordinates to ours and back.

use super::{JointKind, Model};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion};

/// The states of one model, in the conventions of the library's joints.
#[derive(Clone, Debug)]
pub struct States {
    /// Q of every state.
    pub q: Vec<Vec<f64>>,
    /// v.
    pub v: Vec<Vec<f64>>,
    /// τ, which serves as acceleration in inverse dynamics.
    pub tau: Vec<Vec<f64>>,
}

impl States {
    /// Reads the bytes of a `STATES.bin`; an incomplete state at the end is left out.
    pub fn parse(model: &Model, bytes: &[u8]) -> Self {
        let (nq, nv) = model.sizes();
        let numbers = bytes.chunks_exact(8);
        let numbers: Vec<f64> = numbers
            .map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap_or_default()))
            .collect();
        let mut states = Self {
            q: Vec::new(),
            v: Vec::new(),
            tau: Vec::new(),
        };
        for state in numbers.chunks_exact((nq + 2 * nv).max(1)) {
            states.q.push(convert::configuration(model, &state[..nq]));
            states.v.push(convert::swap(model, &state[nq..nq + nv]));
            states.tau.push(convert::swap(model, &state[nq + nv..]));
        }
        states
    }
}

/// Between Pinocchio's coordinates and those of the library's joints.
pub mod convert {
    use super::{JointKind, Matrix3, Model, Quaternion, UnitQuaternion};

    /// Q from Pinocchio's q.
    pub fn configuration(model: &Model, q: &[f64]) -> Vec<f64> {
        let mut start = 0;
        let mut converted = Vec::new();
        for joint in &model.joints {
            let own = &q[start..start + joint.kind.sizes().0];
            start += own.len();
            match (joint.kind, own) {
                (JointKind::FreeFlyer, &[x, y, z, ref quaternion @ ..]) => {
                    let r = rotation(quaternion);
                    for (i, p) in [x, y, z].into_iter().enumerate() {
                        converted.extend([r[(i, 0)], r[(i, 1)], r[(i, 2)], p]);
                    }
                }
                (JointKind::Spherical, quaternion) => {
                    let r = rotation(quaternion);
                    converted.extend(r.transpose().as_slice());
                }
                (_, own) => converted.extend(own),
            }
        }
        converted
    }

    fn rotation(quaternion: &[f64]) -> Matrix3<f64> {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| quaternion[i]);
        let unit = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
        unit.to_rotation_matrix().into_inner()
    }

    /// Velocities, accelerations or efforts, either way: the halves of a free-flyer change places.
    pub fn swap(model: &Model, v: &[f64]) -> Vec<f64> {
        let mut swapped = v.to_vec();
        let mut start = 0;
        for joint in &model.joints {
            let size = joint.kind.sizes().1;
            if joint.kind == JointKind::FreeFlyer {
                swapped[start..start + size].rotate_left(3);
            }
            start += size;
        }
        swapped
    }

    /// The place of each of our speeds in Pinocchio's v.
    pub fn order(model: &Model) -> Vec<usize> {
        let count = model.sizes().1;
        let places: Vec<f64> = (0..count).map(|i| i as f64).collect();
        swap(model, &places)
            .into_iter()
            .map(|i| i as usize)
            .collect()
    }
}
