//! Units of the freedoms: angles or lengths, as far as the spec determines them.

use crate::derived::{Derived, KernelKind};
use crate::expr::{Expr, budget};
use crate::manifold::Kind;
use crate::matrix::Matrix;
use crate::model::{Freedom, VelocityFrame};

/// Most term operations to find out whether the columns of a twist map have length 1. Squares of entries with a thousand terms take a minute;
/// a joint with such entries turns or slides along no fixed axis.
const UNIT_WORK: u64 = 10_000;

/// The unit of each local coordinate: `rad` or `m`; empty where it is neither for certain.
pub fn of_freedoms(derived: &Derived) -> Vec<&'static str> {
    let freedoms = derived.spec.freedoms.value.iter().enumerate();
    freedoms
        .map(|(k, freedom)| unit(derived, k, freedom))
        .collect()
}

/// The unit of each v: that of ϕ̇, or, where a declared X makes it something else, that of a unit twist; empty where neither tells.
pub fn of_velocities(derived: &Derived) -> Vec<String> {
    let spec = &derived.spec;
    let is_declared = spec.twist_map.is_some() && spec.velocity.value == VelocityFrame::Rates;
    let of_freedoms = of_freedoms(derived).into_iter().enumerate();
    of_freedoms
        .map(|(k, unit)| match is_declared && !is_rate(derived, k) {
            true => per_second(of_twist(derived, twist_map(derived), k)),
            false => per_second(unit),
        })
        .collect()
}

/// X^c.
fn twist_map(derived: &Derived) -> Option<&Matrix> {
    let kernel = derived.kernel(KernelKind::TwistMapChild);
    kernel.and_then(|kernel| kernel.outputs.first())
}

/// The unit of a rate; empty where that of what changes is.
pub fn per_second(unit: &str) -> String {
    match unit {
        "" => String::new(),
        unit => format!("{unit}/s"),
    }
}

/// Whether v_k is the rate of ϕ_k: row k of S₀ is that of the identity.
fn is_rate(derived: &Derived, k: usize) -> bool {
    let velocity_map = derived.kernel(KernelKind::VelocityMap);
    let Some(s) = velocity_map.and_then(|kernel| kernel.outputs.first()) else {
        return false;
    };
    let mut columns = 0..s.columns();
    columns.all(|j| match j == k {
        true => s.at(k, j).is_one(),
        false => s.at(k, j).is_zero(),
    })
}

fn unit(derived: &Derived, k: usize, freedom: &Freedom) -> &'static str {
    let Some(factor) = derived.space.manifold.factors().get(freedom.factor) else {
        return "";
    };
    let turns = |count: usize| {
        freedom
            .generator
            .iter()
            .take(count)
            .any(|entry| !entry.is_zero())
    };
    let angle_if = |angle: bool| if angle { "rad" } else { "m" };
    match factor.kind {
        // A degree of freedom of `local` is what Φ makes of it.
        _ if freedom.generator.is_empty() => of_twists(derived, k),
        Kind::S1 | Kind::So2 | Kind::So3 | Kind::S3 | Kind::S2 => "rad",
        Kind::Se2 => angle_if(turns(1)),
        Kind::Se3 => angle_if(turns(3)),
        Kind::Real(_) => of_twists(derived, k),
    }
}

/// Of a coordinate by the first of the bodies whose twist tells.
fn of_twists(derived: &Derived, k: usize) -> &'static str {
    let bodies = derived.bodies();
    let mut units = bodies.map(|body| of_twist(body, Some(&body.local_twist_map), k));
    units.find(|unit| !unit.is_empty()).unwrap_or_default()
}

/// A coordinate is an angle or a length, and a velocity its rate, where its twist is a unit rotation or a unit translation.
fn of_twist(derived: &Derived, twist_map: Option<&Matrix>, k: usize) -> &'static str {
    let Some(twist_map) = twist_map else {
        return "";
    };
    if twist_map.columns() <= k {
        return "";
    }
    let column = twist_map.column(k);
    let ideal = derived.space.manifold.ideal();
    let is_unit = |part: &[Expr]| {
        let square = || -> Expr { part.iter().map(Expr::square).sum() };
        let unit = budget::scope(UNIT_WORK, || ideal.normal_form(&square()).is_one());
        unit.unwrap_or(false)
    };
    let (angular, linear) = column.split_at(3);
    match (
        is_unit(angular),
        angular.iter().all(Expr::is_zero) && is_unit(linear),
    ) {
        (true, _) => "rad",
        (_, true) => "m",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::{UNIT_WORK, of_freedoms, of_velocities};
    use crate::derive;
    use crate::expr::budget;

    fn units(declared: &str) -> (Vec<&'static str>, Vec<String>) {
        let source = format!("hamel = 1; joint test {{ {declared} }}");
        let joint = derive(&source, "test").unwrap_or_else(|errors| panic!("{errors}"));
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
        let double = "config a: R1; H = rot_z(a); X = [0; 0; 2; 0; 0; 0];";
        assert_eq!(units(double).0, ["rad"]);
        assert_eq!(units(double).1, [""]);
    }

    #[test]
    fn a_coordinate_of_neither_kind_has_no_unit() {
        assert_eq!(
            units("config a: R1; H = trans_z(a * a * a + a);"),
            (vec![""], vec![String::new()])
        );
    }

    /// The column of X^c has 210 terms in an entry: its square would take more work than finding the unit is worth.
    #[test]
    fn a_long_twist_is_no_unit_and_takes_little_work() {
        let source = "hamel = 1;
            joint bend(a: 1, b: 1, c: 1, d: 1) {
                config q: R1;
                H = trans([pow(a + b + c + d + q, 7), 0, q]);
            }";
        let derived = derive(source, "bend.joint").unwrap_or_else(|errors| panic!("{errors}"));
        let (units, work) = budget::measured(|| of_freedoms(&derived));
        assert_eq!(units, [""]);
        // One test of length each for the angular and the linear part.
        assert!(work <= 2 * UNIT_WORK, "{work} term operations");
    }
}
