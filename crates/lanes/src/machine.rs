//! Runs programs: one operation after the other, each in a loop over many motions, which the compiler turns into SIMD code for each level of instructions.
//!
//! Products are fused with sums at the [level of instructions](hamel_sweep::level) that has such instructions, and rounded at the other. So results have the same bits with AVX2 and AVX-512, and by whichever
//! instructions the lower level is computed. What is computed for one motion depends on that motion alone.

use crate::program::{Operand, Operation, Program, Three, Two};
use fearless_simd::Level;
#[cfg(target_arch = "x86_64")]
use fearless_simd::prelude::*;
use hamel::scalar::{Lane, Scalar};
use hamel_compiler::graph::known;
use hamel_sweep::level;
use std::cell::Cell;

/// Motions whose numbers lie in one cache line.
pub const LANES: usize = 8;
/// Such groups of one row. The rows of a program for a few bodies then fit in the first cache.
const GROUPS: usize = 8;
/// Motions that go side by side.
pub const WIDTH: usize = LANES * GROUPS;

/// One number of eight motions.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Group([f64; LANES]);

/// One number of all motions.
type Row = [Cell<Group>; GROUPS];

/// The rows of a program.
#[derive(Debug)]
pub struct Machine {
    rows: Vec<Row>,
    level: Level,
    /// Whether products are fused with sums.
    is_fused: bool,
}

impl Machine {
    /// Room for the rows of `program`.
    pub fn new(program: &Program) -> Self {
        let zero = || std::array::from_fn(|_| Cell::new(Group([0.0; LANES])));
        Self {
            rows: (0..program.rows).map(|_| zero()).collect(),
            level: Level::new(),
            is_fused: fuses(),
        }
    }

    /// A number of a motion.
    pub fn get(&self, row: usize, motion: usize) -> f64 {
        self.rows[row][motion / LANES].get().0[motion % LANES]
    }

    /// Changes it.
    pub fn set(&mut self, row: usize, motion: usize, number: f64) {
        self.rows[row][motion / LANES].get_mut().0[motion % LANES] = number;
    }

    /// The largest size among the numbers of some rows; NaN counts as none.
    pub fn largest(&self, rows: std::ops::Range<usize>) -> f64 {
        let groups = self.rows[rows].iter().flatten();
        groups
            .flat_map(|group| group.get().0)
            .fold(0.0, |most, x| x.abs().max(most))
    }

    /// Runs operations with the best instructions that the machine has.
    pub fn run(&mut self, operations: &[Operation], numbers: &[f64]) {
        match self.is_fused {
            true => self.run_with::<true>(operations, numbers),
            false => self.run_with::<false>(operations, numbers),
        }
    }

    fn run_with<const FUSED: bool>(&self, operations: &[Operation], numbers: &[f64]) {
        let run = Run::<FUSED> {
            rows: &self.rows,
            numbers,
        };
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(simd) = self.level.as_avx512() {
                return simd.vectorize(
                    #[inline(always)]
                    || run.all(operations),
                );
            }
            if let Some(simd) = self.level.as_avx2() {
                return simd.vectorize(
                    #[inline(always)]
                    || run.all(operations),
                );
            }
        }
        run.all(operations);
    }
}

/// Whether the level of instructions has fused products. Processors that are not x86-64 have one level; where it may lack them, they would be calls of functions.
fn fuses() -> bool {
    match cfg!(target_arch = "x86_64") {
        true => level::level() != level::LEVELS[0],
        false => cfg!(target_arch = "aarch64"),
    }
}

/// What is read: a row, or a number for all.
trait At: Copy {
    fn at(self, group: usize) -> [f64; LANES];
}

impl At for &Row {
    #[inline(always)]
    fn at(self, group: usize) -> [f64; LANES] {
        self[group].get().0
    }
}

#[derive(Clone, Copy)]
struct Same(f64);

impl At for Same {
    #[inline(always)]
    fn at(self, _group: usize) -> [f64; LANES] {
        [self.0; LANES]
    }
}

struct Run<'a, const FUSED: bool> {
    rows: &'a [Row],
    numbers: &'a [f64],
}

/// Calls `$body` with what operands stand for, of either kind.
macro_rules! with {
    ($run:ident, [$($name:ident: $operand:expr),*], $body:expr) => {
        with!(@ $run, [$($name: $operand),*], $body)
    };
    (@ $run:ident, [], $body:expr) => { $body };
    (@ $run:ident, [$name:ident: $operand:expr $(, $rest:ident: $others:expr)*], $body:expr) => {
        match $operand {
            Operand::Row(row) => {
                let $name = $run.row(row);
                with!(@ $run, [$($rest: $others),*], $body)
            }
            Operand::Number(place) => {
                let $name = Same($run.numbers[place as usize]);
                with!(@ $run, [$($rest: $others),*], $body)
            }
        }
    };
}

impl<const FUSED: bool> Run<'_, FUSED> {
    #[inline(always)]
    fn all(&self, operations: &[Operation]) {
        for operation in operations {
            self.one(operation);
        }
    }

    #[inline(always)]
    fn row(&self, row: u32) -> &Row {
        &self.rows[row as usize]
    }

    #[inline(always)]
    fn one(&self, operation: &Operation) {
        match operation {
            Operation::Two(what, [a, b], to) => {
                let to = self.row(*to);
                with!(self, [a: *a, b: *b], match what {
                    Two::Add => self.two(to, a, b, |a, b| a + b),
                    Two::Subtract => self.two(to, a, b, |a, b| a - b),
                    Two::Multiply => self.two(to, a, b, |a, b| a * b),
                    Two::Divide => self.two(to, a, b, |a, b| a / b),
                    Two::Larger => self.two(to, a, b, |a, b| Lane::<FUSED>(a).larger(Lane(b)).0),
                });
            }
            Operation::Three(what, a, [b, c], to) => {
                let (to, a) = (self.row(*to), self.row(*a));
                with!(self, [b: *b, c: *c], match what {
                    Three::AddTo => self.three(to, a, b, c, Self::multiply_add),
                    Three::Less => self.three(to, a, b, c, |a, b, c| Self::multiply_add(a, b, -c)),
                    Three::From => self.three(to, a, b, c, |a, b, c| Self::multiply_add(-a, b, c)),
                });
            }
            Operation::Products(minus, [a, c], [b, d], to) => {
                let (to, a, c) = (self.row(*to), self.row(*a), self.row(*c));
                with!(self, [b: *b, d: *d], match minus {
                    false => self.four(to, [a, c], b, d, |a, b, c, d| Self::multiply_add(a, b, c * d)),
                    true => self.four(to, [a, c], b, d, |a, b, c, d| Self::multiply_add(a, b, -(c * d))),
                });
            }
            Operation::ExactSum(of, to) => self.exact_sum(*of, *to),
            Operation::Opposite(a, to) => self.of_one(*a, *to, |a| -a),
            Operation::Root(a, to) => self.of_one(*a, *to, f64::sqrt),
            Operation::SinCos(a, to) => self.sin_cos(*a, *to),
            Operation::Copy(a, to) => {
                let to = self.row(*to);
                with!(self, [a: *a], self.two(to, a, a, |a, _| a));
            }
            Operation::Call(..) | Operation::Several(..) => self.by_one(operation),
        }
    }

    /// a b + c.
    #[inline(always)]
    fn multiply_add(a: f64, b: f64, c: f64) -> f64 {
        Lane::<FUSED>(a).mul_add(Lane(b), Lane(c)).0
    }

    #[inline(always)]
    fn of_one(&self, a: u32, to: u32, f: impl Fn(f64) -> f64) {
        let a = self.row(a);
        self.two(self.row(to), a, a, |a, _| f(a));
    }

    #[inline(always)]
    fn two(&self, to: &Row, a: impl At, b: impl At, f: impl Fn(f64, f64) -> f64) {
        for (group, to) in to.iter().enumerate() {
            let (a, b, mut c) = (a.at(group), b.at(group), [0.0; LANES]);
            for i in 0..LANES {
                c[i] = f(a[i], b[i]);
            }
            to.set(Group(c));
        }
    }

    #[inline(always)]
    fn three(
        &self,
        to: &Row,
        a: impl At,
        b: impl At,
        c: impl At,
        f: impl Fn(f64, f64, f64) -> f64,
    ) {
        for (group, to) in to.iter().enumerate() {
            let (a, b, c) = (a.at(group), b.at(group), c.at(group));
            let mut d = [0.0; LANES];
            for i in 0..LANES {
                d[i] = f(a[i], b[i], c[i]);
            }
            to.set(Group(d));
        }
    }

    #[inline(always)]
    fn four(
        &self,
        to: &Row,
        [a, c]: [&Row; 2],
        b: impl At,
        d: impl At,
        f: impl Fn(f64, f64, f64, f64) -> f64,
    ) {
        for (group, to) in to.iter().enumerate() {
            let (a, b, c, d) = (a.at(group), b.at(group), c.at(group), d.at(group));
            let mut e = [0.0; LANES];
            for i in 0..LANES {
                e[i] = f(a[i], b[i], c[i], d[i]);
            }
            to.set(Group(e));
        }
    }

    /// By D. E. Knuth, without a branch.
    #[inline(always)]
    fn exact_sum(&self, [a, b]: [u32; 2], [sum, lost]: [u32; 2]) {
        let [a, b, sum, lost] = [a, b, sum, lost].map(|row| self.row(row));
        for group in 0..GROUPS {
            let (a, b) = (a.at(group), b.at(group));
            let (mut sums, mut rests) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                sums[i] = a[i] + b[i];
                let of_b = sums[i] - a[i];
                rests[i] = (a[i] - (sums[i] - of_b)) + (b[i] - of_b);
            }
            sum[group].set(Group(sums));
            lost[group].set(Group(rests));
        }
    }

    #[inline(always)]
    fn sin_cos(&self, of: u32, [sine, cosine]: [u32; 2]) {
        let (of, sine, cosine) = (self.row(of), self.row(sine), self.row(cosine));
        // Two groups at a time: each operation waits for the one before it, of the other group meanwhile.
        for pair in 0..GROUPS / 2 {
            let places = [2 * pair, 2 * pair + 1];
            let angles = places.map(|group| of.at(group));
            let (mut sines, mut cosines) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2]);
            for i in 0..LANES {
                for group in 0..2 {
                    let (s, c) = Lane::<FUSED>(angles[group][i]).sin_cos();
                    sines[group][i] = s.0;
                    cosines[group][i] = c.0;
                }
            }
            for (group, place) in places.into_iter().enumerate() {
                sine[place].set(Group(sines[group]));
                cosine[place].set(Group(cosines[group]));
            }
        }
    }

    /// What no loop over motions takes: one motion after the other.
    #[cold]
    #[inline(never)]
    fn by_one(&self, operation: &Operation) {
        let read = |operand: &Operand, group: usize, lane: usize| match operand {
            Operand::Row(row) => self.row(*row)[group].get().0[lane],
            Operand::Number(place) => self.numbers[*place as usize],
        };
        let write = |row: u32, group: usize, lane: usize, number: f64| {
            let cell = &self.row(row)[group];
            let mut numbers = cell.get();
            numbers.0[lane] = number;
            cell.set(numbers);
        };
        for (group, lane) in (0..GROUPS).flat_map(|group| (0..LANES).map(move |lane| (group, lane)))
        {
            match operation {
                Operation::Call(function, a, b, to) => {
                    let b = b.as_ref().map(|b| read(b, group, lane));
                    write(
                        *to,
                        group,
                        lane,
                        known::call(*function, read(a, group, lane), b),
                    );
                }
                Operation::Several(own) => {
                    let arguments = own.arguments.iter().map(|a| read(a, group, lane));
                    let results = known::primitive(own.function, &arguments.collect::<Vec<f64>>());
                    for (row, number) in own.results.iter().zip(results) {
                        write(*row, group, lane, number);
                    }
                }
                _ => {}
            }
        }
    }
}
