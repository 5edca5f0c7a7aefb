//! Postures from which loops are closed that a file says nothing about.

use super::newton::Loops;
use hamel_runtime::joint::MOST_LINKS;
use std::f64::consts::PI;

/// Guesses from which a loop is looked for. Nearer ones come first.
pub(super) const GUESSES: u32 = 128;

/// Multiples of the roots of primes fill a box evenly, as no sum of whole multiples of them is whole.
const PRIMES: [f64; MOST_LINKS] = [
    2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0, 41.0, 43.0, 47.0, 53.0,
];

/// A configuration on all ties that `is_sound` takes, from guesses around `home` that lie ever farther from it, up to half a turn and the length of the linkage.
pub(super) fn posture(
    loops: &Loops<'_>,
    home: &[f64],
    free: &[bool],
    is_sound: impl Fn(&[f64]) -> bool,
) -> Option<Vec<f64>> {
    (1..=GUESSES).find_map(|number| {
        let reach = f64::from(number) / f64::from(GUESSES);
        let guess = home.iter().zip(PRIMES).enumerate().map(|(k, (at, prime))| {
            let part = 2.0 * (f64::from(number) * prime.sqrt()).fract() - 1.0;
            let most = if loops.slides(k) { loops.length } else { PI };
            match free[k] {
                true => at + part * reach * most,
                false => *at,
            }
        });
        let guess: Vec<f64> = guess.collect();
        let found = loops.closed(&guess, free).ok()?;
        is_sound(&found).then(|| near(loops, found))
    })
}

/// The same posture with angles within half a turn.
fn near(loops: &Loops<'_>, found: Vec<f64>) -> Vec<f64> {
    let turn = 2.0 * PI;
    let entries = found.into_iter().enumerate();
    entries
        .map(|(k, value)| match loops.slides(k) {
            true => value,
            false => value - turn * (value / turn).round(),
        })
        .collect()
}
