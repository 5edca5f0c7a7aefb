//! Compensated summation of the state (Kahan): what rounding takes in one step is given back in the next.
//!
//! Over n steps, rounding errors add up to n units in the last place, or √n at best. Here every y and
//! every ϕ keeps what the sum was too coarse to take (W. Kahan; here with the exact remainder of D. E. Knuth). It belongs to the
//! integration: the state that a caller sees is rounded.

use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::mechanism::{Body, Mechanism};

/// The exact state is that of `Φ(base, ϕ + compensation.phi)` and `y + compensation.y`.
#[derive(Clone, Debug)]
pub(super) struct Compensation {
    /// One entry a degree of freedom.
    pub(super) phi: Vec<f64>,
    /// One entry a speed.
    pub(super) y: Vec<f64>,
}

impl Compensation {
    /// Nothing left over.
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        let layout = mechanism.layout();
        Self {
            phi: vec![0.0; layout.freedoms],
            y: vec![0.0; layout.speeds],
        }
    }

    /// Turns the residue of `phi` at the base point `old` into that of ϕ = 0 at `new`: where the two add up, with what is lost
    /// of their sum.
    pub(super) fn keep(&mut self, body: &Body, old: &[f64], new: &[f64], phi: &[f64]) {
        let own = &mut self.phi[body.ranges().freedoms.clone()];
        if !adds(body) {
            own.fill(0.0);
            return;
        }
        for (i, rest) in own.iter_mut().enumerate() {
            let (sum, lost) = add_exactly(old[i], phi[i]);
            // Any other Φ of flat coordinates, and a projection that moves them, show here.
            *rest = if sum == new[i] { lost + *rest } else { 0.0 };
        }
    }
}

/// Whether Φ can be Q + ϕ: coordinates as many as degrees of freedom, and rates that ϕ does not bend.
fn adds(body: &Body) -> bool {
    let layout = body.joint().layout();
    layout.configuration == layout.freedoms
        && body.joint().structures().retract_differential.is_identity()
}

/// The rounded sum, and what it lacks of the exact one.
pub(super) fn add_exactly(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

#[cfg(test)]
mod tests {
    use super::add_exactly;

    #[test]
    fn nothing_is_lost() {
        // 1 is half an ulp of 2^53 and more than that of nothing: it comes back whole.
        assert_eq!(
            add_exactly(9_007_199_254_740_992.0, 1.0),
            (9_007_199_254_740_992.0, 1.0)
        );
        assert_eq!(
            add_exactly(1.0, 9_007_199_254_740_992.0),
            (9_007_199_254_740_992.0, 1.0)
        );
        let (sum, lost) = add_exactly(0.1, 0.2);
        // In exact arithmetic the two doubles differ from 0.3's neighbour by 2^-55.
        assert_eq!((sum, lost), (0.1 + 0.2, -2.0_f64.powi(-55)));
    }
}
