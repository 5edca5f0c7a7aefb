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
    sign: impl Fn(T) -> T + Copy,
) {
    let [from, to] = meeting.columns;
    let count = to - from;
    let row = &mut rows[meeting.row * width + from..];
    let Some(entries) = row.get_mut(..count + EIGHT) else {
        meet_last(own, columns, meeting.others, &mut row[..count], sign);
        return;
    };
    let blocks = count.div_ceil(EIGHT);
    let components: [&[[T; EIGHT]]; N] =
        core::array::from_fn(|i| columns.blocks(meeting.others, i, blocks));
    for (place, block) in entries.as_chunks_mut::<EIGHT>().0[..blocks]
        .iter_mut()
        .enumerate()
    {
        let numbers: [&[T; EIGHT]; N] = core::array::from_fn(|i| &components[i][place]);
        *block = core::array::from_fn(|column| {
            let mut sum = own[0] * numbers[0][column];
            for i in 1..N {
                sum = own[i].mul_add(numbers[i][column], sum);
            }
            sign(sum)
        });
    }
    if let Some(behind) = entries.last_chunk_mut::<EIGHT>() {
        *behind = [T::zero(); EIGHT];
    }
}

/// Assigns the entries of a meeting one by one: those in the last row, behind which there are no eight.
#[cold]
#[inline(never)]
fn meet_last<T: Scalar, const N: usize>(
    own: &[T; N],
    columns: Columns<'_, T>,
    others: usize,
    entries: &mut [T],
    sign: impl Fn(T) -> T,
) {
    for (column, entry) in entries.iter_mut().enumerate() {
        let number = |i| columns.work[others + column + columns.stride * i];
        let products = own.iter().enumerate().skip(1);
        let sum = products.fold(own[0] * number(0), |sum, (i, own)| {
            own.mul_add(number(i), sum)
        });
        *entry = sign(sum);
    }
}

impl<'a, T> Columns<'a, T> {
    /// A component of columns from one on, eight columns a block.
    #[inline(always)]
    fn blocks(&self, others: usize, component: usize, blocks: usize) -> &'a [[T; EIGHT]] {
        let numbers = &self.work[others + self.stride * component..][..blocks * EIGHT];
        numbers.as_chunks().0
    }
}
