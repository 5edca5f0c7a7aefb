//! Points of a joint: parameters and configurations that lie on the manifold exactly, enclosed to any precision.

use super::ball::Ball;
use hamel_codegen::manifold::Kind;
use hamel_codegen::model::ConfigurationSpace;

/// Doubles from which a point is made: they name it at every precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The parameters, in order.
    pub parameters: Vec<f64>,
    /// One double for each dimension of each factor: real coordinates as they are, all others stereographically.
    pub chart: Vec<f64>,
}

/// How many doubles the chart of a factor has.
fn chart_size(kind: Kind, scalars: usize) -> usize {
    match kind {
        Kind::Real(_) => scalars,
        other => other.dimension(),
    }
}

/// Doubles in the chart of a joint.
pub fn dimensions(space: &ConfigurationSpace) -> usize {
    let factors = space.manifold.factors().iter();
    factors
        .map(|f| chart_size(f.kind, f.coordinates.len()))
        .sum()
}

impl Point {
    /// The parameters.
    pub fn parameters(&self) -> Vec<Ball> {
        self.parameters.iter().map(|x| Ball::exact(*x)).collect()
    }

    /// The stored scalars. Real factors on which a relation holds are divided by their norm: what is declared may then be a sphere of
    /// radius 1; whether a point meets all relations is seen where the domain is.
    pub fn configuration(&self, space: &ConfigurationSpace) -> Vec<Ball> {
        let manifold = &space.manifold;
        let mut rest = self.chart.iter().map(|x| Ball::exact(*x));
        let factors = manifold.factors().iter().flat_map(|factor| {
            let count = chart_size(factor.kind, factor.coordinates.len());
            let chart: Vec<Ball> = rest.by_ref().take(count).collect();
            let related = manifold.declared().iter().any(|relation| {
                let symbols = relation.symbols();
                factor.coordinates.iter().any(|q| symbols.contains(q))
            });
            element(factor.kind, &chart, related)
        });
        factors.collect()
    }
}

fn element(kind: Kind, chart: &[Ball], related: bool) -> Vec<Ball> {
    match kind {
        Kind::Real(_) if related => {
            let square = chart
                .iter()
                .fold(Ball::zero(), |sum, x| sum.plus(&x.times(x)));
            let norm = square.sqrt();
            chart.iter().map(|x| x.over(&norm)).collect()
        }
        Kind::Real(_) => chart.to_vec(),
        Kind::S1 | Kind::S2 | Kind::S3 => stereographic(chart),
        Kind::So2 => planar(&stereographic(chart), &[]),
        Kind::Se2 => planar(&stereographic(&chart[..1]), &chart[1..]),
        Kind::So3 => rotation(&stereographic(chart), &[]),
        Kind::Se3 => rotation(&stereographic(&chart[..3]), &chart[3..]),
    }
}

/// The point of the unit sphere over a point of its equator plane: (1 − |x|², 2x) / (1 + |x|²), the pole first.
fn stereographic(chart: &[Ball]) -> Vec<Ball> {
    let square = chart
        .iter()
        .fold(Ball::zero(), |sum, x| sum.plus(&x.times(x)));
    let scale = Ball::one().plus(&square).reciprocal();
    let pole = Ball::one().minus(&square).times(&scale);
    let two = Ball::exact(2.0);
    let others = chart.iter().map(|x| x.times(&two).times(&scale));
    std::iter::once(pole).chain(others).collect()
}

fn bordered(size: usize, turn: &[Ball], shift: &[Ball]) -> Vec<Ball> {
    let row = |i: usize| {
        turn[size * i..size * (i + 1)]
            .iter()
            .chain(shift.get(i))
            .cloned()
    };
    (0..size).flat_map(row).collect()
}

fn planar(unit: &[Ball], shift: &[Ball]) -> Vec<Ball> {
    let (c, s) = (&unit[0], &unit[1]);
    bordered(2, &[c.clone(), s.negative(), s.clone(), c.clone()], shift)
}

/// The rotation matrix of a unit quaternion.
fn rotation(q: &[Ball], shift: &[Ball]) -> Vec<Ball> {
    let two = Ball::exact(2.0);
    let product = |a: usize, b: usize| q[a].times(&q[b]).times(&two);
    let diagonal = |a: usize, b: usize| Ball::one().minus(&product(a, a)).minus(&product(b, b));
    let plus = |a, b, c, d| product(a, b).plus(&product(c, d));
    let minus = |a, b, c, d| product(a, b).minus(&product(c, d));
    let entries = [
        diagonal(2, 3),
        minus(1, 2, 0, 3),
        plus(1, 3, 0, 2),
        plus(1, 2, 0, 3),
        diagonal(1, 3),
        minus(2, 3, 0, 1),
        minus(1, 3, 0, 2),
        plus(2, 3, 0, 1),
        diagonal(1, 2),
    ];
    bordered(3, &entries, shift)
}
