//! Second derivatives, contracted with weights, pair by pair of joints.
//!
//! Beside what first derivatives read, `work` holds of each body that carries others the virtual drift p of each ϕ; of each joint that is carried what W of those
//! that carry it meets, for each ϕ, then the moment that U meets, for each unit.

use super::{Carrying, Pairing, Pairs, SIX, add};
use hamel_runtime::scalar::Scalar;

/// Numbers of a moment.
const THREE: usize = 3;

impl Pairs<'_> {
    /// The Hessian of contracted inverse dynamics by rows of `width`, over (ϕ, v̄, v̄̇), into zeros.
    pub fn second_inverse<T: Scalar>(&self, work: &[T], rows: &mut [T], width: usize) {
        self.fill_bends(work, rows, width);
    }

    /// The Hessian of contracted forward dynamics by rows of `width`, over (ϕ, v̄, τ); `room` has zeros: with S speeds and K degrees of freedom as many as
    /// [`super::room_to_solve`] says for K columns, and `S width + width + 4 (K + S)²`.
    pub fn second_forward<T: Scalar>(
        &self,
        work: &[T],
        room: &mut [T],
        rows: &mut [T],
        width: usize,
    ) {
        let [freedoms, size] = self.places.sizes;
        let wide = 2 * (freedoms + size);
        let (room, more) = room.split_at_mut(super::room_to_solve(size, freedoms));
        let (needed, more) = more.split_at_mut(size * width);
        let (sums, bends) = more.split_at_mut(width);
        self.fill_bends(work, bends, wide);
        self.fill_slopes(work, needed, width, |entry| entry);
        let [mut factors, mut sides] = self.split(room, freedoms);
        self.fill_mass(work, factors.entries, factors.stride);
        self.factorise(&mut factors);
        for speed in 0..size {
            for k in 0..freedoms {
                let place = speed * sides.stride + k;
                sides.entries[place] = bends[k * wide + freedoms + size + speed];
            }
        }
        self.solve(&factors, &mut sides);
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
                let factor = sides.entries[speed * sides.stride + k];
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
    fn fill_bends<T: Scalar>(&self, work: &[T], rows: &mut [T], width: usize) {
        for joint in self.joints {
            let mut carrier = joint.parent;
            while let Some(body) = carrier {
                let Carrying {
                    joint: above,
                    parent,
                    layer,
                } = self.bodies[body];
                let bent = Bent {
                    pairs: self,
                    work,
                    joint,
                    above: &self.joints[above],
                    layer,
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

/// A joint, and a body of one that carries it.
struct Bent<'a, T> {
    pairs: &'a Pairs<'a>,
    work: &'a [T],
    joint: &'a Pairing,
    above: &'a Pairing,
    layer: usize,
}

impl<T: Scalar> Bent<'_, T> {
    /// Numbers that follow each other.
    fn numbers<const N: usize>(&self, place: usize) -> [T; N] {
        *super::numbers(self.work, place)
    }

    /// Numbers by component.
    fn apart<const N: usize>(&self, place: usize, stride: usize) -> [T; N] {
        core::array::from_fn(|i| self.work[place + stride * i])
    }

    /// W of a unit of the carrying joint, then U.
    fn variation(&self, column: usize) -> ([T; SIX], [T; THREE]) {
        let places = &self.pairs.places;
        let stride = places.variation_stride();
        let place = places.variations + self.layer * places.width() + column;
        let drift = self.apart(place + SIX * stride, stride);
        (self.apart(place, stride), drift)
    }

    /// All pairs of directions.
    #[inline(always)]
    fn each(&self, found: &mut impl FnMut(usize, usize, T)) {
        let Self { joint, above, .. } = self;
        let places = &self.pairs.places;
        let [freedoms, speeds] = places.sizes;
        let rates = freedoms + speeds;
        let [own, others] = [joint, above].map(|of| of.freedoms[1] + of.speeds[1]);
        let by_rate =
            |k: usize| self.numbers::<SIX>(places.by_rate + SIX * (joint.freedoms[0] + k));
        for l in 0..others {
            let row = above.place(l, freedoms);
            let (rate, drift) = self.variation(row);
            let virtual_drift = (l < above.freedoms[1]).then(|| {
                let freedom = self.layer * freedoms + above.freedoms[0] + l;
                self.numbers::<SIX>(places.drifts + SIX * freedom)
            });
            for k in 0..own {
                let column = joint.place(k, freedoms);
                let by_drift = self.numbers::<THREE>(places.by_drift + THREE * column);
                let mut entry = dot(&drift, &by_drift);
                if k < joint.freedoms[1] {
                    entry += dot(&rate, &by_rate(k));
                }
                if let Some(virtual_drift) = &virtual_drift {
                    let raised = self.apart(places.raised + column, places.width());
                    entry += dot(virtual_drift, &raised);
                }
                found(row, column, entry);
            }
            let Some(virtual_drift) = virtual_drift else {
                continue;
            };
            for speed in joint.speeds[0]..joint.speeds[0] + joint.speeds[1] {
                let momentum = self.numbers(places.momenta + places.momentum * speed);
                found(row, rates + speed, dot(&virtual_drift, &momentum));
            }
        }
        for speed in above.speeds[0]..above.speeds[0] + above.speeds[1] {
            let place = places.columns + self.layer * speeds + speed;
            let column = self.apart(place, places.column_stride());
            for k in 0..joint.freedoms[1] {
                found(
                    rates + speed,
                    joint.freedoms[0] + k,
                    dot(&column, &by_rate(k)),
                );
            }
        }
    }
}

#[inline(always)]
fn dot<T: Scalar, const N: usize>(a: &[T; N], b: &[T; N]) -> T {
    let mut sum = a[0] * b[0];
    for (&a, &b) in a[1..].iter().zip(&b[1..]) {
        sum = a.mul_add(b, sum);
    }
    sum
}
