//! The same of eight states side by side, by loops that take neither entries between branches nor columns beyond the last.
//!
//! Each number is that of eight states, so that nothing is gained by eight entries at once: rows have the lengths of the tree, and right-hand sides their zeros.

use super::meeting::{NINE, SIX};
use super::{Meeting, Pairs};
use crate::LANES;
use crate::instructions::Registers;
use crate::layout::Lanes;

/// Columns that are solved for at once: what the registers of AVX2 hold.
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

/// Numbers that solving with M̄ of so many speeds needs room for.
#[must_use]
pub const fn room_in_lanes(size: usize) -> usize {
    size * (size + STRIP)
}

impl Pairs<'_> {
    /// M̄ by rows.
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

    /// M̄⁻¹ by rows. `room` has what [`room_in_lanes`] says.
    #[inline(always)]
    pub fn inverse_mass_in_lanes(
        &self,
        simd: impl Registers,
        strips: &[Strip<'_>],
        work: &[Lanes],
        room: &mut [Lanes],
        rows: &mut [Lanes],
    ) {
        let size = self.size();
        self.clear(strips, rows, size);
        for speed in 0..size {
            rows[speed * size + speed] = Lanes([1.0; LANES]);
        }
        self.solve_in_lanes(simd, strips, (work, room), (rows, size));
    }

    /// Rows of derivatives of inverse dynamics: in all degrees of freedom, then in all speeds.
    #[inline(always)]
    pub fn inverse_in_lanes(&self, simd: impl Registers, work: &[Lanes], rows: &mut [Lanes]) {
        let width = self.places.width();
        rows[..self.size() * width].fill(Lanes::ZERO);
        self.meet_slopes(simd, work, (rows, width), 1.0);
    }

    /// Rows of derivatives of forward dynamics, as many numbers each as is said behind them: in all degrees of freedom, in all speeds, in all efforts, and the
    /// rates. `room` has what [`room_in_lanes`] says.
    #[inline(always)]
    pub fn forward_in_lanes(
        &self,
        simd: impl Registers,
        strips: &[Strip<'_>],
        work: &[Lanes],
        room: &mut [Lanes],
        (rows, width): (&mut [Lanes], usize),
    ) {
        self.clear(strips, rows, width);
        self.meet_slopes(simd, work, (rows, width), -1.0);
        self.solve_in_lanes(simd, strips, (work, room), (rows, width));
        for &[row, column, place] in self.followed {
            add(simd, &mut rows[row * width + column], &work[place], 1.0);
        }
    }

    /// Zeros wherever nothing is assigned, and where strips are solved.
    #[inline(always)]
    fn clear(&self, strips: &[Strip<'_>], rows: &mut [Lanes], width: usize) {
        let mut clear = |row: usize, from: usize, to: usize| {
            rows[row * width + from..row * width + to].fill(Lanes::ZERO);
        };
        for strip in strips {
            for &[first, last] in strip.rows {
                (first..last).for_each(|row| clear(row, strip.columns[0], strip.columns[1]));
            }
        }
        for row in 0..self.size() {
            let mut from = 0;
            for &[first, last] in self.columns {
                clear(row, from, first);
                from = last;
            }
            clear(row, from, width);
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
        (work, room): (&[Lanes], &mut [Lanes]),
        (rows, width): (&mut [Lanes], usize),
    ) {
        let size = self.size();
        let (factors, room) = room.split_at_mut(size * size);
        for row in 0..size {
            for &[from, to] in self.above[row] {
                factors[row * size + from..row * size + to].fill(Lanes::ZERO);
            }
            factors[row * size + row] = Lanes::ZERO;
        }
        self.meet_masses(simd, work, factors);
        self.factorise_in_lanes(simd, factors);
        for strip in strips {
            self.solve_strip_in_lanes(simd, strip, (factors, room), (rows, width));
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

    #[inline(always)]
    fn solve_strip_in_lanes(
        &self,
        simd: impl Registers,
        strip: &Strip<'_>,
        (factors, room): (&[Lanes], &mut [Lanes]),
        (rows, width): (&mut [Lanes], usize),
    ) {
        let size = self.size();
        let ([from, to], zero) = (strip.columns, simd.all(0.0));
        let room = &mut room.as_chunks_mut::<STRIP>().0[..strip.end];
        room.fill([Lanes::ZERO; STRIP]);
        // From the leaves to the root.
        for &[first, last] in strip.rows {
            for i in (first..last).rev() {
                let mut own = [zero; STRIP];
                let entries = &rows[i * width + from..i * width + to];
                for (own, entry) in own.iter_mut().zip(entries) {
                    *own = simd.read(entry);
                }
                for &[first, last] in self.below[i] {
                    for &[least, most] in strip.rows {
                        for k in (first.max(least)..last.min(most)).rev() {
                            less(simd, &mut own, &factors[k * size + i], &room[k]);
                        }
                    }
                }
                write(simd, own, &mut room[i]);
            }
        }
        // From the root to the leaves.
        for k in 0..strip.end {
            let row = &factors[k * size..][..size];
            let inverse = simd.read(&row[k]);
            let mut own = [zero; STRIP];
            for (own, given) in own.iter_mut().zip(&room[k]) {
                *own = simd.times(simd.read(given), inverse);
            }
            for &[first, last] in self.above[k] {
                for i in (first..last).rev() {
                    less(simd, &mut own, &row[i], &room[i]);
                }
            }
            write(simd, own, &mut room[k]);
            let entries = &mut rows[k * width + from..k * width + to];
            entries
                .iter_mut()
                .zip(room[k])
                .for_each(|(entry, own)| *entry = own);
        }
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
fn write<I: Registers>(simd: I, own: [I::Eight; STRIP], room: &mut [Lanes; STRIP]) {
    for (eight, place) in own.into_iter().zip(room) {
        simd.write(eight, place);
    }
}

#[inline(always)]
fn less<I: Registers>(
    simd: I,
    sums: &mut [I::Eight; STRIP],
    factor: &Lanes,
    from: &[Lanes; STRIP],
) {
    let factor = simd.times(simd.read(factor), simd.all(-1.0));
    for (sum, other) in sums.iter_mut().zip(from) {
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
