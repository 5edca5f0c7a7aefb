//! The kernels that [`AnyJoint`](super::AnyJoint) passes on to [`Joint`](crate::joint::Joint) as they are, in one table.
//!
//! A new kernel of a joint is a row here: its name, its arguments, a wrench or momentum `h` among them after a semicolon. Every row is a method that writes its result into the slice `out`.

macro_rules! kernels {
    ($then:ident) => {
        $then! {
            /// [`Joint::twist_map`] into `out` (6×K).
            twist_map(q);
            /// [`Joint::twist_map_child`] into `out` (6×K).
            twist_map_child(q);
            /// [`Joint::twist_map_child_gradient`] into `out` (K slices of 6×K).
            twist_map_child_gradient(q);
            /// [`Joint::velocity_map`] into `out` (K×K).
            velocity_map(q);
            /// [`Joint::velocity_map_inverse`] into `out` (K×K).
            velocity_map_inverse(q);
            /// [`Joint::velocity_map_gradient`] into `out` (K slices of K×K).
            velocity_map_gradient(q);
            /// [`Joint::gamma`] into `out` (K×K).
            gamma(q, v);
            /// [`Joint::j22`] into `out` (K×K).
            j22(q, p);
            /// [`Joint::constraint`] into `out` (K×C).
            constraint(q);
            /// [`Joint::speed_basis`] into `out` (K×S).
            speed_basis(q);
            /// [`Joint::speed_basis_gradient`] into `out` (K slices of K×S).
            speed_basis_gradient(q);
            /// [`Joint::retract_differential`] into `out` (K×K).
            retract_differential(q, phi);
            /// [`Joint::retract_differential_inverse`] into `out` (K).
            retract_differential_inverse(q, phi, rate);
            /// [`Joint::bias_momentum`] into `out` (S).
            bias_momentum(q, speeds; h);
            /// [`Products::local_twist_map`] into `out` (6×K).
            local_twist_map(q);
            /// [`Products::twist_gradient`] into `out` (6×K).
            twist_gradient(q, speeds);
            /// [`Products::effort_gradient`] into `out` (S×K).
            effort_gradient(q; h);
            /// [`Products::twist_map_rate`] into `out` (6×S).
            twist_map_rate(q, speeds);
            /// [`Products::bias_acceleration_gradient`] into `out` (6×K).
            bias_acceleration_gradient(q, speeds);
            /// [`Products::bias_acceleration_slope`] into `out` (6×S).
            bias_acceleration_slope(q, speeds);
            /// [`Products::bias_momentum_gradient`] into `out` (S×K).
            bias_momentum_gradient(q, speeds; h);
            /// [`Products::bias_momentum_slope`] into `out` (S×S).
            bias_momentum_slope(q; h);
        }
    };
}

/// The rows as methods of the trait.
macro_rules! declared {
    ($($(#[$doc:meta])* $name:ident($($vector:ident),* $(; $h:ident)?);)*) => {
        $($(#[$doc])* fn $name(&self, $($vector: &[f64],)* $($h: &Vector6<f64>,)? out: &mut [f64]);)*
    };
}

/// The rows as their implementation for a pair of a joint and its sizes.
macro_rules! passed_on {
    ($($(#[$doc:meta])* $name:ident($($vector:ident),* $(; $h:ident)?);)*) => {
        $(fn $name(&self, $($vector: &[f64],)* $($h: &Vector6<f64>,)? out: &mut [f64]) {
            Store::<f64>::store(&self.0.$name($(&operand!($vector, self, $vector),)* $($h)?), out);
        })*
    };
}

/// An argument by its name: q is stored, and all others are vectors of fixed sizes.
macro_rules! operand {
    (q, $pair:ident, $vector:ident) => {
        stored(&$pair.0, $vector)
    };
    ($name:ident, $pair:ident, $vector:ident) => {
        vector($vector)
    };
}

pub(super) use {declared, kernels, operand, passed_on};
