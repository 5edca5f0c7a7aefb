//! Coordinates without jumps: angles that go on where ϕ begins anew after a turn.
//!
//! Where Q comes back to itself after a turn, ϕ of one Q has many values. A joint tells by its Φ which of its coordinates that concerns: all that turn, as one
//! rotation vector, or each for itself. Coordinates that slide belong to the angles in rigid motions: they jump with them, and have poles at whole turns. Such
//! a joint shows its displacement from home instead.

use hamel::erased::AnyJoint;
use nalgebra::{DMatrix, DVector, Matrix6xX};
use std::f64::consts::TAU;

/// How near ϕ must come to itself for Q to be the same, as part of its size.
const SAME: f64 = 1e-9;

/// The coordinates of one joint, followed from frame to frame.
#[derive(Debug)]
pub struct Unwrapped {
    home: Vec<f64>,
    /// Coordinates that come back after a turn: each group is a rotation vector.
    groups: Vec<Vec<usize>>,
    /// The others.
    rest: Vec<usize>,
    /// From a displacement, in axes of the home pose, to the others; absent where they do not belong to the angles.
    slides: Option<DMatrix<f64>>,
    last: Option<Vec<f64>>,
}

impl Unwrapped {
    /// Follows the coordinates of `joint` from `home`.
    pub fn new(joint: &dyn AnyJoint, home: Vec<f64>) -> Self {
        let turning = turning(joint, &home);
        let together = vec![turning.clone()];
        let alone = turning.iter().map(|index| vec![*index]).collect();
        let mut this = Self {
            home,
            groups: vec![],
            rest: vec![],
            slides: None,
            last: None,
        };
        let freedoms = joint.layout().freedoms;
        for groups in [alone, together] {
            this.rest = (0..freedoms)
                .filter(|index| !turning.contains(index))
                .collect();
            this.groups = groups;
            if let Some(belong) = this.turns(joint) {
                this.slides = belong.then(|| this.slides(joint)).flatten();
                return this;
            }
        }
        this.groups = vec![];
        this
    }

    /// ϕ of `q`; NaN where there is none.
    pub fn follow(&mut self, joint: &dyn AnyJoint, q: &[f64]) -> Vec<f64> {
        let Some(mut phi) = self.local(joint, q) else {
            return vec![f64::NAN; joint.layout().freedoms];
        };
        if let Some(last) = &self.last {
            for group in &self.groups {
                go_on(&mut phi, last, group);
            }
        }
        if let Some(slides) = &self.slides {
            let [home, pose] = [joint.pose(&self.home), joint.pose(q)];
            let displacement = home.inverse().compose(&pose).translation;
            let slid = slides * DVector::from_column_slice(displacement.as_slice());
            for (index, value) in self.rest.iter().zip(slid.iter()) {
                phi[*index] = *value;
            }
        }
        self.last = Some(phi.clone());
        phi
    }

    fn local(&self, joint: &dyn AnyJoint, q: &[f64]) -> Option<Vec<f64>> {
        let mut phi = vec![0.0; joint.layout().freedoms];
        joint.local(&self.home, q, &mut phi).ok()?;
        Some(phi)
    }

    /// ϕ of Φ(home, `phi`).
    fn again(&self, joint: &dyn AnyJoint, phi: &[f64]) -> Option<Vec<f64>> {
        let mut q = vec![0.0; self.home.len()];
        joint.retract(&self.home, phi, &mut q);
        self.local(joint, &q)
    }

    /// `phi` with those coordinates that slide for which Q is the one of `principal`: in these, ϕ of Φ is linear.
    fn slid(&self, joint: &dyn AnyJoint, phi: &[f64], principal: &[f64]) -> Option<Vec<f64>> {
        let rest = &self.rest;
        let mut phi = phi.to_vec();
        let entries =
            |phi: &[f64]| DVector::from_iterator(rest.len(), rest.iter().map(|k| phi[*k]));
        if !rest.is_empty() {
            let mut columns = vec![];
            for index in rest {
                rest.iter().for_each(|other| phi[*other] = 0.0);
                phi[*index] = 1.0;
                columns.push(entries(&self.again(joint, &phi)?));
            }
            let found = DMatrix::from_columns(&columns)
                .lu()
                .solve(&entries(principal))?;
            for (index, value) in rest.iter().zip(found.iter()) {
                phi[*index] = *value;
            }
        }
        let again = self.again(joint, &phi)?;
        let size = principal
            .iter()
            .fold(1.0_f64, |most, part| most.max(part.abs()));
        let mut pairs = again.iter().zip(principal);
        pairs
            .all(|(a, b)| (a - b).abs() <= SAME * size)
            .then_some(phi)
    }

    /// Whether the coordinates that slide change with a turn of a group, where such a turn leads back to the same Q.
    fn turns(&self, joint: &dyn AnyJoint) -> Option<bool> {
        let some = (0..joint.layout().freedoms).map(|index| 0.3 + 0.11 * index as f64);
        let some: Vec<f64> = some.collect();
        let principal = self.again(joint, &some)?;
        let mut belong = false;
        for group in &self.groups {
            let mut phi = principal.clone();
            turn(&mut phi, group, 1.0);
            let slid = self.slid(joint, &phi, &principal)?;
            let mut rest = self.rest.iter();
            belong |= rest.any(|index| (slid[*index] - principal[*index]).abs() > SAME);
        }
        Some(belong)
    }

    /// The inverse of how the coordinates that slide displace the body at home.
    fn slides(&self, joint: &dyn AnyJoint) -> Option<DMatrix<f64>> {
        let mut map = Matrix6xX::zeros(joint.layout().freedoms);
        joint.twist_map_child(&self.home, map.as_mut_slice());
        let columns: Vec<_> = self
            .rest
            .iter()
            .map(|index| map.column(*index).rows(3, 3).into_owned())
            .collect();
        let linear = DMatrix::from_columns(&columns);
        linear.pseudo_inverse(SAME).ok()
    }
}

/// The degrees of freedom that turn the body.
fn turning(joint: &dyn AnyJoint, home: &[f64]) -> Vec<usize> {
    let mut map = Matrix6xX::zeros(joint.layout().freedoms);
    joint.twist_map_child(home, map.as_mut_slice());
    let twists = map.column_iter().enumerate();
    let turning = twists.filter(|(_, twist)| twist.rows(0, 3).amax() > 0.0);
    turning.map(|(index, _)| index).collect()
}

fn norm(phi: &[f64], group: &[usize]) -> f64 {
    let squares = group.iter().map(|index| phi[*index] * phi[*index]);
    squares.sum::<f64>().sqrt()
}

/// Makes a rotation vector longer by so many turns.
fn turn(phi: &mut [f64], group: &[usize], turns: f64) {
    let length = norm(phi, group);
    if length > 0.0 {
        let factor = 1.0 + turns * TAU / length;
        group.iter().for_each(|index| phi[*index] *= factor);
    }
}

/// Turns a rotation vector as often as brings it nearest to the last one.
fn go_on(phi: &mut [f64], last: &[f64], group: &[usize]) {
    let length = norm(phi, group);
    if length > 0.0 {
        let along: f64 = group.iter().map(|index| phi[*index] * last[*index]).sum();
        turn(phi, group, ((along / length - length) / TAU).round());
        return;
    }
    // No rotation at all has every direction: that of the last one.
    let before = norm(last, group);
    if before > TAU / 2.0 {
        let factor = (before / TAU).round() * TAU / before;
        group
            .iter()
            .for_each(|index| phi[*index] = last[*index] * factor);
    }
}

#[cfg(test)]
mod tests {
    use super::Unwrapped;
    use std::f64::consts::TAU;

    /// Largest step of the coordinates of a joint that turns and slides at `rate` for ten units of time, and where they end.
    fn followed(name: &str, parameters: &[f64], rate: &[f64]) -> (f64, Vec<f64>) {
        let registry = hamel::joints::registry();
        let entry = registry.get(name).expect("a joint of the library");
        let joint = (entry.build)(parameters).expect("parameters in range");
        let layout = joint.layout();
        let mut home = vec![0.0; layout.configuration];
        joint.home(&mut home);
        let mut unwrapped = Unwrapped::new(&*joint, home.clone());
        let (mut step, mut last) = (0.0_f64, vec![0.0; layout.freedoms]);
        for k in 0..=1000 {
            let phi: Vec<f64> = rate.iter().map(|part| part * 0.01 * f64::from(k)).collect();
            let mut q = vec![0.0; layout.configuration];
            joint.retract(&home, &phi, &mut q);
            let next = unwrapped.follow(&*joint, &q);
            for (a, b) in next.iter().zip(&last) {
                step = step.max((a - b).abs());
            }
            last = next;
        }
        (step, last)
    }

    #[test]
    fn coordinates_go_on_after_half_a_turn() {
        let radius = [0.25];
        for (name, parameters, rate) in [
            ("revolute", &[][..], &[2.0][..]),
            ("revolute_circle", &[], &[2.0]),
            ("ball", &[], &[1.0, -0.4, 0.7][..]),
            ("ball_quaternion", &[], &[1.0, -0.4, 0.7]),
            ("planar", &[], &[1.5, 0.3, -0.2]),
            ("cart", &[], &[-1.5, 0.3, -0.2]),
            ("free", &[], &[1.0, -0.4, 0.7, 0.2, 0.1, -0.3]),
            ("universal", &[], &[1.0, 2.0]),
            ("falling_disk", &radius, &[0.1, 0.05, 1.3, 0.2, 0.1]),
        ] {
            let (step, last) = followed(name, parameters, rate);
            let most = rate.iter().map(|part| part * part).sum::<f64>().sqrt();
            assert!(step <= 0.0101 * most, "{name} jumps by {step}");
            // Of rigid motions, the displacement is shown.
            let angles = match name {
                "planar" | "cart" => 1,
                "free" => 3,
                _ => rate.len(),
            };
            for (found, rate) in last.iter().zip(rate).take(angles) {
                assert!((found - 10.0 * rate).abs() < 1e-6, "{name}: {last:?}");
            }
        }
    }

    #[test]
    fn a_rotation_through_home_keeps_its_turns() {
        let mut phi = [0.0; 3];
        super::go_on(&mut phi, &[0.0, TAU - 0.01, 0.0], &[0, 1, 2]);
        assert!((phi[1] - TAU).abs() < 1e-12, "{phi:?}");
        let mut phi = [0.0, -0.1, 0.0];
        super::go_on(&mut phi, &[0.0, TAU - 0.11, 0.0], &[0, 1, 2]);
        assert!((phi[1] - (TAU - 0.1)).abs() < 1e-12, "{phi:?}");
    }
}
