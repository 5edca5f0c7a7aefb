//! Mass matrices, their inverses and derivatives of eight states side by side, pair by pair of joints: what [`Pairs`] makes of the numbers of one state.
//!
//! Each number in `work` and in the results is that of eight states. So loops need no eight entries of a row at once: rows have the lengths of the tree, and
//! right-hand sides their zeros. `simd` are the registers of a level of instructions; functions that take it are inlined into that of the level.

use super::meeting::{NINE, SIX};
use super::{Meeting, Pairs};
use crate::LANES;
use crate::instructions::Registers;
use crate::layout::Lanes;

/// Columns that are solved for at once: what the registers of AVX2 hold. Rows have as many at least.
pub const STRIP: usize = 6;

/// Columns beside each other that are solved for at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strip<'a> {
    /// From the first to behind the last.
    pub columns: [usize; 2],
    /// Rows where they are not 0 once the rows below are eliminated, the last first, in ranges from the first to behind the last.
    pub rows: &'a [[usize; 2]],
    /// Behind the last row that is found.
    pub end: usize,
}

/// Numbers that the factors of M̄ take, of so many speeds.
#[must_use]
pub const fn room_in_lanes(size: usize) -> usize {
    size * size
}

impl Pairs<'_> {
    /// M̄ by rows, from the numbers of the bodies.
    #[inline(always)]
    pub fn mass_in_lanes(&self, simd: impl Registers, work: &[Lanes], matrix: &mut [Lanes]) {
        let size = self.size();
        matrix[..size * size].fill(Lanes::ZERO);
        self.meet_masses(simd, work, matrix);
        for row in 0..size {
            for column in 0..row {
                matrix[column * size + row] = matrix[row * size + column];
            }
        }
    }

    /// M̄⁻¹ by rows. `factors` are as many zeros as [`room_in_lanes`] says.
    #[inline(always)]
    pub fn inverse_mass_in_lanes(
        &self,
        simd: impl Registers,
        strips: &[Strip<'_>],
        work: &[Lanes],
        factors: &mut [Lanes],
        rows: &mut [Lanes],
    ) {
        let size = self.size();
        rows[..size * size].fill(Lanes::ZERO);
        for speed in 0..size {
            rows[speed * size + speed] = Lanes([1.0; LANES]);
        }
        self.solve_in_lanes(simd, strips, (work, factors), (rows, size));
    }

    /// Rows of derivatives of inverse dynamics: in all degrees of freedom, then in all speeds.
    #[inline(always)]
    pub fn inverse_in_lanes(&self, simd: impl Registers, work: &[Lanes], rows: &mut [Lanes]) {
        let width = self.places.width();
        rows[..self.size() * width].fill(Lanes::ZERO);
        self.meet_slopes(simd, work, (rows, width), 1.0);
    }

    /// Rows of derivatives of forward dynamics, as many numbers each as is said behind them: in all degrees of freedom, in all speeds, in all efforts, and the
    /// rates. `factors` are as many zeros as [`room_in_lanes`] says.
    #[inline(always)]
    pub fn forward_in_lanes(
        &self,
        simd: impl Registers,
        strips: &[Strip<'_>],
        work: &[Lanes],
        factors: &mut [Lanes],
        (rows, width): (&mut [Lanes], usize),
    ) {
        rows[..self.size() * width].fill(Lanes::ZERO);
        self.meet_slopes(simd, work, (rows, width), -1.0);
        self.solve_in_lanes(simd, strips, (work, factors), (rows, width));
        for &[row, column, place] in self.followed {
            add(simd, &mut rows[row * width + column], &work[place], 1.0);
        }
    }

    /// M̄ on and left of the diagonal, beside zeros.
    #[inline(always)]
    fn meet_masses(&self, simd: impl Registers, work: &[Lanes], matrix: &mut [Lanes]) {
        let (size, apart) = (self.size(), self.places.column_stride());
        for meeting in self.moved {
            let own = own::<_, SIX>(simd, (work, meeting.own), 1, simd.all(1.0));
            meet(simd, (meeting, own), (work, apart), (matrix, size));
        }
        for &[row, column, place] in self.masses {
            add(simd, &mut matrix[row * size + column], &work[place], 1.0);
        }
    }

    /// Slopes of inverse dynamics times `sign`, beside zeros; what stands behind them in a row is no slope.
    #[inline(always)]
    fn meet_slopes(
        &self,
        simd: impl Registers,
        work: &[Lanes],
        (rows, width): (&mut [Lanes], usize),
        sign: f64,
    ) {
        let (slopes, signs) = (self.places.width(), simd.all(sign));
        for meeting in self.slopes {
            let from = (work, meeting.own);
            if meeting.is_momentum {
                let own = own::<_, NINE>(simd, from, 1, signs);
                let varied = (work, self.places.variation_stride());
                meet(simd, (meeting, own), varied, (rows, width));
            } else {
                let own = own::<_, SIX>(simd, from, self.places.column_stride(), signs);
                meet(simd, (meeting, own), (work, slopes), (rows, width));
            }
        }
        for &[row, column, place] in self.entries {
            let sign = if column < slopes { sign } else { 1.0 };
            add(simd, &mut rows[row * width + column], &work[place], sign);
        }
    }

    /// M̄⁻¹ times the columns of the strips.
    #[inline(always)]
    fn solve_in_lanes(
        &self,
        simd: impl Registers,
        strips: &[Strip<'_>],
        (work, factors): (&[Lanes], &mut [Lanes]),
        (rows, width): (&mut [Lanes], usize),
    ) {
        let size = self.size();
        let factors = &mut factors[..size * size];
        self.meet_masses(simd, work, factors);
        self.factorise_in_lanes(simd, factors);
        for strip in strips {
            self.eliminate_in_lanes(simd, strip, factors, (rows, width));
            self.substitute_in_lanes(simd, strip, factors, (rows, width));
        }
        if let Some(first) = self.mirrored {
            for row in 0..size {
                for column in 0..row {
                    rows[row * width + first + column] = rows[column * width + first + row];
                }
            }
        }
    }

    /// `M̄ = LᵀDL`: L left of the diagonal, D⁻¹ on it.
    #[inline(always)]
    fn factorise_in_lanes(&self, simd: impl Registers, factors: &mut [Lanes]) {
        let size = self.size();
        let negative = simd.all(-1.0);
        for i in (0..size).rev() {
            let (above, below) = factors.split_at_mut((i + 1) * size);
            let own = &mut above[i * size..];
            for &[first, last] in self.below[i] {
                for k in (first..last).rev() {
                    let row = &below[(k - i - 1) * size..][..size];
                    let factor = simd.times(simd.read(&row[i]), simd.read(&row[k]));
                    let factor = simd.times(factor, negative);
                    add_product(simd, &mut own[i], factor, &row[i]);
                    for &[from, to] in self.above[i] {
                        for (own, other) in own[from..to].iter_mut().zip(&row[from..to]) {
                            add_product(simd, own, factor, other);
                        }
                    }
                }
            }
            let inverse = simd.reciprocal(simd.read(&own[i]));
            simd.write(inverse, &mut own[i]);
        }
        for (k, row) in factors.chunks_exact_mut(size.max(1)).enumerate() {
            let inverse = simd.read(&row[k]);
            for &[from, to] in self.above[k] {
                for entry in &mut row[from..to] {
                    simd.write(simd.times(simd.read(entry), inverse), entry);
                }
            }
        }
    }

    /// L⁻ᵀ times the columns of a strip, from the leaves to the root.
    #[inline(always)]
    fn eliminate_in_lanes(
        &self,
        simd: impl Registers,
        strip: &Strip<'_>,
        factors: &[Lanes],
        (rows, width): (&mut [Lanes], usize),
    ) {
        let (size, start) = (self.size(), strip.start(width));
        for &[first, last] in strip.rows {
            for i in (first..last).rev() {
                let mut own = read(simd, entries(rows, i * width + start));
                for &[first, last] in self.below[i] {
                    for &[least, most] in strip.rows {
                        for k in (first.max(least)..last.min(most)).rev() {
                            let other = entries(rows, k * width + start);
                            less(simd, &mut own, &factors[k * size + i], other);
                        }
                    }
                }
                strip.write(simd, own, (rows, i * width), start);
            }
        }
    }

    /// L⁻¹D⁻¹ times the same, from the root to the leaves.
    #[inline(always)]
    fn substitute_in_lanes(
        &self,
        simd: impl Registers,
        strip: &Strip<'_>,
        factors: &[Lanes],
        (rows, width): (&mut [Lanes], usize),
    ) {
        let (size, start) = (self.size(), strip.start(width));
        for k in 0..strip.end {
            let factors = &factors[k * size..][..size];
            let inverse = simd.read(&factors[k]);
            let mut own = read(simd, entries(rows, k * width + start));
            for own in &mut own {
                *own = simd.times(*own, inverse);
            }
            for &[first, last] in self.above[k] {
                for i in (first..last).rev() {
                    less(
                        simd,
                        &mut own,
                        &factors[i],
                        entries(rows, i * width + start),
                    );
                }
            }
            strip.write(simd, own, (rows, k * width), start);
        }
    }
}

impl Strip<'_> {
    /// The first of as many columns as registers hold, these among them. What stands in the others is computed with, and left as it is.
    #[inline(always)]
    fn start(&self, width: usize) -> usize {
        self.columns[0].min(width.saturating_sub(STRIP))
    }

    /// Assigns the entries in a row that begins at this place, of those from the column `start` on.
    #[inline(always)]
    fn write<I: Registers>(
        &self,
        simd: I,
        own: [I::Eight; STRIP],
        (rows, place): (&mut [Lanes], usize),
        start: usize,
    ) {
        let [from, to] = self.columns;
        let entries = &mut rows[place + from..place + to];
        if let Some(entries) = entries.first_chunk_mut::<STRIP>() {
            write(simd, own, entries);
        } else {
            let mut all = [Lanes::ZERO; STRIP];
            write(simd, own, &mut all);
            entries.copy_from_slice(&all[from - start..to - start]);
        }
    }
}

/// As many entries from a place on as registers hold.
#[inline(always)]
fn entries(rows: &[Lanes], place: usize) -> &[Lanes; STRIP] {
    const NONE: [Lanes; STRIP] = [Lanes::ZERO; STRIP];
    rows.get(place..)
        .and_then(<[Lanes]>::first_chunk)
        .unwrap_or(&NONE)
}

#[inline(always)]
fn read<I: Registers>(simd: I, entries: &[Lanes; STRIP]) -> [I::Eight; STRIP] {
    let mut own = [simd.all(0.0); STRIP];
    for (own, entry) in own.iter_mut().zip(entries) {
        *own = simd.read(entry);
    }
    own
}

#[inline(always)]
fn write<I: Registers>(simd: I, own: [I::Eight; STRIP], entries: &mut [Lanes; STRIP]) {
    for (eight, entry) in own.into_iter().zip(entries) {
        simd.write(eight, entry);
    }
}

/// Assigns the entries of a meeting: products of a row's own numbers with those of columns, whose components are `apart`.
#[inline(always)]
fn meet<I: Registers, const N: usize>(
    simd: I,
    (meeting, own): (&Meeting, [I::Eight; N]),
    (work, apart): (&[Lanes], usize),
    (rows, width): (&mut [Lanes], usize),
) {
    let [from, to] = meeting.columns;
    let row = &mut rows[meeting.row * width + from..meeting.row * width + to];
    for (column, entry) in row.iter_mut().enumerate() {
        let place = meeting.others + column;
        let mut sum = simd.times(own[0], simd.read(&work[place]));
        for i in 1..N {
            sum = simd.mul_add(own[i], simd.read(&work[place + apart * i]), sum);
        }
        simd.write(sum, entry);
    }
}

/// Numbers `apart` from a place on, times a sign.
///
/// A loop, as others here: what calls functions of a level must be inlined, which closures that other functions take are not for sure.
#[inline(always)]
fn own<I: Registers, const N: usize>(
    simd: I,
    (work, place): (&[Lanes], usize),
    apart: usize,
    sign: I::Eight,
) -> [I::Eight; N] {
    let mut own = [sign; N];
    for (i, number) in own.iter_mut().enumerate() {
        *number = simd.times(simd.read(&work[place + apart * i]), sign);
    }
    own
}

#[inline(always)]
fn less<I: Registers>(
    simd: I,
    sums: &mut [I::Eight; STRIP],
    factor: &Lanes,
    others: &[Lanes; STRIP],
) {
    let factor = simd.times(simd.read(factor), simd.all(-1.0));
    for (sum, other) in sums.iter_mut().zip(others) {
        *sum = simd.mul_add(factor, simd.read(other), *sum);
    }
}

#[inline(always)]
fn add(simd: impl Registers, entry: &mut Lanes, number: &Lanes, sign: f64) {
    add_product(simd, entry, simd.all(sign), number);
}

#[inline(always)]
fn add_product<I: Registers>(simd: I, entry: &mut Lanes, factor: I::Eight, number: &Lanes) {
    let sum = simd.mul_add(factor, simd.read(number), simd.read(entry));
    simd.write(sum, entry);
}
