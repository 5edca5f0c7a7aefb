//! Units of degrees of freedom, velocities and speeds, as the spec determines them.

use crate::derived::{Derived, KernelKind};
use crate::units::Dimension;

/// The unit of each stored scalar of Q; empty where the spec does not determine it.
pub fn of_coordinates(derived: &Derived) -> Vec<String> {
    let units = derived.spec.units.coordinates.iter();
    units.map(|unit| told(unit.as_ref())).collect()
}

/// The unit of each local coordinate; empty where the spec does not determine it.
pub fn of_freedoms(derived: &Derived) -> Vec<String> {
    let units = derived.spec.units.freedoms.iter();
    units.map(|unit| told(unit.as_ref())).collect()
}

/// The unit of each ϕ̇, in the same way.
pub fn of_local_rates(derived: &Derived) -> Vec<String> {
    rates(&derived.spec.units.freedoms)
}

/// The unit of each v, in the same way.
pub fn of_velocities(derived: &Derived) -> Vec<String> {
    rates(&derived.spec.units.velocities)
}

/// The unit of each effort, which does work at a v, in the same way.
pub fn of_efforts(derived: &Derived) -> Vec<String> {
    let units = derived.spec.units.velocities.iter();
    let efforts = units.map(|unit| unit.as_ref().map(Dimension::effort));
    efforts.map(Option::unwrap_or_default).collect()
}

/// The unit of each speed, in the same way.
pub fn of_speed_rates(derived: &Derived) -> Vec<String> {
    rates(&of_speeds(derived))
}

/// What each speed is the rate of. Where S̄ is derived, a speed is that of a v of which it is a number of times.
pub fn of_speeds(derived: &Derived) -> Vec<Option<Dimension>> {
    let units = &derived.spec.units;
    if !units.speeds.is_empty() {
        return units.speeds.clone();
    }
    let kernel = derived.kernel(KernelKind::SpeedBasis);
    let Some(basis) = kernel.and_then(|kernel| kernel.outputs.first()) else {
        return units.velocities.clone();
    };
    let is_number = |i: usize, j: usize| {
        let entry = basis.at(i, j);
        !entry.is_zero() && entry.as_rational().is_some()
    };
    let unit = |j: usize| {
        let own = (0..basis.rows()).find(|i| is_number(*i, j))?;
        units.velocities.get(own).cloned().flatten()
    };
    (0..basis.columns()).map(unit).collect()
}

fn told(unit: Option<&Dimension>) -> String {
    unit.map(Dimension::in_units).unwrap_or_default()
}

fn rates(units: &[Option<Dimension>]) -> Vec<String> {
    let rates = units.iter().map(|unit| unit.as_ref().map(Dimension::rate));
    rates.map(Option::unwrap_or_default).collect()
}

#[cfg(test)]
mod tests {
    use super::{of_freedoms, of_speed_rates, of_velocities};
    use crate::derive;
    use crate::derived::Derived;

    fn joint(declared: &str) -> Derived {
        let source = format!("hamel = 1; joint test{declared}");
        derive(&source, "test").unwrap_or_else(|errors| panic!("{errors}"))
    }

    fn units(declared: &str) -> (Vec<String>, Vec<String>) {
        let joint = joint(&format!(" {{ {declared} }}"));
        (of_freedoms(&joint), of_velocities(&joint))
    }

    #[test]
    fn freedoms_of_local_are_what_phi_makes_of_them() {
        let planar = "config Q: SE2; local a, x, y;\n\
            Phi = [Q.c * cos(phi.a) - Q.s * sin(phi.a), -Q.s * cos(phi.a) - Q.c * sin(phi.a), Q.x + phi.x;\n\
                   Q.s * cos(phi.a) + Q.c * sin(phi.a), Q.c * cos(phi.a) - Q.s * sin(phi.a), Q.y + phi.y];\n\
            H = pose(rot_z(Q), [Q.x, Q.y, 0]);";
        assert_eq!(units(planar).0, ["rad", "m", "m"]);
        assert_eq!(units(planar).1, ["rad/s", "m/s", "m/s"]);
        let mixed = "config R: S1, d: R1; local turn, slide;\n\
            Phi = [R.c * cos(phi.turn) - R.s * sin(phi.turn), R.s * cos(phi.turn) + R.c * sin(phi.turn)], d + phi.slide;\n\
            H = rot_z(R) * trans_z(d);";
        assert_eq!(units(mixed).0, ["rad", "m"]);
    }

    #[test]
    fn velocities_of_a_declared_map_have_the_units_of_their_twists() {
        // v is the two rates in the other order.
        let own =
            "config a: R1, b: R1; H = rot_z(a) * trans_z(b); X = [O(2, 2); 0, 1; O(2, 2); 1, 0];";
        assert_eq!(units(own).0, ["rad", "m"]);
        assert_eq!(units(own).1, ["m/s", "rad/s"]);
        // Half of a rate is a rate.
        let double = "config a: R1; H = rot_z(a); X = [0; 0; 2; 0; 0; 0];";
        assert_eq!(units(double).1, ["rad/s"]);
    }

    #[test]
    fn a_coordinate_without_angle_or_length_is_a_number() {
        let spiral = "(length: m > 0) { config t: R1; H = trans([length * t, length * t * t, length * pow(t, 3)]); }";
        assert_eq!(of_freedoms(&joint(spiral)), ["1"]);
        assert_eq!(of_velocities(&joint(spiral)), ["1/s"]);
    }

    /// v of a linkage along the cross product of its relations, in metres, is a rate of turn over an area.
    #[test]
    fn a_velocity_along_relations_has_the_unit_of_its_scale() {
        let four_bar = include_str!("../../../../joint-specs/four_bar.joint");
        let four_bar = derive(four_bar, "four_bar").unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(of_velocities(&four_bar), ["1/(m^2 s)"]);
    }

    #[test]
    fn speeds_of_a_derived_basis_have_the_units_of_their_velocities() {
        let cart = "config Q: SE2; basis turn, forward, sideways of se2; velocity in child;
            H = pose(rot_z(Q), [Q.x, Q.y, 0]); A = [0; 0; 1]; speeds turn, forward;";
        let cart = joint(&format!(" {{ {cart} }}"));
        assert_eq!(of_speed_rates(&cart), ["rad/s", "m/s"]);
    }
}
