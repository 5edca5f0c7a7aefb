//! Values of a joint's parameters: at and near the ends of their ranges, large and small, on every side of what is required of them, and
//! where the functions in the kernels change sign or turn.

use super::critical::critical;
use crate::accuracy::exact;
use hamel_codegen::expr::{Expr, Symbol};
use hamel_codegen::model::{End, Interval, JointSpec};
use num_traits::ToPrimitive;

/// Decimal exponents of distances from a finite end, or from 0.
const SMALLEST: i32 = -12;
const LARGEST: i32 = 12;
/// Decades are halved: 10^(n/2).
const STEP: f64 = 0.5;

/// One parameter varied from a start that is allowed, the others kept.
pub(super) struct Axis<'a> {
    pub spec: &'a JointSpec,
    pub start: &'a [f64],
    pub index: usize,
}

fn powers() -> Vec<f64> {
    (SMALLEST..=LARGEST)
        .map(|n| 10f64.powf(STEP * f64::from(n)))
        .collect()
}

/// Values inside a range in rising order, its ends among them where they belong to it.
fn inside(range: &Interval) -> Vec<f64> {
    let value = |end: &Option<End>| {
        end.as_ref()
            .map(|end| (end.value.to_f64().unwrap_or(f64::NAN), end.included))
    };
    let powers = powers();
    let mut values: Vec<f64> = match (value(&range.lower), value(&range.upper)) {
        (None, None) => powers.iter().flat_map(|x| [-x, *x]).collect(),
        (Some((lower, _)), None) => powers.iter().map(|x| lower + x).collect(),
        (None, Some((upper, _))) => powers.iter().map(|x| upper - x).collect(),
        (Some((lower, _)), Some((upper, _))) => {
            let half = 0.5 * (upper - lower);
            let small = powers.iter().filter(|x| **x < 1.0);
            small
                .flat_map(|x| [lower + half * x, upper - half * x])
                .chain([lower + half])
                .collect()
        }
    };
    let ends = [value(&range.lower), value(&range.upper)];
    values.extend(
        ends.into_iter()
            .flatten()
            .filter(|(_, included)| *included)
            .map(|(x, _)| x),
    );
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

fn value_of(expression: &Expr, spec: &JointSpec, values: &[f64]) -> f64 {
    let of = |symbol: &Symbol| {
        let place = spec.parameters.iter().position(|p| p.symbol == *symbol);
        place.map_or(f64::NAN, |place| values[place])
    };
    expression.evaluate(&0.0, &of)
}

/// Whether the values are within all ranges and requirements.
pub(super) fn allowed(spec: &JointSpec, values: &[f64]) -> bool {
    let within = spec
        .parameters
        .iter()
        .zip(values)
        .all(|(parameter, value)| {
            let zero = *value == 0.0 && !parameter.may_vanish();
            value.is_finite() && !zero && parameter.range.contains(&exact(*value))
        });
    let required = spec.requirements.iter();
    within
        && required
            .map(|r| value_of(&r.value.value, spec, values))
            .all(|x| x > 0.0)
}

impl Axis<'_> {
    fn with(&self, value: f64) -> Vec<f64> {
        let mut values = self.start.to_vec();
        values[self.index] = value;
        values
    }

    /// The sets of values along this axis: both ends of each stretch that is allowed, its middle, and places where something
    /// changes. `notes` tells the arguments of functions in the kernels for values of the parameters.
    pub fn sets(&self, notes: &mut dyn FnMut(&[f64]) -> Vec<f64>, most: usize) -> Vec<Vec<f64>> {
        let samples = inside(&self.spec.parameters[self.index].range);
        let required = |values: &[f64]| {
            let all = self.spec.requirements.iter();
            all.map(|r| value_of(&r.value.value, self.spec, values))
                .collect::<Vec<f64>>()
        };
        let mut functions = |t: f64| {
            let values = self.with(t);
            [required(&values), notes(&values)].concat()
        };
        let found = critical(&samples, &mut functions, most);
        let changes: Vec<f64> = found
            .iter()
            .flat_map(|c| [c.at - c.width, c.at, c.at + c.width])
            .collect();
        let mut all = [samples, changes.clone()].concat();
        all.sort_by(f64::total_cmp);
        let stretches = all.split(|t| !allowed(self.spec, &self.with(*t)));
        let ends = stretches
            .filter(|s| !s.is_empty())
            .flat_map(|s| [s[0], s[s.len() / 2], s[s.len() - 1]]);
        let ends: Vec<f64> = ends.collect();
        let mut values: Vec<f64> = ends.into_iter().chain(changes).collect();
        let mut seen = std::collections::BTreeSet::new();
        values.retain(|x| seen.insert(x.to_bits()));
        let sets = values.into_iter().map(|t| self.with(t));
        sets.filter(|values| allowed(self.spec, values)).collect()
    }
}
