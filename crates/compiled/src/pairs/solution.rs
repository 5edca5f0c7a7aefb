//! Solutions with M̄, factorised along the tree.

use super::Pairs;
use hamel_runtime::scalar::Scalar;

/// Numbers that begin where a line of the cache begins.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Aligned<T, const N: usize>(pub [T; N]);

/// A matrix by rows: M̄, then its factors; right-hand sides, then what they are solved to.
pub(super) struct Rows<'a, T> {
    pub(super) entries: &'a mut [T],
    /// Numbers of a row: blocks of columns end within it.
    pub(super) stride: usize,
}

/// Columns that are solved for at once, at most: what registers hold.
const STRIP: usize = 48;
/// Columns of the smallest block.
const BLOCK: usize = 8;

/// Numbers of a row of so many columns.
const fn stride(columns: usize) -> usize {
    columns.next_multiple_of(BLOCK)
}

/// Numbers that solving with M̄ of so many speeds needs room for, with so many columns of right-hand sides.
#[must_use]
pub const fn room_to_solve(size: usize, columns: usize) -> usize {
    size * (stride(size) + stride(columns))
}

/// Calls a function with the number of columns of a strip as a constant.
macro_rules! with_columns {
    ($count:expr, $call:ident($($argument:expr),*)) => {
        match $count {
            0 => {}
            41.. => Self::$call::<T, STRIP>($($argument),*),
            33.. => Self::$call::<T, 40>($($argument),*),
            25.. => Self::$call::<T, 32>($($argument),*),
            17.. => Self::$call::<T, 24>($($argument),*),
            9.. => Self::$call::<T, 16>($($argument),*),
            _ => Self::$call::<T, BLOCK>($($argument),*),
        }
    };
}

impl Pairs<'_> {
    /// Room for M̄, and for so many columns that are solved for.
    pub(super) fn split<'r, T: Scalar>(
        &self,
        room: &'r mut [T],
        columns: usize,
    ) -> [Rows<'r, T>; 2] {
        let (size, [own, other]) = (self.size(), [self.size(), columns].map(stride));
        let (entries, sides) = room.split_at_mut(size * own);
        let sides = &mut sides[..size * other];
        [(entries, own), (sides, other)].map(|(entries, stride)| Rows { entries, stride })
    }

    /// Makes given rates known: what they take of others moves to the right-hand side.
    pub(super) fn hold<T: Scalar>(&self, matrix: &mut Rows<'_, T>, sides: &mut Rows<'_, T>) {
        let width = sides.stride;
        for &[speed, column] in self.held {
            for row in 0..self.size() {
                let place = row.max(speed) * matrix.stride + row.min(speed);
                sides.entries[row * width + column] = -matrix.entries[place];
            }
        }
        for &[speed, _] in self.held {
            sides.entries[speed * width..][..width].fill(T::zero());
        }
        for &[speed, column] in self.held {
            sides.entries[speed * width + column] = T::one();
        }
        self.fix(matrix);
    }

    /// Rates that are given depend on nothing.
    pub(super) fn fix<T: Scalar>(&self, matrix: &mut Rows<'_, T>) {
        let stride = matrix.stride;
        for &[speed, _] in self.held {
            for other in 0..self.size() {
                matrix.entries[speed * stride + other] = T::zero();
                matrix.entries[other * stride + speed] = T::zero();
            }
            matrix.entries[speed * stride + speed] = T::one();
        }
    }

    /// `M̄ = LᵀDL`, which fills no zero of the tree: L left of the diagonal, D⁻¹ on it. Right of it nothing is read.
    pub(super) fn factorise<T: Scalar>(&self, matrix: &mut Rows<'_, T>) {
        let stride = matrix.stride;
        for i in (0..self.size()).rev() {
            let end = self::stride(i + 1);
            for from in (0..end).step_by(STRIP) {
                with_columns!(end - from, eliminate(self.below[i], matrix, i, from));
            }
            let pivot = &mut matrix.entries[i * stride + i];
            *pivot = T::one() / *pivot;
        }
        for (k, row) in matrix.entries.chunks_exact_mut(stride.max(1)).enumerate() {
            let inverse = row[k];
            for &[from, to] in self.above[k] {
                for entry in &mut row[from..to] {
                    *entry *= inverse;
                }
            }
        }
    }

    /// Takes those below a row from its block of columns.
    ///
    /// Functions of one row are not inlined: each has the registers for itself.
    #[inline(never)]
    fn eliminate<T: Scalar, const N: usize>(
        below: &[[usize; 2]],
        matrix: &mut Rows<'_, T>,
        row: usize,
        from: usize,
    ) {
        let stride = matrix.stride;
        let (own_rows, others) = matrix.entries.split_at_mut((row + 1) * stride);
        let place = row * stride + from;
        let mut own: [T; N] = *super::numbers(own_rows, place);
        for &[first, last] in below {
            let others = &others[(first - row - 1) * stride..(last - row - 1) * stride];
            for (k, other) in (first..last).zip(others.chunks_exact(stride)).rev() {
                let factor = other[row] * other[k];
                less(&mut own, factor, super::numbers(other, from));
            }
        }
        own_rows[place..][..N].copy_from_slice(&own);
    }

    /// `M̄⁻¹` times the columns of the tables, as many at once as registers take.
    pub(super) fn solve<T: Scalar>(&self, factors: &Rows<'_, T>, sides: &mut Rows<'_, T>) {
        let mut done = 0;
        for &[from, to] in self.columns {
            let (from, to) = (done.max(from / BLOCK * BLOCK), stride(to));
            done = to.max(done);
            // Strips as wide as each other: a narrow one takes nearly as long as a wide one.
            let strips = to.saturating_sub(from).div_ceil(STRIP).max(1);
            let width = stride(to.saturating_sub(from).div_ceil(strips)).max(BLOCK);
            for from in (from..to).step_by(width) {
                self.solve_strip(factors, sides, [from, to.min(from + width)]);
            }
        }
    }

    /// The same of columns beside each other.
    ///
    /// A column of M̄⁻¹ is a unit below its diagonal, and not wanted there: rows begin at the block of the diagonal.
    fn solve_strip<T: Scalar>(
        &self,
        factors: &Rows<'_, T>,
        sides: &mut Rows<'_, T>,
        [from, to]: [usize; 2],
    ) {
        let mirrored = self.mirrored.filter(|&first| first <= from);
        let start = |row| mirrored.map_or(from, |first| from.max((first + row) / BLOCK * BLOCK));
        let end = mirrored.map_or(self.size(), |first| self.size().min(to - first));
        for i in (0..end).rev() {
            let place = (i, start(i));
            with_columns!(
                to - start(i),
                solve_up(self.below[i], factors, sides, place, end)
            );
        }
        for k in 0..end {
            let place = (k, start(k));
            with_columns!(
                to - start(k),
                solve_down(self.above[k], factors, sides, place)
            );
        }
    }

    /// From the leaves to the root: takes the rows below from one of them, from a column on.
    #[inline(never)]
    fn solve_up<T: Scalar, const N: usize>(
        below: &[[usize; 2]],
        factors: &Rows<'_, T>,
        sides: &mut Rows<'_, T>,
        (row, column): (usize, usize),
        end: usize,
    ) {
        let mut own: [T; N] = *super::numbers(sides.row(row), column);
        for &[from, to] in below {
            let to = to.min(end).max(from);
            let factors = factors.rows(from, to);
            for (factors, other) in factors.zip(sides.rows(from, to)).rev() {
                less(&mut own, factors[row], super::numbers(other, column));
            }
        }
        sides.assign(row, column, &own);
    }

    /// From the root to the leaves.
    #[inline(never)]
    fn solve_down<T: Scalar, const N: usize>(
        above: &[[usize; 2]],
        factors: &Rows<'_, T>,
        sides: &mut Rows<'_, T>,
        (row, column): (usize, usize),
    ) {
        let factors = factors.row(row);
        let mut own: [T; N] = *super::numbers(sides.row(row), column);
        for entry in &mut own {
            *entry *= factors[row];
        }
        for &[from, to] in above {
            for (&factor, other) in factors[from..to].iter().zip(sides.rows(from, to)).rev() {
                less(&mut own, factor, super::numbers(other, column));
            }
        }
        sides.assign(row, column, &own);
    }

    /// Assigns the rows of results, `width` numbers each.
    pub(super) fn finish<T: Scalar>(&self, sides: &Rows<'_, T>, rows: &mut [T], width: usize) {
        if self.size() == 0 {
            return;
        }
        let solved = || sides.rows(0, self.size());
        for (row, own) in rows.chunks_exact_mut(width).zip(solved()) {
            let (blocks, rest) = row.as_chunks_mut::<BLOCK>();
            let (own, _) = own.as_chunks::<BLOCK>();
            for (block, own) in blocks.iter_mut().zip(own) {
                *block = *own;
            }
            let left = own.get(blocks.len()).into_iter().flatten();
            for (place, &entry) in rest.iter_mut().zip(left) {
                *place = entry;
            }
        }
        let Some(first) = self.mirrored else { return };
        for (k, own) in solved().enumerate() {
            let right = &own[first + k + 1..first + self.size()];
            let below = rows.chunks_exact_mut(width).skip(k + 1);
            for (row, &entry) in below.zip(right) {
                row[first + k] = entry;
            }
        }
    }
}

impl<T: Scalar> Rows<'_, T> {
    fn row(&self, row: usize) -> &[T] {
        &self.entries[row * self.stride..][..self.stride]
    }

    /// Rows, from the first to behind the last.
    fn rows(&self, from: usize, to: usize) -> core::slice::ChunksExact<'_, T> {
        self.entries[from * self.stride..to * self.stride].chunks_exact(self.stride)
    }

    /// Assigns columns beside each other of a row.
    fn assign<const N: usize>(&mut self, row: usize, column: usize, block: &[T; N]) {
        self.entries[row * self.stride + column..][..N].copy_from_slice(block);
    }
}

#[inline(always)]
fn less<T: Scalar, const N: usize>(sums: &mut [T; N], factor: T, from: &[T; N]) {
    let factor = -factor;
    for (sum, &other) in sums.iter_mut().zip(from) {
        *sum = factor.mul_add(other, *sum);
    }
}
