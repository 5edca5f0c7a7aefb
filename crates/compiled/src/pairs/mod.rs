//! Mass matrices and derivatives of long scenes, pair by pair of joints, from what a module's function found for each body.
//!
//! The twists and wrenches of all bodies under one root are read at one frame, that of the root: a joint and one that carries it meet in a few products,
//! whatever the joints are. So the length of a module grows with the number of bodies, while the work, which grows with the number of pairs, is done here in
//! loops over tables. What no path of the tree connects stays 0.
//!
//! [`Pairs`] are the tables; `work` holds the numbers of one state: for each body that carries others the columns X̄ of its joint (six numbers a speed), then
//! W and U of each unit (nine); for each joint that is carried the wrench that each of its units raises (six), then N X̄ and the angular part of Bᵀ X̄ of each
//! speed (nine). Units of a joint are its local coordinates, then its speeds.

mod second;
mod solution;

use hamel_runtime::scalar::Scalar;

/// A joint of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pairing {
    /// Its first speed and the number of these.
    pub speeds: [usize; 2],
    /// Its first degree of freedom and the number of these.
    pub freedoms: [usize; 2],
    /// The body that carries it, in the tables.
    pub parent: Option<usize>,
    /// Where in `work` that begins which it shows to those.
    pub shown: usize,
}

/// A body that carries others, in the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Carrying {
    /// Its joint.
    pub joint: usize,
    /// The body that carries its joint.
    pub parent: Option<usize>,
    /// Where in `work` that begins which others see of it.
    pub seen: usize,
}

/// The tables of one function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pairs<'a> {
    /// The joints.
    pub joints: &'a [Pairing],
    /// The bodies that carry others.
    pub bodies: &'a [Carrying],
    /// For each speed those towards the root, the nearest first, in ranges of speeds that follow each other: from the first to behind the last.
    pub above: &'a [&'a [[usize; 2]]],
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
    /// For each speed which columns may differ from 0 when what hangs on it is eliminated: bits of words of 64 columns.
    pub filled: &'a [&'a [u64]],
    /// For each speed those that its momentum reaches on the way from the leaves, the last one first.
    pub below: &'a [&'a [usize]],
    /// Entries that are added to what is solved: row, column, place in `work`.
    pub followed: &'a [[usize; 3]],
    /// The column from which as many as there are speeds are M̄⁻¹, of which the upper triangle is found: the other one is its mirror image.
    pub mirrored: Option<usize>,
}

/// Numbers of a twist or wrench, and of what a unit or a speed has beside it.
const SIX: usize = 6;
const NINE: usize = 9;

impl Pairs<'_> {
    /// M̄ by rows, from `work` that has six numbers for each speed alone.
    pub fn mass<T: Scalar>(&self, work: &[T], matrix: &mut [T]) {
        self.fill_mass(work, matrix, |joint, speed| joint.shown + SIX * speed);
    }

    /// M̄⁻¹ by rows, from the same `work`; rows of rates that are given are 0. `matrix` has room for M̄, and then holds its factors.
    pub fn inverse_mass<T: Scalar>(&self, work: &[T], matrix: &mut [T], rows: &mut [T]) {
        let size = self.above.len();
        self.mass(work, matrix);
        rows.fill(T::zero());
        for speed in 0..size {
            let given = self.held.iter().any(|&[held, _]| held == speed);
            rows[speed * size + speed] = if given { T::zero() } else { T::one() };
        }
        self.fix(matrix);
        self.factorise(matrix);
        self.solve(matrix, rows, size);
    }

    /// Rows of derivatives of inverse dynamics, `width` numbers each: in all degrees of freedom, then in all speeds.
    pub fn inverse<T: Scalar>(&self, work: &[T], rows: &mut [T], width: usize) {
        let freedoms = width.saturating_sub(self.above.len());
        rows.fill(T::zero());
        self.fill_slopes(work, rows, [width, freedoms]);
        add(self.entries, work, rows, width);
    }

    /// Rows of derivatives of forward dynamics, `width` numbers each: in all degrees of freedom, in all speeds, in all efforts, and the rates.
    /// `matrix` has room for M̄, and then holds its factors.
    pub fn forward<T: Scalar>(&self, work: &[T], matrix: &mut [T], rows: &mut [T], width: usize) {
        let size = self.above.len();
        if size == 0 || width == 0 {
            return;
        }
        let freedoms = self.right_hand_sides(work, rows, width);
        for row in rows.chunks_exact_mut(width) {
            for entry in &mut row[..freedoms + size] {
                // Zeros stay positive, so that it does not show whether they are skipped.
                *entry = T::zero() - *entry;
            }
        }
        self.fill_mass(work, matrix, |joint, speed| {
            let units = joint.freedoms[1] + joint.speeds[1];
            joint.shown + SIX * units + NINE * speed
        });
        self.hold(matrix, rows, width);
        self.factorise(matrix);
        self.solve(matrix, rows, width);
        add(self.followed, work, rows, width);
    }

    /// What forward dynamics is solved for: derivatives of inverse dynamics, S̄ᵀ and the rates; the number of degrees of freedom.
    pub fn right_hand_sides<T: Scalar>(&self, work: &[T], rows: &mut [T], width: usize) -> usize {
        let freedoms = width.saturating_sub(self.above.len() + 1) / 2;
        rows.fill(T::zero());
        self.fill_slopes(work, rows, [width, freedoms]);
        add(self.entries, work, rows, width);
        freedoms
    }

    fn fill_mass<T: Scalar>(
        &self,
        work: &[T],
        matrix: &mut [T],
        momentum: impl Fn(&Pairing, usize) -> usize,
    ) {
        let size = self.above.len();
        matrix.fill(T::zero());
        for joint in self.joints {
            let mut carrier = joint.parent;
            while let Some(body) = carrier {
                let Carrying {
                    joint: above,
                    parent,
                    seen,
                } = self.bodies[body];
                let [other, others] = self.joints[above].speeds;
                for speed in 0..joint.speeds[1] {
                    let momentum = &work[momentum(joint, speed)..][..SIX];
                    let row = joint.speeds[0] + speed;
                    for k in 0..others {
                        let entry = dot(&work[seen + SIX * k..][..SIX], momentum);
                        matrix[row * size + other + k] = entry;
                        matrix[(other + k) * size + row] = entry;
                    }
                }
                carrier = parent;
            }
        }
        add(self.masses, work, matrix, size);
    }

    fn fill_slopes<T: Scalar>(&self, work: &[T], rows: &mut [T], [width, freedoms]: [usize; 2]) {
        for joint in self.joints {
            let units = joint.freedoms[1] + joint.speeds[1];
            let mut carrier = joint.parent;
            while let Some(body) = carrier {
                let Carrying {
                    joint: above,
                    parent,
                    seen,
                } = self.bodies[body];
                let above = &self.joints[above];
                for k in 0..above.speeds[1] {
                    let column = &work[seen + SIX * k..][..SIX];
                    let row = (above.speeds[0] + k) * width;
                    for unit in 0..units {
                        let raised = &work[joint.shown + SIX * unit..][..SIX];
                        rows[row + joint.place(unit, freedoms)] = dot(column, raised);
                    }
                }
                let (seen, shown) = (seen + SIX * above.speeds[1], joint.shown + SIX * units);
                for speed in 0..joint.speeds[1] {
                    let momentum = &work[shown + NINE * speed..][..NINE];
                    let row = (joint.speeds[0] + speed) * width;
                    for unit in 0..above.freedoms[1] + above.speeds[1] {
                        let variation = &work[seen + NINE * unit..][..NINE];
                        rows[row + above.place(unit, freedoms)] = dot(variation, momentum);
                    }
                }
                carrier = parent;
            }
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

#[inline(always)]
fn dot<T: Scalar>(a: &[T], b: &[T]) -> T {
    let mut sum = a[0] * b[0];
    for (&a, &b) in a[1..].iter().zip(&b[1..]) {
        sum = a.mul_add(b, sum);
    }
    sum
}

#[inline(always)]
fn add<T: Scalar>(entries: &[[usize; 3]], work: &[T], rows: &mut [T], width: usize) {
    for &[row, column, place] in entries {
        let entry = &mut rows[row * width + column];
        *entry += work[place];
    }
}
