//! The program of a sweep: one step of all rows whose scenes differ in numbers alone.

use crate::joints::Joints;
use crate::lower;
use crate::program::Program;
use crate::row::{Alone, Described, described};
use hamel::integrate::Tableau;
use hamel::registry::JointRegistry;
use hamel_compiler::numbers::{self, Shape};
use hamel_compiler::stepping::{Places, Scheme, Stepping, stepping};
use hamel_sweep::{Cells, Sweep};

/// Rows of a sample at most.
const SAMPLE: u64 = 32;

/// The rows, by their places from 0, that are the sample of a table of `rows` rows: evenly over it, the first and the last among them. So it depends on the table alone.
pub fn sample(rows: u64) -> impl Iterator<Item = u64> {
    let count = rows.min(SAMPLE);
    let last = u128::from(rows.saturating_sub(1));
    (0..count).map(move |number| match count {
        1 => 0,
        _ => (u128::from(number) * last / u128::from(count - 1)) as u64,
    })
}

/// The equations that the rows of a sweep move by: one step of all of them, and what a row must have for it.
#[derive(Clone, Debug)]
pub struct Plan {
    /// One step.
    pub(crate) program: Program,
    /// Where its numbers stand.
    pub(crate) places: Places,
    /// Of which method.
    tableau: &'static Tableau,
    shape: Shape,
    /// All numbers of a row; those that differ stand for others.
    numbers: Vec<f64>,
    /// Which of them differ from row to row.
    differing: Vec<usize>,
}

impl Plan {
    /// The equations of `sweep` for rows like those of a [`sample`](sample()). Numbers that differ within it may differ in every row. A row that changes another number moves by the tree.
    ///
    /// # Errors
    /// Why no row goes side by side, in words.
    pub fn new(sweep: &Sweep, registry: &JointRegistry, sample: &[Cells]) -> Result<Self, String> {
        if sweep.estimates() {
            return Err(
                "errors of motions are estimated; --no-error-estimate leaves that out".into(),
            );
        }
        let (joints, mut rows) = (Joints::default(), Vec::<Described>::new());
        let mut reason = "no row of a sample has a scene".to_owned();
        for cells in sample {
            match described(sweep, registry, &joints, cells) {
                Ok(row) => rows.push(row),
                Err(Alone::Refused(_)) => {}
                Err(Alone::Tree(why)) => reason = why,
            }
        }
        let Some(first) = rows.first() else {
            return Err(reason);
        };
        let alike = |row: &&Described| row.shape == first.shape && row.tableau == first.tableau;
        let same: Vec<&Described> = rows.iter().filter(alike).collect();
        let differs = |place: &usize| {
            let own = first.numbers[*place].to_bits();
            same.iter().any(|row| row.numbers[*place].to_bits() != own)
        };
        let differing: Vec<usize> = (0..first.numbers.len()).filter(differs).collect();
        let step = step(first, &differing)?;
        let inputs = step.places.numbers + differing.len();
        Ok(Self {
            program: lower::program(&step, inputs),
            places: step.places,
            tableau: first.tableau,
            shape: first.shape.clone(),
            numbers: first.numbers.clone(),
            differing,
        })
    }

    /// How many operations a step takes, and how many rows of numbers these take.
    pub fn size(&self) -> [usize; 2] {
        [self.program.step.len(), self.program.rows]
    }

    /// The numbers of a row that differ from row to row.
    ///
    /// # Errors
    /// In what it is not as the rows that the program is for, in words.
    pub(crate) fn numbers(&self, row: &Described) -> Result<Vec<f64>, String> {
        if row.tableau != self.tableau {
            return Err("its method is another than that of the sample".into());
        }
        if row.shape != self.shape {
            return Err("its equations have other terms than those of the sample".into());
        }
        let mut differing = self.differing.iter().peekable();
        for (place, (own, known)) in row.numbers.iter().zip(&self.numbers).enumerate() {
            if differing.next_if_eq(&&place).is_none() && own.to_bits() != known.to_bits() {
                return Err(
                    "it changes a number that is the same in all rows of the sample".into(),
                );
            }
        }
        let numbers = self.differing.iter().map(|&place| row.numbers[place]);
        let numbers: Vec<f64> = numbers.collect();
        match numbers.iter().all(|number| number.is_finite()) {
            true => Ok(numbers),
            false => Err("one of its numbers is not finite".into()),
        }
    }
}

/// One step of the row's model, where the numbers at `differing` are given.
///
/// Numbers that stand for those are put in their place, and found again on the graph. Were one of them used in arithmetic before, the graph would hold a constant that was computed from it. Two graphs, of two
/// sets of such numbers, show that: they must be the same.
fn step(row: &Described, differing: &[usize]) -> Result<Stepping, String> {
    let scheme = Scheme {
        matrix: row.tableau.matrix,
        weights: row.tableau.weights,
    };
    let made = |set: usize| {
        let marks: Vec<f64> = (0..differing.len())
            .map(|number| mark(set, number))
            .collect();
        let (mut model, mut links) = (row.model.clone(), row.links.clone());
        let mut all = row.numbers.clone();
        for (&place, &mark) in differing.iter().zip(&marks) {
            all[place] = mark;
        }
        numbers::replace(&mut model, &mut links, &all);
        stepping(&model, &links, scheme, &marks)
    };
    let (first, second) = (made(0)?, made(1)?);
    let operations = |step: &Stepping| -> Vec<_> {
        let nodes = step.graph.nodes.iter();
        nodes.map(|node| node.operation.clone()).collect()
    };
    if first.outputs != second.outputs || operations(&first) != operations(&second) {
        return Err("numbers that differ from row to row are computed with before its equations are written".into());
    }
    let outputs: Vec<_> = first.outputs.iter().map(|(_, value)| *value).collect();
    match first.graph.faults(&outputs).is_empty() {
        true => Ok(first),
        false => Err("its equations hold what is no number".into()),
    }
}

/// A number that stands for another: between 0.5 and 1.5, and such as no scene has.
fn mark(set: usize, number: usize) -> f64 {
    let seed = (set as u64) << 32 | number as u64;
    // The finaliser of SplitMix64 (S. Vigna), of which 53 bits are kept.
    let mut bits = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    0.5 + (bits >> 11) as f64 * 2_f64.powi(-53)
}
