//! Where the numbers of the bodies stand that loops over pairs of joints read, and the tables of these loops.
//!
//! All numbers of a joint follow each other: like joints leave them at like places.

use super::{Tree, number};
use crate::graph::{Sym, section};
use crate::pairs::{Product, Tables};
use hamel_compiled::{Carrying, Pairing};
use num_traits::{One, Zero};

/// Rows of derivatives, M̄, and half of the Hessian of contracted inverse dynamics; what is not wanted is empty.
type Entries<'a> = [&'a [Vec<Sym>]; 3];

/// What each body of a joint shows to those it carries, and the joint to those that carry it.
type Contribution<'a> = (&'a [(usize, Vec<Sym>)], &'a [Sym]);

/// Numbers and tables as they grow.
pub(super) struct Layout<'a> {
    tree: &'a Tree<'a>,
    work: Vec<Sym>,
    tables: Tables,
    /// The place of each body that carries others in the tables.
    carrying: Vec<Option<usize>>,
}

impl<'a> Layout<'a> {
    pub(super) fn new(tree: &'a Tree<'a>, product: Product, size: [usize; 2]) -> Self {
        let carriers = tree.carriers().into_iter();
        Self {
            tree,
            work: vec![],
            carrying: vec![None; tree.bodies.len()],
            tables: Tables {
                product,
                size,
                joints: vec![],
                bodies: vec![],
                above: carriers.map(|all| all.first().copied()).collect(),
                entries: vec![],
                masses: vec![],
                bends: vec![],
                held: vec![],
                columns: vec![],
                followed: vec![],
                filled: vec![],
                below: vec![],
                mirrored: None,
            },
        }
    }

    /// The contributions of all joints, one per body, or none; after those of a joint the entries between its own units.
    pub(super) fn place<'b>(
        &mut self,
        all: impl Iterator<Item = Contribution<'b>>,
        entries: Entries<'_>,
        rates: Option<&[Sym]>,
    ) {
        let has_slopes = self.tables.has_slopes();
        let mut all = all.fuse();
        for (index, body) in self.tree.bodies.iter().enumerate() {
            let contribution = all.next();
            if !self.tree.model.bodies[index].leads() {
                continue;
            }
            section(number(index), "pairs");
            if let Some(contribution) = contribution {
                self.contribution(index, contribution);
            }
            let (own, units) = (body.share.speeds.clone(), self.tree.places(index));
            for row in own.clone() {
                for &column in units.iter().filter(|_| has_slopes) {
                    self.entry([row, column], entries[0][row][column]);
                }
                for column in own.clone().take_while(|&column| column <= row) {
                    self.mass([row, column], entries[1]);
                }
            }
            if matches!(
                self.tables.product,
                Product::Forward | Product::SecondForward
            ) {
                self.efforts(index);
            }
            for (row, rates) in own.filter_map(|row| Some((row, rates?))) {
                self.entry([row, self.tables.size[1] - 1], rates[row]);
            }
            self.bends(index, entries[2]);
        }
        self.others(entries);
        let followed = rates.map(|rates| self.tree.followed_variations(rates));
        for (column, row, value) in followed.into_iter().flatten() {
            self.tables.followed.push([row, column, self.work.len()]);
            self.work.push(value.settled());
        }
    }

    fn contribution(&mut self, index: usize, (seen, shown): Contribution<'_>) {
        let tree = self.tree;
        let joint = self.tables.joints.len();
        let share = &tree.bodies[index].share;
        let parent = |body: usize| tree.bodies[body].parent;
        for (body, seen) in seen {
            self.carrying[*body] = Some(self.tables.bodies.len());
            self.tables.bodies.push(Carrying {
                joint,
                parent: parent(*body).and_then(|parent| self.carrying[parent]),
                seen: self.work.len(),
            });
            self.work.extend(seen);
        }
        self.tables.joints.push(Pairing {
            speeds: [share.speeds.start, share.speeds.len()],
            freedoms: [share.freedoms.start, share.freedoms.len()],
            parent: parent(index).and_then(|parent| self.carrying[parent]),
            shown: self.work.len(),
        });
        self.work.extend(shown);
    }

    fn entry(&mut self, [row, column]: [usize; 2], value: Sym) {
        if !value.is_zero() {
            self.tables.entries.push([row, column, self.work.len()]);
            self.work.push(value.settled());
        }
    }

    /// An entry of M̄ and its mirror image.
    fn mass(&mut self, [row, column]: [usize; 2], matrix: &[Vec<Sym>]) {
        let value = matrix.get(row).map_or(Sym::zero(), |row| row[column]);
        if value.is_zero() {
            return;
        }
        self.tables.masses.push([row, column, self.work.len()]);
        if row != column {
            self.tables.masses.push([column, row, self.work.len()]);
        }
        self.work.push(value.settled());
    }

    /// Entries of the Hessian between places of one joint.
    fn bends(&mut self, index: usize, rows: &[Vec<Sym>]) {
        let places = self.bent_places(index);
        for &row in places.iter().filter(|&&row| row < rows.len()) {
            for &column in places.iter().filter(|&&column| column <= row) {
                self.bend([row, column], rows[row][column]);
            }
        }
    }

    /// The places of a joint's units, rates and efforts.
    fn bent_places(&self, index: usize) -> Vec<usize> {
        let [_, freedoms, speeds] = self.tree.model.sizes();
        let share = &self.tree.bodies[index].share;
        let rates = share.speeds.clone().map(|speed| freedoms + speeds + speed);
        let efforts = share.freedoms.clone();
        let efforts = efforts.map(|effort| freedoms + 2 * speeds + effort);
        let units = self.tree.places(index).into_iter();
        units.chain(rates).chain(efforts).collect()
    }

    /// An entry of the Hessian and that across the diagonal.
    fn bend(&mut self, [row, column]: [usize; 2], value: Sym) {
        if value.is_zero() {
            return;
        }
        self.tables.bends.push([row, column, self.work.len()]);
        if row != column {
            self.tables.bends.push([column, row, self.work.len()]);
        }
        self.work.push(value.settled());
    }

    /// The columns of a joint's efforts: S̄ᵀ, or that its rates are given.
    fn efforts(&mut self, index: usize) {
        let tree = self.tree;
        let [_, freedoms, speeds] = tree.model.sizes();
        let body = &tree.bodies[index];
        let own = body.share.speeds.clone();
        for (b, basis) in body.basis.iter().enumerate() {
            let column = freedoms + speeds + body.share.freedoms.start + b;
            if tree.model.bodies[index].driven {
                let held = own.clone().nth(b).map(|speed| [speed, column]);
                self.tables.held.extend(held);
                continue;
            }
            for (row, &entry) in own.clone().zip(basis) {
                self.entry([row, column], entry);
            }
        }
    }

    /// Entries between units of different joints.
    fn others(&mut self, [rows, matrix, bends]: Entries<'_>) {
        let tree = self.tree;
        let [_, freedoms, speeds] = tree.model.sizes();
        let (mut by_speed, mut by_column) = (vec![0; speeds], vec![0; freedoms + speeds]);
        for (index, body) in tree.joints() {
            body.share
                .speeds
                .clone()
                .for_each(|speed| by_speed[speed] = index);
            tree.places(index)
                .into_iter()
                .for_each(|place| by_column[place] = index);
        }
        let mut owner = vec![0; 2 * (freedoms + speeds)];
        for (index, _) in tree.joints() {
            let places = self.bent_places(index).into_iter();
            places.for_each(|place| owner[place] = index);
        }
        for (row, entries) in bends.iter().enumerate() {
            for (column, &entry) in entries.iter().enumerate() {
                if owner[row] != owner[column] {
                    self.bend([row, column], entry);
                }
            }
        }
        let has_slopes = self.tables.has_slopes();
        for row in 0..speeds {
            let columns =
                (0..freedoms + speeds).filter(|&c| has_slopes && by_column[c] != by_speed[row]);
            for column in columns {
                self.entry([row, column], rows[row][column]);
            }
            for column in (0..row).filter(|&other| by_speed[other] != by_speed[row]) {
                self.mass([row, column], matrix);
            }
        }
    }

    /// The numbers and the tables.
    pub(super) fn finish(mut self) -> super::pairs::Paired {
        let [_, freedoms, speeds] = self.tree.model.sizes();
        match self.tables.product {
            Product::Mass | Product::Inverse | Product::SecondInverse => {}
            Product::SecondForward => {
                self.tables.columns = vec![[0, freedoms]];
                self.eliminated(vec![vec![true; freedoms]; speeds]);
            }
            Product::InverseMass => {
                let driven = (0..speeds).filter(|&speed| self.tree.is_driven(speed));
                self.tables.held = driven.map(|speed| [speed, 0]).collect();
                self.tables.mirrored = Some(0);
                self.tables.columns = vec![[0, speeds]];
                let unit = |row| (0..speeds).map(move |column| row == column).collect();
                self.eliminated((0..speeds).map(unit).collect());
            }
            Product::Forward => {
                let plain = self.tables.held.is_empty() && self.is_plain();
                self.tables.mirrored = plain.then_some(freedoms + speeds);
                let filled = self.filled();
                let any = |column| filled.iter().any(|row: &Vec<bool>| row[column]);
                let columns: Vec<bool> = (0..self.tables.size[1]).map(any).collect();
                self.tables.columns = spans(&columns, self.tables.mirrored);
                self.eliminated(filled);
            }
        }
        (self.work, self.tables)
    }

    /// Which entries of the right-hand sides are not 0, by rows.
    fn filled(&self) -> Vec<Vec<bool>> {
        let [_, width] = self.tables.size;
        // Numbers that tell where something is: sums of what is positive are never 0.
        let marks = self
            .work
            .iter()
            .map(|sym| f64::from(u8::from(!sym.is_zero())));
        let marks = self.tables.right_hand_sides(&marks.collect::<Vec<f64>>());
        let rows = marks.chunks(width).map(|row| {
            let filled = row.iter().map(|&mark| mark != 0.0);
            let mut filled: Vec<bool> = filled.collect();
            self.tables
                .held
                .iter()
                .for_each(|&[_, column]| filled[column] = true);
            // The rates are found already.
            filled[width - 1] = false;
            filled
        });
        rows.collect()
    }

    /// The tables of what is eliminated from the leaves to the root, where these entries of the right-hand sides are not 0.
    fn eliminated(&mut self, mut filled: Vec<Vec<bool>>) {
        let carriers = self.tree.carriers();
        self.tables.below = vec![vec![]; carriers.len()];
        for (k, carriers) in carriers.iter().enumerate().rev() {
            let own = filled[k].clone();
            for &i in carriers {
                self.tables.below[i].push(k);
                for (filled, &own) in filled[i].iter_mut().zip(&own) {
                    *filled |= own;
                }
            }
        }
        let word = |bits: &[bool]| {
            let places = bits.iter().enumerate();
            places.fold(0, |word, (place, &is_set)| {
                word | u64::from(is_set) << place
            })
        };
        let rows = filled.iter();
        self.tables.filled = rows.map(|row| row.chunks(64).map(word).collect()).collect();
    }

    /// Whether efforts are generalised forces of the speeds, one by one: S̄ = 1.
    fn is_plain(&self) -> bool {
        let unit = |i: usize, j: usize, entry: Sym| match i == j {
            true => entry == Sym::one(),
            false => entry.is_zero(),
        };
        self.tree.bodies.iter().all(|body| {
            let rows = body.basis.iter().enumerate();
            body.basis.len() == body.speeds.len()
                && rows
                    .into_iter()
                    .all(|(i, row)| (0..row.len()).all(|j| unit(i, j, row[j])))
        })
    }
}

/// What is marked, from the first to behind the last; what begins at `start` stands alone.
fn spans(marks: &[bool], start: Option<usize>) -> Vec<[usize; 2]> {
    let mut all: Vec<[usize; 2]> = vec![];
    for column in (0..marks.len()).filter(|&column| marks[column]) {
        match all.last_mut() {
            Some(last) if column == last[1] && start != Some(column) => last[1] = column + 1,
            _ => all.push([column, column + 1]),
        }
    }
    all
}
