//! Second derivatives, contracted with weights, pair by pair of joints.
//!
//! Beside what first derivatives read, `work` holds of each body that carries others the virtual drift p of each ϕ (six numbers), after W and U; of each joint
//! that is carried what W of those that carry it meets, for each ϕ (six), then the moment that U meets, for each unit (three), after N X̄ and Bᵀ X̄.

use super::{Carrying, NINE, Pairing, Pairs, SIX, add, dot};
use hamel_runtime::scalar::Scalar;

/// Numbers of a moment.
const THREE: usize = 3;

impl Pairs<'_> {
    /// The Hessian of contracted inverse dynamics by rows of `width`, over (ϕ, v̄, v̄̇).
    pub fn second_inverse<T: Scalar>(&self, work: &[T], rows: &mut [T], width: usize) {
        let freedoms = width.saturating_sub(2 * self.above.len());
        self.fill_bends(work, rows, [width, freedoms]);
    }

    /// The Hessian of contracted forward dynamics by rows of `width`, over (ϕ, v̄, τ); `room` has, with S speeds and K degrees of freedom, `S² + S width + S K + width + 4 (K + S)²` numbers.
    pub fn second_forward<T: Scalar>(
        &self,
        work: &[T],
        room: &mut [T],
        rows: &mut [T],
        width: usize,
    ) {
        let size = self.above.len();
        let freedoms = width.saturating_sub(size) / 2;
        let wide = 2 * (freedoms + size);
        let (matrix, room) = room.split_at_mut(size * size);
        let (needed, room) = room.split_at_mut(size * width);
        let (solved, room) = room.split_at_mut(size * freedoms);
        let (sums, bends) = room.split_at_mut(width);
        self.fill_bends(work, bends, [wide, freedoms]);
        needed.fill(T::zero());
        self.fill_slopes(work, needed, [width, freedoms]);
        add(self.entries, work, needed, width);
        self.fill_mass(work, matrix, |joint, speed| {
            let units = joint.freedoms[1] + joint.speeds[1];
            joint.shown + SIX * units + NINE * speed
        });
        self.factorise(matrix);
        for speed in 0..size {
            for k in 0..freedoms {
                solved[speed * freedoms + k] = bends[k * wide + freedoms + size + speed];
            }
        }
        if freedoms > 0 {
            self.solve(matrix, solved, freedoms);
        }
        // Efforts stand behind v̄̇ among what bends.
        let place = |x: usize| if x < freedoms + size { x } else { x + size };
        for (i, row) in rows.chunks_exact_mut(width.max(1)).enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = -bends[place(i) * wide + place(j)];
            }
        }
        for k in 0..freedoms {
            sums.fill(T::zero());
            for speed in 0..size {
                let factor = solved[speed * freedoms + k];
                let row = &needed[speed * width..][..width];
                for (sum, &entry) in sums.iter_mut().zip(row) {
                    *sum = factor.mul_add(entry, *sum);
                }
            }
            for (x, &sum) in sums.iter().enumerate() {
                // What inverse dynamics needs comes to the rates with the other sign, efforts with their own.
                let sum = if x < freedoms + size { sum } else { -sum };
                rows[k * width + x] += sum;
                rows[x * width + k] += sum;
            }
        }
    }

    /// H between units of different joints, and the entries of the tables.
    fn fill_bends<T: Scalar>(&self, work: &[T], rows: &mut [T], [width, freedoms]: [usize; 2]) {
        rows.fill(T::zero());
        for joint in self.joints {
            let mut carrier = joint.parent;
            while let Some(body) = carrier {
                let Carrying {
                    joint: above,
                    parent,
                    seen,
                } = self.bodies[body];
                let bent = Bent {
                    work,
                    joint,
                    above: &self.joints[above],
                    seen,
                    freedoms,
                    rates: freedoms + self.above.len(),
                };
                bent.each(&mut |row, column, entry| {
                    rows[row * width + column] = entry;
                    rows[column * width + row] = entry;
                });
                carrier = parent;
            }
        }
        add(self.bends, work, rows, width);
    }
}

/// A joint, and one that carries it.
struct Bent<'a, T> {
    work: &'a [T],
    joint: &'a Pairing,
    above: &'a Pairing,
    seen: usize,
    freedoms: usize,
    /// The first place of v̄̇.
    rates: usize,
}

impl<T: Scalar> Bent<'_, T> {
    fn numbers<const N: usize>(&self, place: usize) -> &[T] {
        &self.work[place..][..N]
    }

    /// All pairs of directions.
    #[inline(always)]
    fn each(&self, found: &mut impl FnMut(usize, usize, T)) {
        let Self { joint, above, .. } = self;
        let [own, others] = [joint, above].map(|of| of.freedoms[1] + of.speeds[1]);
        let momenta = joint.shown + SIX * own;
        let by_rate = momenta + NINE * joint.speeds[1];
        let by_drift = by_rate + SIX * joint.freedoms[1];
        let variations = self.seen + SIX * above.speeds[1];
        let drifts = variations + NINE * others;
        for l in 0..others {
            let variation = self.numbers::<NINE>(variations + NINE * l);
            let (rate, drift) = variation.split_at(SIX);
            let row = above.place(l, self.freedoms);
            for k in 0..own {
                let mut entry = dot(drift, self.numbers::<THREE>(by_drift + THREE * k));
                if k < joint.freedoms[1] {
                    entry += dot(rate, self.numbers::<SIX>(by_rate + SIX * k));
                }
                if l < above.freedoms[1] {
                    let raised = self.numbers::<SIX>(joint.shown + SIX * k);
                    entry += dot(self.numbers::<SIX>(drifts + SIX * l), raised);
                }
                found(row, joint.place(k, self.freedoms), entry);
            }
            for speed in (0..joint.speeds[1]).filter(|_| l < above.freedoms[1]) {
                let momentum = self.numbers::<SIX>(momenta + NINE * speed);
                let entry = dot(self.numbers::<SIX>(drifts + SIX * l), momentum);
                found(row, self.rates + joint.speeds[0] + speed, entry);
            }
        }
        for speed in 0..above.speeds[1] {
            let column = self.numbers::<SIX>(self.seen + SIX * speed);
            for k in 0..joint.freedoms[1] {
                let entry = dot(column, self.numbers::<SIX>(by_rate + SIX * k));
                let row = self.rates + above.speeds[0] + speed;
                found(row, joint.freedoms[0] + k, entry);
            }
        }
    }
}
