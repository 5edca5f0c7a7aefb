//! What each function writes, for the header: units, axes, and the order of the entries.

use crate::functions::Kind;

/// Of the function of that name; empty for one that is none of [`Kind`].
pub fn results(name: &str) -> &'static str {
    let kind = Kind::ALL.into_iter().find(|kind| kind.name() == name);
    kind.map_or("", of)
}

const fn of(kind: Kind) -> &'static str {
    match kind {
        Kind::ForwardDynamics => {
            "results: a, one entry a speed in the order of v; rad/s^2 where it turns, m/s^2 where it slides."
        }
        Kind::InverseDynamics | Kind::BiasForces => {
            "results: efforts, one entry a speed in the order of v; N m where it turns, N where it slides. Gravity, springs, dampers and \
             constant efforts of the scene are at work already; these come to them."
        }
        Kind::MassMatrix => {
            "results: row i and column j belong to speeds i and j in the order of v; kg m^2 where both turn, kg where both slide, \
             kg m between them. Symmetric, and all of it is written."
        }
        Kind::InverseMassMatrix => {
            "results: row i and column j belong to the rates of speeds i and j in the order of v, per unit of their momenta. Symmetric, and all of it \
             is written; rows and columns of joints whose motion is prescribed are 0."
        }
        Kind::MomentumRates => {
            "results: first v, rad/s and m/s, then the rates of p, N m and N, both in the order of v."
        }
        Kind::Momenta => {
            "results: p, one entry a speed in the order of v; N m s where it turns, N s where it slides."
        }
        Kind::Speeds => "results: v, one entry a speed; rad/s where it turns, m/s where it slides.",
        Kind::Hamiltonian => {
            "results: one number, J; the potential energy of gravity is zero at the world's origin."
        }
        Kind::Energies => {
            "results: kinetic energy, then potential energy, J; that of gravity is zero at the world's origin."
        }
        Kind::Poses => {
            "results: 12 numbers a body, in the order of the bodies above. First the rotation R by rows, R11, R12, R13, R21, ..., \
             which takes body axes to world axes; then the origin of the body frame (not the centre of mass), x, y, z in world axes, m."
        }
        Kind::ForwardDerivatives => {
            "results: a row a speed, in the order of v. Its columns are the derivatives of the acceleration by phi (a column a freedom, in the \
             order of tau), by v (a column a speed) and by tau (a column a freedom), then the acceleration itself; units are those of a over those \
             of phi (rad, m), v and tau. phi are local coordinates about q, 0 at q: those of the joint's Phi(q, phi), which `hamel joints explain` \
             writes for each type. Their axes may be others than those of v: of a ball they turn about the child's axes."
        }
        Kind::InverseDerivatives => {
            "results: a row a speed, in the order of v. Its columns are the derivatives of the effort by phi (a column a freedom, in the order of \
             tau) and by v (a column a speed); units are those of efforts over those of phi (rad, m) and v. phi are local coordinates about q, 0 at \
             q: those of the joint's Phi(q, phi), which `hamel joints explain` writes for each type. Their axes may be others than those of v: of a ball \
             they turn about the child's axes."
        }
        Kind::ForwardSecondDerivatives => {
            "results: the second derivatives of the sum of lambda times a, where lambda has one entry a speed. Rows and columns alike belong to phi (one a \
             freedom, in the order of tau), to v (one a speed) and to tau (one a freedom). Symmetric, and all of it is written. phi are local coordinates \
             about q, 0 at q: those of the joint's Phi(q, phi), which `hamel joints explain` writes for each type."
        }
        Kind::InverseSecondDerivatives => {
            "results: the second derivatives of the sum of lambda times the efforts of inverse dynamics, where lambda has one entry a speed. Rows and \
             columns alike belong to phi (one a freedom, in the order of tau), to v and to a (one a speed each). Symmetric, and all of it is written. phi are \
             local coordinates about q, 0 at q: those of the joint's Phi(q, phi), which `hamel joints explain` writes for each type."
        }
    }
}
