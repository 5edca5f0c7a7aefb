//! What a function leaves to loops over pairs of joints: the tables of [`hamel_compiled::Pairs`], as they are made.

use super::graph::Operations;
use hamel_compiled::{
    Carrying, Lanes, Meeting, Pairing, Pairs, Places, Plain, STRIP, Strip, room_in_lanes,
    room_to_solve,
};

/// What is made of the numbers of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Product {
    /// M̄.
    Mass,
    /// M̄⁻¹.
    InverseMass,
    /// Derivatives of inverse dynamics.
    Inverse,
    /// Derivatives of forward dynamics.
    Forward,
    /// Second derivatives of inverse dynamics.
    SecondInverse,
    /// Second derivatives of forward dynamics.
    SecondForward,
}

impl Product {
    /// Its name in emitted code: a method of the runtime, a helper in C.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mass => "mass",
            Self::InverseMass => "inverse_mass",
            Self::Inverse => "inverse",
            Self::Forward => "forward",
            Self::SecondInverse => "second_inverse",
            Self::SecondForward => "second_forward",
        }
    }

    /// Whether numbers of each column are needed.
    pub const fn has_columns(self) -> bool {
        !matches!(self, Self::Mass | Self::InverseMass)
    }

    /// Whether first derivatives of inverse dynamics are made.
    pub const fn has_slopes(self) -> bool {
        matches!(self, Self::Inverse | Self::Forward | Self::SecondForward)
    }

    /// Whether second ones are.
    pub const fn has_bends(self) -> bool {
        matches!(self, Self::SecondInverse | Self::SecondForward)
    }
}

/// Columns that eight states side by side solve for at once: those of [`hamel_compiled::Strip`], as they are made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    /// From the first to behind the last.
    pub columns: [usize; 2],
    /// Rows where they are not 0 once the rows below are eliminated.
    pub rows: Vec<[usize; 2]>,
    /// Behind the last row that is found.
    pub end: usize,
}

/// The tables of one function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tables {
    /// What is made.
    pub product: Product,
    /// Rows and columns of the results.
    pub size: [usize; 2],
    /// Where numbers stand.
    pub places: Places,
    /// Joints.
    pub joints: Vec<Pairing>,
    /// Bodies that carry others.
    pub bodies: Vec<Carrying>,
    /// Rows of slopes that X̄ of a speed has with wrenches, and its momentum with W and U.
    pub slopes: Vec<Meeting>,
    /// Rows of M̄ that the momentum of a speed has with X̄.
    pub moved: Vec<Meeting>,
    /// For each speed the next one towards the root.
    pub above: Vec<Option<usize>>,
    /// Entries of rows that are added: row, column, place among the numbers of the bodies.
    pub entries: Vec<[usize; 3]>,
    /// The same of M̄.
    pub masses: Vec<[usize; 3]>,
    /// The same of the Hessian of contracted inverse dynamics.
    pub bends: Vec<[usize; 3]>,
    /// Speeds whose rates are given, with the columns of these rates.
    pub held: Vec<[usize; 2]>,
    /// Columns of right-hand sides that are not 0.
    pub columns: Vec<[usize; 2]>,
    /// Entries that are added to what is solved: row, column, place among the numbers of the bodies.
    pub followed: Vec<[usize; 3]>,
    /// For each speed those that reach it on their way to the root, the last one first, in ranges of speeds that follow each other.
    pub below: Vec<Vec<[usize; 2]>>,
    /// Where M̄⁻¹ begins, of which half is found.
    pub mirrored: Option<usize>,
}

impl Tables {
    /// Columns of what is solved with M̄, where something is.
    pub const fn solved_columns(&self) -> Option<usize> {
        match self.product {
            Product::Mass | Product::Inverse | Product::SecondInverse => None,
            Product::InverseMass | Product::Forward => Some(self.size[1]),
            Product::SecondForward => Some(self.places.sizes[0]),
        }
    }

    /// Numbers that loops need room for beside those of solutions.
    pub fn room_besides(&self) -> usize {
        let [freedoms, speeds] = self.places.sizes;
        let width = self.size[1];
        match self.product {
            Product::SecondForward => speeds * width + width + 4 * (freedoms + speeds).pow(2),
            _ => 0,
        }
    }

    /// Numbers that loops of one state need room for.
    pub fn room_of_one(&self) -> usize {
        let solution = |columns| room_to_solve(self.above.len(), columns);
        self.solved_columns().map_or(0, solution) + self.room_besides()
    }

    /// Numbers of eight states that loops side by side need room for.
    pub fn room_of_lanes(&self) -> usize {
        self.solved_columns()
            .map_or(0, |_| room_in_lanes(self.above.len()))
    }

    /// For each speed those towards the root, the nearest first, in ranges of speeds that follow each other.
    pub fn ranges(&self) -> Vec<Vec<[usize; 2]>> {
        let carriers = |speed: usize| std::iter::successors(self.above[speed], |&i| self.above[i]);
        let speeds = 0..self.above.len();
        speeds.map(|speed| descending(carriers(speed))).collect()
    }

    /// What the runtime makes with them.
    fn with_pairs<R>(&self, make: impl FnOnce(&Pairs<'_>) -> R) -> R {
        let above: Vec<Vec<[usize; 2]>> = self.ranges();
        let above: Vec<&[[usize; 2]]> = above.iter().map(Vec::as_slice).collect();
        let below: Vec<&[[usize; 2]]> = self.below.iter().map(Vec::as_slice).collect();
        make(&Pairs {
            places: self.places,
            slopes: &self.slopes,
            moved: &self.moved,
            joints: &self.joints,
            bodies: &self.bodies,
            above: &above,
            entries: &self.entries,
            masses: &self.masses,
            bends: &self.bends,
            held: &self.held,
            columns: &self.columns,
            followed: &self.followed,
            below: &below,
            mirrored: self.mirrored,
        })
    }

    /// Rows of what forward dynamics is solved for, from the numbers of the bodies.
    pub fn right_hand_sides(&self, work: &[f64]) -> Vec<f64> {
        let [rows, width] = self.size;
        let mut results = vec![0.0; rows * width];
        self.with_pairs(|pairs| {
            pairs.right_hand_sides(work, &mut results, width);
        });
        results
    }

    /// The results, row by row, from the numbers of the bodies.
    pub fn evaluate(&self, work: &[f64]) -> Vec<f64> {
        let [rows, width] = self.size;
        let mut results = vec![0.0; rows * width];
        let mut room = vec![0.0; self.room_of_one()];
        self.with_pairs(|pairs| match self.product {
            Product::Mass => pairs.mass(work, &mut results),
            Product::InverseMass => {
                pairs.inverse_mass(work, &mut room, &mut results);
            }
            Product::Inverse => pairs.inverse(work, &mut results),
            Product::Forward => {
                pairs.forward(work, &mut room, &mut results, width);
            }
            Product::SecondInverse => pairs.second_inverse(work, &mut results, width),
            Product::SecondForward => {
                pairs.second_forward(work, &mut room, &mut results, width);
            }
        });
        results
    }

    /// The same of eight states side by side.
    pub fn evaluate_in_lanes(&self, work: &[Lanes]) -> Vec<Lanes> {
        let [rows, width] = self.size;
        let mut results = vec![Lanes::default(); rows * width];
        let mut factors = vec![Lanes::default(); self.room_of_lanes()];
        let columns = self.strips(work.len());
        let strips = columns.iter().map(|strip| Strip {
            columns: strip.columns,
            rows: &strip.rows,
            end: strip.end,
        });
        let strips: Vec<Strip<'_>> = strips.collect();
        self.with_pairs(|pairs| match self.product {
            Product::Mass => pairs.mass_in_lanes(Plain, work, &mut results),
            Product::InverseMass => {
                pairs.inverse_mass_in_lanes(Plain, &strips, work, &mut factors, &mut results);
            }
            Product::Inverse => pairs.inverse_in_lanes(Plain, work, &mut results),
            // Second derivatives are of one state.
            Product::Forward | Product::SecondInverse | Product::SecondForward => {
                let rows = (&mut *results, width);
                pairs.forward_in_lanes(Plain, &strips, work, &mut factors, rows);
            }
        });
        results
    }

    /// What the loops take.
    pub fn operations(&self) -> Operations {
        let mut count = Operations::default();
        for joint in &self.joints {
            let (speeds, units) = sizes(joint);
            let mut carrier = joint.parent;
            while let Some(body) = carrier {
                let above = &self.bodies[body];
                let (others, other_units) = sizes(&self.joints[above.joint]);
                if !matches!(self.product, Product::Inverse | Product::SecondInverse) {
                    products(&mut count, speeds * others, 6);
                }
                if self.product.has_slopes() {
                    products(&mut count, units * others, 6);
                    products(&mut count, speeds * other_units, 9);
                }
                if self.product.has_bends() {
                    let (locals, other_locals) = (units - speeds, other_units - others);
                    products(&mut count, units * other_units, 3);
                    products(&mut count, locals * (other_units + others), 6);
                    products(&mut count, (units + speeds) * other_locals, 6);
                    count.additions += locals * other_units + units * other_locals;
                }
                carrier = above.parent;
            }
        }
        count.additions += self.added();
        if self.product == Product::SecondForward {
            let width = self.size[1];
            let freedoms = (width - self.above.len()) / 2;
            let terms = freedoms * width * self.above.len();
            count.multiplications += terms;
            count.additions += terms + 2 * freedoms * width;
        }
        if self.solved_columns().is_some() {
            self.solution(&mut count);
        }
        count
    }

    /// Whether eight states side by side can have these loops. What is prescribed moves to the right-hand sides of single states alone.
    pub const fn serves_lanes(&self) -> bool {
        self.held.is_empty() && self.size[1] >= STRIP
    }

    /// The columns that are solved for, in strips, where so many `numbers` of the bodies are read.
    pub fn strips(&self, numbers: usize) -> Vec<Columns> {
        let [rows, width] = self.size;
        // Numbers that tell where something is: sums of what has one sign are never 0.
        let sides = match self.product {
            Product::Forward => self.right_hand_sides(&vec![1.0; numbers]),
            _ => (0..rows * width)
                .map(|i| f64::from(u8::from(i % (width + 1) == 0)))
                .collect(),
        };
        let is_there = |row: usize, [from, to]: [usize; 2]| {
            sides[row * width + from..row * width + to]
                .iter()
                .any(|&side| side != 0.0)
        };
        let mut strips = vec![];
        for &[first, last] in &self.columns {
            // As wide as each other.
            let count = (last - first).div_ceil((last - first).div_ceil(STRIP));
            for from in (first..last).step_by(count) {
                let columns = [from, (from + count).min(last)];
                let wanted = self
                    .mirrored
                    .and_then(|first| columns[1].checked_sub(first));
                let end = wanted
                    .filter(|&end| end > 0)
                    .map_or(rows, |end| end.min(rows));
                let mut filled: Vec<bool> = (0..rows).map(|row| is_there(row, columns)).collect();
                // What is below is added to what is above: from the leaves to the root.
                for row in (0..end).rev() {
                    if let (true, Some(above)) = (filled[row], self.above[row]) {
                        filled[above] = true;
                    }
                }
                let rows = descending((0..end).rev().filter(|&row| filled[row]));
                strips.push(Columns { columns, rows, end });
            }
        }
        strips
    }

    /// Entries that come to others: those that stand alone are no additions.
    fn added(&self) -> usize {
        let mut places: Vec<[usize; 2]> = self.entries.iter().map(|&[i, j, _]| [i, j]).collect();
        places.sort_unstable();
        places.windows(2).filter(|pair| pair[0] == pair[1]).count()
    }

    /// Factors of M̄ and what is solved with them.
    fn solution(&self, count: &mut Operations) {
        let above = |speed: usize| std::iter::successors(self.above[speed], |&i| self.above[i]);
        for speed in 0..self.above.len() {
            let carriers = above(speed).count();
            count.divisions += 1;
            count.multiplications += carriers + carriers * (carriers + 1) / 2;
            count.additions += carriers * (carriers + 1) / 2;
        }
        let pairs = |speeds: usize| (0..speeds).map(|k| above(k).count()).sum::<usize>();
        for column in self.columns.iter().flat_map(|&[from, to]| from..to) {
            let place = self.mirrored.and_then(|first| column.checked_sub(first));
            let speeds = place.map_or(self.above.len(), |place| place + 1);
            count.multiplications += 2 * pairs(speeds) + speeds;
            count.additions += 2 * pairs(speeds);
        }
    }
}

/// Speeds from the last one to the first in ranges of those that follow each other: from the first to behind the last.
pub fn descending(speeds: impl Iterator<Item = usize>) -> Vec<[usize; 2]> {
    let mut ranges: Vec<[usize; 2]> = vec![];
    for i in speeds {
        match ranges.last_mut() {
            Some(last) if last[0] == i + 1 => last[0] = i,
            _ => ranges.push([i, i + 1]),
        }
    }
    ranges
}

/// Speeds and units of a joint.
fn sizes(joint: &Pairing) -> (usize, usize) {
    (joint.speeds[1], joint.speeds[1] + joint.freedoms[1])
}

/// Sums of products.
fn products(count: &mut Operations, sums: usize, terms: usize) {
    count.multiplications += sums * terms;
    count.additions += sums * (terms - 1);
}
