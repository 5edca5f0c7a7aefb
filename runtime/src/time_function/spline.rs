//! Slopes at the knots of a cubic spline: the one with continuous second derivative, whose second derivative is 0 at both ends, or which repeats.

use alloc::vec;
use alloc::vec::Vec;

/// The slope at each knot. With `repeats` the last value is the first, and so are slope and second derivative.
pub(super) fn slopes(times: &[f64], values: &[f64], repeats: bool) -> Vec<f64> {
    let pieces: Vec<Piece> = times
        .windows(2)
        .zip(values.windows(2))
        .map(Piece::new)
        .collect();
    match (repeats, pieces.len()) {
        (_, 0) => vec![0.0; times.len()],
        (true, 1) => vec![0.0; 2],
        (true, _) => periodic(&pieces),
        (false, _) => natural(&pieces),
    }
}

/// One over the length of a piece, and its mean slope.
struct Piece {
    rate: f64,
    mean: f64,
}

impl Piece {
    fn new((times, values): (&[f64], &[f64])) -> Self {
        let rate = 1.0 / (times[1] - times[0]);
        Self {
            rate,
            mean: (values[1] - values[0]) * rate,
        }
    }
}

/// Rows `below · s_(i−1) + on · s_i + above · s_(i+1) = side`.
struct Row {
    below: f64,
    on: f64,
    above: f64,
    side: f64,
}

/// Between two pieces the second derivative is the same on both sides.
fn joined(before: &Piece, after: &Piece) -> Row {
    Row {
        below: before.rate,
        on: 2.0 * (before.rate + after.rate),
        above: after.rate,
        side: 3.0 * (before.rate * before.mean + after.rate * after.mean),
    }
}

fn natural(pieces: &[Piece]) -> Vec<f64> {
    let end = |piece: &Piece| Row {
        below: 1.0,
        on: 2.0,
        above: 1.0,
        side: 3.0 * piece.mean,
    };
    let inner = pieces.windows(2).map(|pair| joined(&pair[0], &pair[1]));
    let rows: Vec<Row> = core::iter::once(end(&pieces[0]))
        .chain(inner)
        .chain(pieces.last().map(end))
        .collect();
    let side: Vec<f64> = rows.iter().map(|row| row.side).collect();
    solve(&rows, side)
}

/// The last unknown is the first: what couples both is a matrix of rank one beside a tridiagonal one (Sherman and Morrison).
fn periodic(pieces: &[Piece]) -> Vec<f64> {
    let count = pieces.len();
    let mut rows: Vec<Row> = (0..count)
        .map(|i| joined(&pieces[(i + count - 1) % count], &pieces[i]))
        .collect();
    let (corner, other) = (rows[0].below, rows[count - 1].above);
    let gamma = -rows[0].on;
    rows[0].on -= gamma;
    rows[count - 1].on -= corner * other / gamma;
    let side: Vec<f64> = rows.iter().map(|row| row.side).collect();
    let found = solve(&rows, side);
    let mut column = vec![0.0; count];
    column[0] = gamma;
    column[count - 1] += other;
    let moved = solve(&rows, column);
    let along = |x: &[f64]| x[0] + corner / gamma * x[count - 1];
    let factor = along(&found) / (1.0 + along(&moved));
    let pairs = found.iter().zip(&moved);
    let mut slopes: Vec<f64> = pairs.map(|(x, z)| x - factor * z).collect();
    slopes.push(slopes[0]);
    slopes
}

/// Elimination without pivoting: each row's diagonal entry outweighs the others.
fn solve(rows: &[Row], mut side: Vec<f64>) -> Vec<f64> {
    let mut above = vec![0.0; rows.len()];
    let mut last: Option<(f64, f64)> = None;
    for ((row, side), above) in rows.iter().zip(&mut side).zip(&mut above) {
        let (lessened, moved) = last.map_or((0.0, 0.0), |(above, side)| {
            (row.below * above, row.below * side)
        });
        let pivot = row.on - lessened;
        *above = row.above / pivot;
        *side = (*side - moved) / pivot;
        last = Some((*above, *side));
    }
    let mut next = 0.0;
    for (side, above) in side.iter_mut().zip(&above).rev() {
        *side -= above * next;
        next = *side;
    }
    side
}
