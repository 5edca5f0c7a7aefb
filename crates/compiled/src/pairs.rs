//! Mass matrices and derivatives of long scenes, pair by pair of joints, from what a module's function found for each body.
//!
//! The twists and wrenches of all bodies under one root are read at one frame, that of the root: a joint and one that carries it meet in a few products,
//! whatever the joints are. So the length of a module grows with the number of bodies, while the work, which grows with the number of pairs, is done here in
//! loops over tables. What no path of the tree connects stays 0.
//!
//! [`Pairs`] are the tables; `work` holds the numbers of one state: for each body that carries others the columns X̄ of its joint (six numbers a speed), then
//! W and U of each unit (nine); for each joint that is carried the wrench that each of its units raises (six), then N X̄ and the angular part of Bᵀ X̄ of each
//! speed (nine). Units of a joint are its local coordinates, then its speeds.

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
    /// For each speed the next one towards the root.
    pub above: &'a [Option<usize>],
    /// Entries of rows that are added: row, column, place in `work`.
    pub entries: &'a [[usize; 3]],
    /// The same of M̄.
    pub masses: &'a [[usize; 3]],
    /// Speeds whose rates are given, with the columns of these rates.
    pub held: &'a [[usize; 2]],
    /// Columns of the right-hand sides that are not 0: from the first to behind the last.
    pub columns: &'a [[usize; 2]],
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
            row[..freedoms + size]
                .iter_mut()
                .for_each(|entry| *entry = -*entry);
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

    /// Makes given rates known: what they take of others moves to the right-hand side.
    fn hold<T: Scalar>(&self, matrix: &mut [T], rows: &mut [T], width: usize) {
        let size = self.above.len();
        for &[speed, column] in self.held {
            for row in 0..size {
                rows[row * width + column] = -matrix[row * size + speed];
            }
        }
        for &[speed, _] in self.held {
            rows[speed * width..][..width - 1].fill(T::zero());
        }
        for &[speed, column] in self.held {
            rows[speed * width + column] = T::one();
            for other in 0..size {
                matrix[speed * size + other] = T::zero();
                matrix[other * size + speed] = T::zero();
            }
            matrix[speed * size + speed] = T::one();
        }
    }

    /// `M̄ = LᵀDL`, which fills no zero of the tree: L in the lower triangle, D⁻¹ on the diagonal.
    fn factorise<T: Scalar>(&self, matrix: &mut [T]) {
        let size = self.above.len();
        for k in (0..size).rev() {
            let (before, own) = matrix.split_at_mut(k * size);
            let inverse = T::one() / own[k];
            let mut next = self.above[k];
            while let Some(i) = next {
                let factor = own[i] * inverse;
                let row = &mut before[i * size..][..size];
                let mut other = next;
                while let Some(j) = other {
                    row[j] = (-factor).mul_add(own[j], row[j]);
                    other = self.above[j];
                }
                own[i] = factor;
                next = self.above[i];
            }
            own[k] = inverse;
        }
    }

    /// `M̄⁻¹` times the columns of the tables, as many at once as registers take.
    fn solve<T: Scalar>(&self, factors: &[T], rows: &mut [T], width: usize) {
        for &[from, to] in self.columns {
            let mut from = from;
            while from < to {
                from += match to - from {
                    16.. => self.solve_block::<T, 16>(factors, rows, [width, from]),
                    8.. => self.solve_block::<T, 8>(factors, rows, [width, from]),
                    4.. => self.solve_block::<T, 4>(factors, rows, [width, from]),
                    _ => self.solve_block::<T, 1>(factors, rows, [width, from]),
                };
            }
        }
        if let Some(first) = self.mirrored {
            let size = self.above.len();
            for row in 0..size {
                for column in 0..row {
                    rows[row * width + first + column] = rows[column * width + first + row];
                }
            }
        }
    }

    /// The same of columns beside each other; how many these are.
    fn solve_block<T: Scalar, const N: usize>(
        &self,
        factors: &[T],
        rows: &mut [T],
        [width, from]: [usize; 2],
    ) -> usize {
        let size = self.above.len();
        // A column of M̄⁻¹ is a unit below its diagonal, and not wanted there.
        let wanted = self
            .mirrored
            .and_then(|first| (from + N).checked_sub(first));
        let wanted = wanted
            .filter(|&wanted| wanted > 0)
            .map_or(size, |wanted| wanted.min(size));
        for k in (0..wanted).rev() {
            let own: [T; N] = block(rows, k * width + from);
            let mut next = self.above[k];
            while let Some(i) = next {
                let place = i * width + from;
                let sums = less(block(rows, place), factors[k * size + i], &own);
                rows[place..place + N].copy_from_slice(&sums);
                next = self.above[i];
            }
        }
        for k in 0..wanted {
            let inverse = factors[k * size + k];
            let place = k * width + from;
            let mut own: [T; N] = block(rows, place).map(|entry| entry * inverse);
            let mut next = self.above[k];
            while let Some(i) = next {
                own = less(own, factors[k * size + i], &block(rows, i * width + from));
                next = self.above[i];
            }
            rows[place..place + N].copy_from_slice(&own);
        }
        N
    }
}

#[inline(always)]
fn block<T: Scalar, const N: usize>(rows: &[T], place: usize) -> [T; N] {
    let found = rows[place..].first_chunk();
    found.copied().unwrap_or([T::zero(); N])
}

#[inline(always)]
fn less<T: Scalar, const N: usize>(mut sums: [T; N], factor: T, from: &[T; N]) -> [T; N] {
    let factor = -factor;
    for (sum, &other) in sums.iter_mut().zip(from) {
        *sum = factor.mul_add(other, *sum);
    }
    sums
}

impl Pairing {
    /// The column of a unit.
    fn place(&self, unit: usize, freedoms: usize) -> usize {
        match unit.checked_sub(self.freedoms[1]) {
            None => self.freedoms[0] + unit,
            Some(speed) => freedoms + self.speeds[0] + speed,
        }
    }
}

fn dot<T: Scalar>(a: &[T], b: &[T]) -> T {
    let mut pairs = a.iter().zip(b);
    let first = pairs.next().map_or(T::zero(), |(&a, &b)| a * b);
    pairs.fold(first, |sum, (&a, &b)| a.mul_add(b, sum))
}

fn add<T: Scalar>(entries: &[[usize; 3]], work: &[T], rows: &mut [T], width: usize) {
    for &[row, column, place] in entries {
        let entry = &mut rows[row * width + column];
        *entry += work[place];
    }
}
