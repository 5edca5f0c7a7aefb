//! Entries beside each other of a row, each the product of the row's own numbers with those of a column.

use hamel_runtime::scalar::Scalar;

/// Columns beside each other in which a row has products of its own six or nine numbers with those of each column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Meeting {
    /// The row.
    pub row: usize,
    /// Its columns: from the first to behind the last.
    pub columns: [usize; 2],
    /// Where the first of the row's own numbers stands in `work`.
    pub own: usize,
    /// Where the first number of the first column stands.
    pub others: usize,
    /// Whether the row's own numbers are a momentum.
    pub is_momentum: bool,
}

/// Numbers of a twist or wrench, and of what a unit or a speed has beside it.
pub(super) const SIX: usize = 6;
pub(super) const NINE: usize = 9;

/// Columns that are found at once.
const EIGHT: usize = 8;

/// Numbers behind those of bodies that are read with them, and not used.
pub const BEHIND: usize = EIGHT - 1;

/// Numbers of columns, and how far apart their components are.
#[derive(Clone, Copy)]
pub(super) struct Columns<'a, T> {
    pub(super) work: &'a [T],
    pub(super) stride: usize,
}

/// Assigns the entries of a meeting in rows of `width`, eight at once, and 0 to the eight behind them: meetings come in the order of their entries.
#[inline(always)]
pub(super) fn meet<T: Scalar, const N: usize>(
    meeting: &Meeting,
    own: &[T; N],
    columns: Columns<'_, T>,
    (rows, width): (&mut [T], usize),
    sign: impl Fn(T) -> T,
) {
    let [from, to] = meeting.columns;
    let row = &mut rows[meeting.row * width + from..];
    for place in (0..to - from).step_by(EIGHT) {
        let others = meeting.others + place;
        eight(&mut row[place..], |entries| {
            products(own, columns, others, entries, &sign)
        });
    }
    eight(&mut row[to - from..], |entries| {
        *entries = [T::zero(); EIGHT]
    });
}

/// Products of a row's own numbers with those of eight columns.
#[inline(always)]
fn products<T: Scalar, const N: usize>(
    own: &[T; N],
    Columns { work, stride }: Columns<'_, T>,
    others: usize,
    entries: &mut [T; EIGHT],
    sign: impl Fn(T) -> T,
) {
    let components: [&[T; EIGHT]; N] =
        core::array::from_fn(|i| super::numbers(work, others + stride * i));
    for (column, entry) in entries.iter_mut().enumerate() {
        let mut sum = own[0] * components[0][column];
        for i in 1..N {
            sum = own[i].mul_add(components[i][column], sum);
        }
        *entry = sign(sum);
    }
}

/// Assigns the first eight entries, or as many as there are.
#[inline(always)]
fn eight<T: Scalar>(row: &mut [T], assign: impl Fn(&mut [T; EIGHT])) {
    match row.first_chunk_mut() {
        Some(entries) => assign(entries),
        None => {
            let mut entries = [T::zero(); EIGHT];
            assign(&mut entries);
            row.copy_from_slice(&entries[..row.len()]);
        }
    }
}
