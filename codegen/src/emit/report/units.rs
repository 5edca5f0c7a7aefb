//! Units of the freedoms: angles or lengths, as far as the spec determines them.

use crate::derived::{Derived, KernelKind};
use crate::expr::Expr;
use crate::manifold::Kind;
use crate::model::Freedom;

/// The unit of each local coordinate: `rad`, `m`, or that of the coordinate where it is neither for certain.
pub fn of_freedoms(derived: &Derived) -> Vec<&'static str> {
    let freedoms = derived.spec.freedoms.value.iter().enumerate();
    freedoms
        .map(|(k, freedom)| unit(derived, k, freedom))
        .collect()
}

/// The unit of a rate.
pub fn per_second(unit: &str) -> String {
    match unit {
        "" => "1/s".to_owned(),
        unit => format!("{unit}/s"),
    }
}

fn unit(derived: &Derived, k: usize, freedom: &Freedom) -> &'static str {
    let Some(factor) = derived.spec.manifold.value.factors().get(freedom.factor) else {
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
        Kind::S1 | Kind::So2 | Kind::So3 | Kind::S3 | Kind::S2 => "rad",
        Kind::Se2 => angle_if(turns(1)),
        Kind::Se3 => angle_if(turns(3)),
        Kind::Real(_) => of_path(derived, k),
    }
}

/// A path coordinate is an angle or a length where its twist is a unit rotation or a unit translation.
fn of_path(derived: &Derived, k: usize) -> &'static str {
    let Some(twist_map) = derived
        .kernel(KernelKind::TwistMapChild)
        .and_then(|kernel| kernel.outputs.first())
    else {
        return "";
    };
    if twist_map.columns() <= k {
        return "";
    }
    let column = twist_map.column(k);
    let is_unit = |part: &[Expr]| {
        let square: Expr = part.iter().map(Expr::square).sum();
        derived
            .spec
            .manifold
            .value
            .ideal()
            .normal_form(&square)
            .is_one()
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
