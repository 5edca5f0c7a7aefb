//! How the wrench that a moving body takes changes with its angular velocity.

use super::{Mat3, Rigid, Step, Twist, Vec3, Wrench, apply, cross, dot};
use crate::graph::Sym;

/// `B U = N ad_U V − ad_Uᵀ N V − ad_Vᵀ N U` of bodies with inertia N and twist V: what U added to the twist, together with `ad_U V` added to
/// its rate, adds to the wrench that they take. By Galileo's principle a linear U adds nothing: `B U = (K ω; ω × 2p)`, twelve numbers that add
/// up over bodies.
#[derive(Clone, Debug)]
pub struct Coriolis {
    /// K.
    turn: Mat3,
    /// Twice the momentum p.
    twice: Vec3,
}

impl Coriolis {
    /// Of one body: `K = −2 ω~ J + 2 (h·v) 1 − 2 v hᵀ` with the first moment h and the second moments J.
    pub fn of(rigid: &Rigid, twist: &Twist) -> Self {
        let Rigid {
            mass,
            first,
            second,
        } = rigid;
        let first = first + first;
        let spread = -(second + second);
        let columns = [0, 1, 2].map(|j| cross(&twist.angular, &spread.column(j).into_owned()));
        Self {
            turn: Mat3::from_columns(&columns) + arm(&first, &twist.linear),
            twice: twist.linear * (*mass + *mass) + cross(&twist.angular, &first),
        }
    }

    /// Of both.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            turn: self.turn + other.turn,
            twice: self.twice + other.twice,
        }
    }

    /// The same without signs beside its scalars ([`Sym::settled`]).
    #[must_use]
    pub fn settled(&self) -> Self {
        Self {
            turn: self.turn.map(Sym::settled),
            twice: self.twice.map(Sym::settled),
        }
    }

    /// The same, read at the parent of a placement.
    #[must_use]
    pub fn to_parent(&self, steps: &[Step]) -> Self {
        let steps = steps.iter().rev();
        steps.fold(self.clone(), |own, step| match step {
            Step::Shift(by) => Self {
                turn: own.turn + arm(by, &own.twice),
                twice: own.twice,
            },
            turn => Self {
                turn: turn.turned(&own.turn, false),
                twice: turn.to_parent(&own.twice),
            },
        })
    }

    /// `B U` for the angular part of U.
    pub fn apply(&self, angular: &Vec3) -> Wrench {
        Wrench {
            moment: apply(&self.turn, angular),
            force: cross(angular, &self.twice),
        }
    }

    /// The angular part of `Bᵀ X`; the linear one is zero.
    pub fn apply_transposed(&self, twist: &Twist) -> Vec3 {
        apply(&self.turn.transpose(), &twist.angular) + cross(&self.twice, &twist.linear)
    }
}

/// `(r·p) 1 − p rᵀ`.
fn arm(r: &Vec3, p: &Vec3) -> Mat3 {
    let products = Mat3::from_fn(|i, j| p[i] * r[j]);
    Mat3::from_diagonal_element(dot(r, p)) - products
}
