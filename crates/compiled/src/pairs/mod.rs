//! Mass matrices and derivatives of long scenes, pair by pair of joints, from what a module's function found for each body.
//!
//! The twists and wrenches of all bodies under one root are read at one frame, that of the root: a joint and one that carries it meet in a few products,
//! whatever the joints are. So the length of a module grows with the number of bodies, while the work, which grows with the number of pairs, is done here in
//! loops over tables. What no path of the tree connects stays 0.
//!
//! [`Pairs`] are the tables; `work` holds the numbers of one state, as [`Places`] says. Numbers that columns beside each other need stand beside each other, so that
//! compilers vectorise: eight columns of a row are found at once, and M̄⁻¹ is multiplied by up to 48 columns at once, in rows that begin where lines of the cache do.

mod lanes;
mod meeting;
mod second;
mod solution;

use hamel_runtime::scalar::Scalar;
pub use lanes::{STRIP, Strip, room_in_lanes};
pub use meeting::{BEHIND, Meeting};
use meeting::{Columns, NINE, SIX, meet};
pub use solution::{Aligned, room_to_solve};

/// A joint of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pairing {
    /// Its first speed and the number of these.
    pub speeds: [usize; 2],
    /// Its first degree of freedom and the number of these.
    pub freedoms: [usize; 2],
    /// The body that carries it, in the tables.
    pub parent: Option<usize>,
}

/// A body that carries others, in the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Carrying {
    /// Its joint.
    pub joint: usize,
    /// The body that carries its joint.
    pub parent: Option<usize>,
    /// How many bodies of its joint that carry others stand before it.
    pub layer: usize,
}

/// Where the numbers of one state stand in `work`.
///
/// A column is a degree of freedom, or behind all of these a speed. X̄ are the columns of a joint at a body that carries others, six numbers a speed; W and U, nine,
/// are what a unit of a column changes there: of the body's twist, and the angular part of its acceleration. What others show to those that carry them are the
/// wrench that a unit of a column raises, six numbers, and of each speed the momentum N X̄ and the angular part of Bᵀ X̄, nine.
///
/// X̄, W and U, and the wrenches are by component: the first numbers of all, then the second ones. Several bodies of one joint that carry others stand in layers, each
/// as long as there are speeds or columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Places {
    /// Degrees of freedom, and speeds.
    pub sizes: [usize; 2],
    /// Layers of X̄, and of W and U.
    pub layers: usize,
    /// Where X̄ begins.
    pub columns: usize,
    /// Where W and U begin.
    pub variations: usize,
    /// Where wrenches begin.
    pub raised: usize,
    /// Where momenta begin, speed after speed.
    pub momenta: usize,
    /// How many numbers each of them has: six for the mass matrix alone.
    pub momentum: usize,
    /// For second derivatives: where the virtual drifts p of ϕ begin, six numbers each, layer after layer.
    pub drifts: usize,
    /// For these: where that begins which W of carrying joints meets, six numbers for each ϕ.
    pub by_rate: usize,
    /// For these: where that begins which U meets, three for each column.
    pub by_drift: usize,
}

impl Places {
    /// Columns of derivatives.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.sizes[0] + self.sizes[1]
    }

    /// From one component of X̄ to the next.
    #[must_use]
    pub const fn column_stride(&self) -> usize {
        self.layers * self.sizes[1]
    }

    /// From one component of W and U to the next.
    #[must_use]
    pub const fn variation_stride(&self) -> usize {
        self.layers * self.width()
    }
}

/// The tables of one function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pairs<'a> {
    /// Where numbers stand.
    pub places: Places,
    /// The joints: for second derivatives alone.
    pub joints: &'a [Pairing],
    /// The bodies that carry others: for second derivatives alone.
    pub bodies: &'a [Carrying],
    /// Rows of slopes: X̄ of a speed and wrenches that columns raise, or its momentum and W and U of columns.
    pub slopes: &'a [Meeting],
    /// Rows of M̄ left of the diagonal: the momentum of a speed and X̄ of others.
    pub moved: &'a [Meeting],
    /// For each speed those towards the root, the nearest first, in ranges of speeds that follow each other: from the first to behind the last.
    pub above: &'a [&'a [[usize; 2]]],
    /// For each speed those that reach it on their way to the root, the last one first, in such ranges.
    pub below: &'a [&'a [[usize; 2]]],
    /// Entries of rows that are added: row, column, place in `work`.
    pub entries: &'a [[usize; 3]],
    /// The same of M̄.
    pub masses: &'a [[usize; 3]],
    /// The same of the Hessian of contracted inverse dynamics.
    pub bends: &'a [[usize; 3]],
    /// Speeds whose rates are given, with the columns of these rates.
    pub held: &'a [[usize; 2]],
    /// Columns of the right-hand sides that are not 0: from the first to behind the last.
    pub columns: &'a [[usize; 2]],
    /// Entries that are added to what is solved: row, column, place in `work`.
    pub followed: &'a [[usize; 3]],
    /// The column from which as many as there are speeds are M̄⁻¹, of which the upper triangle is found: the other one is its mirror image.
    pub mirrored: Option<usize>,
}

impl Pairs<'_> {
    /// M̄ by rows, into zeros.
    pub fn mass<T: Scalar>(&self, work: &[T], matrix: &mut [T]) {
        let size = self.size();
        self.fill_mass(work, matrix, size);
        for &Meeting { row, columns, .. } in self.moved {
            for column in columns[0]..columns[1] {
                matrix[column * size + row] = matrix[row * size + column];
            }
        }
    }

    /// M̄⁻¹ by rows; rows of rates that are given are 0. `room` has as many zeros as [`room_to_solve`] says.
    pub fn inverse_mass<T: Scalar>(&self, work: &[T], room: &mut [T], rows: &mut [T]) {
        let size = self.size();
        let [mut factors, mut sides] = self.split(room, size);
        for speed in 0..size {
            let given = self.held.iter().any(|&[held, _]| held == speed);
            let place = speed * sides.stride + speed;
            sides.entries[place] = if given { T::zero() } else { T::one() };
        }
        self.fill_mass(work, factors.entries, factors.stride);
        self.fix(&mut factors);
        self.factorise(&mut factors);
        self.solve(&factors, &mut sides);
        self.finish(&sides, rows, size);
    }

    /// Rows of derivatives of inverse dynamics, into zeros: in all degrees of freedom, then in all speeds.
    pub fn inverse<T: Scalar>(&self, work: &[T], rows: &mut [T]) {
        self.fill_slopes(work, rows, self.places.width(), |entry| entry);
    }

    /// Rows of derivatives of forward dynamics, `width` numbers each: in all degrees of freedom, in all speeds, in all efforts, and the rates.
    /// `room` has as many zeros as [`room_to_solve`] says.
    pub fn forward<T: Scalar>(&self, work: &[T], room: &mut [T], rows: &mut [T], width: usize) {
        let [mut factors, mut sides] = self.split(room, width);
        self.right_hand_sides(work, sides.entries, sides.stride);
        self.fill_mass(work, factors.entries, factors.stride);
        self.hold(&mut factors, &mut sides);
        self.factorise(&mut factors);
        self.solve(&factors, &mut sides);
        self.finish(&sides, rows, width);
        add(self.followed, work, rows, width);
    }

    /// What forward dynamics is solved for, in rows of zeros `width` apart: opposites of derivatives of inverse dynamics, and S̄ᵀ.
    pub fn right_hand_sides<T: Scalar>(&self, work: &[T], rows: &mut [T], width: usize) {
        // Zeros stay positive, so that it does not show whether they are skipped.
        self.fill_slopes(work, rows, width, |entry| T::zero() - entry);
    }

    /// Speeds.
    fn size(&self) -> usize {
        self.places.sizes[1]
    }

    /// M̄ on and left of the diagonal, by rows of `stride` numbers, into zeros.
    fn fill_mass<T: Scalar>(&self, work: &[T], matrix: &mut [T], stride: usize) {
        let columns = Columns {
            work,
            stride: self.places.column_stride(),
        };
        for meeting in self.moved {
            let own: &[T; SIX] = numbers(work, meeting.own);
            meet(meeting, own, columns, (matrix, stride), |entry| entry);
        }
        add(self.masses, work, matrix, stride);
    }

    /// Slopes of inverse dynamics, or their opposites; what stands behind them in a row is no slope.
    fn fill_slopes<T: Scalar>(
        &self,
        work: &[T],
        rows: &mut [T],
        width: usize,
        sign: impl Fn(T) -> T + Copy,
    ) {
        let slopes = self.places.width();
        let apart = self.places.column_stride();
        let [raised, varied] =
            [slopes, self.places.variation_stride()].map(|stride| Columns { work, stride });
        for meeting in self.slopes {
            if meeting.is_momentum {
                let own: &[T; NINE] = numbers(work, meeting.own);
                meet(meeting, own, varied, (rows, width), sign);
            } else {
                let own: [T; SIX] = core::array::from_fn(|i| work[meeting.own + apart * i]);
                meet(meeting, &own, raised, (rows, width), sign);
            }
        }
        for &[row, column, place] in self.entries {
            let entry = &mut rows[row * width + column];
            *entry += match column < slopes {
                true => sign(work[place]),
                false => work[place],
            };
        }
    }
}

impl Pairing {
    /// The column of a unit.
    #[inline(always)]
    fn place(&self, unit: usize, freedoms: usize) -> usize {
        match unit.checked_sub(self.freedoms[1]) {
            None => self.freedoms[0] + unit,
            Some(speed) => freedoms + self.speeds[0] + speed,
        }
    }
}

/// So many numbers from a place on.
#[inline(always)]
fn numbers<T: Scalar, const N: usize>(work: &[T], place: usize) -> &[T; N] {
    &work[place..place + N].as_chunks().0[0]
}

#[inline(always)]
fn add<T: Scalar>(entries: &[[usize; 3]], work: &[T], rows: &mut [T], width: usize) {
    for &[row, column, place] in entries {
        let entry = &mut rows[row * width + column];
        *entry += work[place];
    }
}
