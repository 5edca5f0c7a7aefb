//! Where the numbers of the bodies stand that loops over pairs of joints read, and the tables of these loops.
//!
//! All numbers of a joint follow each other: like joints leave them at like places.

use super::{Tree, number};
use crate::graph::{Sym, section};
use crate::pairs::{Product, Tables};
use hamel_compiled::{Carrying, Pairing};
use num_traits::{One, Zero};

/// Rows of derivatives, and M̄.
type Entries<'a> = [&'a [Vec<Sym>]; 2];

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
                held: vec![],
                columns: vec![],
                followed: vec![],
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
        let is_mass = self.tables.product == Product::Mass;
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
                for &column in units.iter().filter(|_| !is_mass) {
                    self.entry([row, column], entries[0][row][column]);
                }
                for column in own.clone().take_while(|&column| column <= row) {
                    self.mass([row, column], entries[1]);
                }
            }
            if let Some(rates) = rates {
                self.efforts(index);
                for row in own {
                    self.entry([row, self.tables.size[1] - 1], rates[row]);
                }
            }
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
    fn others(&mut self, [rows, matrix]: Entries<'_>) {
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
        let is_mass = self.tables.product == Product::Mass;
        for row in 0..speeds {
            let columns =
                (0..freedoms + speeds).filter(|&c| !is_mass && by_column[c] != by_speed[row]);
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
        if self.tables.product == Product::Forward {
            let [_, freedoms, speeds] = self.tree.model.sizes();
            let plain = self.tables.held.is_empty() && self.is_plain();
            self.tables.mirrored = plain.then_some(freedoms + speeds);
            self.tables.columns = spans(&self.filled(), self.tables.mirrored);
        }
        (self.work, self.tables)
    }

    /// Which columns of the right-hand sides are not 0.
    fn filled(&self) -> Vec<bool> {
        let [rows, width] = self.tables.size;
        let mut filled = vec![false; width];
        // Numbers that tell where something is: sums of what is positive are never 0.
        let marks = self
            .work
            .iter()
            .map(|sym| f64::from(u8::from(!sym.is_zero())));
        let work: Vec<f64> = marks.collect();
        let mut marks = vec![0.0; rows * width];
        self.tables
            .pairs()
            .right_hand_sides(&work, &mut marks, width);
        for row in marks.chunks(width) {
            for (filled, &mark) in filled.iter_mut().zip(row) {
                *filled |= mark != 0.0;
            }
        }
        for &[_, column] in &self.tables.held {
            filled[column] = true;
        }
        // The rates are found already.
        filled[width - 1] = false;
        filled
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
