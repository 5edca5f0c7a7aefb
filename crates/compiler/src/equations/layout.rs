//! Where the numbers of the bodies stand that loops over pairs of joints read, and the tables of these loops.

use super::meetings;
use super::{Tree, number};
use crate::graph::{Sym, section};
use crate::pairs::{Product, Tables, descending};
use hamel_compiled::{BEHIND, Carrying, Pairing, Places};
use num_traits::{One, Zero};

/// Rows of derivatives, M̄, and half of the Hessian of contracted inverse dynamics; what is not wanted is empty.
type Entries<'a> = [&'a [Vec<Sym>]; 3];

/// What each body of a joint shows to those it carries, and the joint to those that carry it.
type Contribution<'a> = (&'a [(usize, Vec<Sym>)], &'a [Sym]);

/// Numbers of a twist or wrench, of what a unit or a speed has beside it, and of a moment.
const SIX: usize = 6;
const NINE: usize = 9;
const THREE: usize = 3;

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
                places: Places {
                    sizes: [tree.model.sizes()[1], tree.model.sizes()[2]],
                    ..Places::default()
                },
                joints: vec![],
                bodies: vec![],
                slopes: vec![],
                moved: vec![],
                above: carriers.map(|all| all.first().copied()).collect(),
                entries: vec![],
                masses: vec![],
                bends: vec![],
                held: vec![],
                columns: vec![],
                followed: vec![],
                below: vec![],
                mirrored: None,
            },
        }
    }

    /// The contributions of all joints, one per body, or none; behind them, joint after joint, the entries between its own units.
    pub(super) fn place<'b>(
        &mut self,
        all: impl Iterator<Item = Contribution<'b>>,
        entries: Entries<'_>,
        rates: Option<&[Sym]>,
    ) {
        let all: Vec<Contribution<'b>> = all.collect();
        self.give_places(&all);
        let leading = all.iter().enumerate();
        for (index, &contribution) in leading.filter(|&(i, _)| self.tree.model.bodies[i].leads()) {
            section(number(index), "pairs");
            self.contribution(index, contribution);
        }
        meetings::find(&mut self.tables);
        self.own_entries(entries, rates);
        self.others(entries);
        let followed = rates.map(|rates| self.tree.followed_variations(rates));
        for (column, row, value) in followed.into_iter().flatten() {
            self.followed([row, column], value);
        }
    }

    /// Room for what bodies contribute.
    fn give_places(&mut self, all: &[Contribution<'_>]) {
        let Some(layers) = all.iter().map(|(seen, _)| seen.len()).max() else {
            return;
        };
        let product = self.tables.product;
        let places = &mut self.tables.places;
        let [freedoms, speeds] = places.sizes;
        places.layers = layers;
        places.momentum = SIX;
        let mut end = 0;
        let mut next = |numbers: usize| {
            end += numbers;
            end - numbers
        };
        places.columns = next(SIX * places.column_stride());
        if product.has_columns() {
            places.momentum = NINE;
            places.variations = next(NINE * places.variation_stride());
            places.raised = next(SIX * places.width());
        }
        places.momenta = next(places.momentum * speeds);
        if product.has_bends() {
            places.drifts = next(SIX * layers * freedoms);
            places.by_rate = next(SIX * freedoms);
            places.by_drift = next(THREE * places.width());
        }
        // What stands by component is read eight numbers at once.
        let least = places.momenta + BEHIND;
        self.work = vec![Sym::zero(); end.max(least)];
    }

    /// Entries between the units of a joint, joint after joint.
    fn own_entries(&mut self, entries: Entries<'_>, rates: Option<&[Sym]>) {
        let has_slopes = self.tables.product.has_slopes();
        for (index, body) in self.tree.bodies.iter().enumerate() {
            if !self.tree.model.bodies[index].leads() {
                continue;
            }
            section(number(index), "pairs");
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
                self.followed([row, self.tables.size[1] - 1], rates[row]);
            }
            self.bends(index, entries[2]);
        }
    }

    fn contribution(&mut self, index: usize, (seen, shown): Contribution<'_>) {
        let tree = self.tree;
        let joint = self.tables.joints.len();
        let share = &tree.bodies[index].share;
        let parent = |body: usize| tree.bodies[body].parent;
        for (layer, (body, seen)) in seen.iter().enumerate() {
            self.carrying[*body] = Some(self.tables.bodies.len());
            self.tables.bodies.push(Carrying {
                joint,
                parent: parent(*body).and_then(|parent| self.carrying[parent]),
                layer,
            });
            self.seen(index, layer, seen);
        }
        self.tables.joints.push(Pairing {
            speeds: [share.speeds.start, share.speeds.len()],
            freedoms: [share.freedoms.start, share.freedoms.len()],
            parent: parent(index).and_then(|parent| self.carrying[parent]),
        });
        self.shown(index, shown);
    }

    /// X̄, W and U, and virtual drifts of a body that carries others.
    fn seen(&mut self, index: usize, layer: usize, numbers: &[Sym]) {
        let places = self.tables.places;
        let [freedoms, speeds] = places.sizes;
        let (tree, mut numbers) = (self.tree, numbers.iter().copied());
        let share = &tree.bodies[index].share;
        for speed in share.speeds.clone() {
            let first = places.columns + layer * speeds + speed;
            self.put(first, places.column_stride(), numbers.by_ref().take(SIX));
        }
        if self.tables.product.has_columns() {
            for column in tree.places(index) {
                let first = places.variations + layer * places.width() + column;
                let stride = places.variation_stride();
                self.put(first, stride, numbers.by_ref().take(NINE));
            }
        }
        if self.tables.product.has_bends() {
            for freedom in share.freedoms.clone() {
                let first = places.drifts + SIX * (layer * freedoms + freedom);
                self.put(first, 1, numbers.by_ref().take(SIX));
            }
        }
    }

    /// What a joint shows to those that carry it: wrenches and momenta, and what second derivatives need of it.
    fn shown(&mut self, index: usize, numbers: &[Sym]) {
        let places = self.tables.places;
        let (tree, mut numbers) = (self.tree, numbers.iter().copied());
        let share = &tree.bodies[index].share;
        if self.tables.product.has_columns() {
            for column in tree.places(index) {
                let first = places.raised + column;
                self.put(first, places.width(), numbers.by_ref().take(SIX));
            }
        }
        for speed in share.speeds.clone() {
            let first = places.momenta + places.momentum * speed;
            self.put(first, 1, numbers.by_ref().take(places.momentum));
        }
        if self.tables.product.has_bends() {
            for freedom in share.freedoms.clone() {
                self.put(
                    places.by_rate + SIX * freedom,
                    1,
                    numbers.by_ref().take(SIX),
                );
            }
            for column in tree.places(index) {
                let first = places.by_drift + THREE * column;
                self.put(first, 1, numbers.by_ref().take(THREE));
            }
        }
    }

    /// Numbers at places `stride` apart.
    fn put(&mut self, first: usize, stride: usize, numbers: impl Iterator<Item = Sym>) {
        for (i, number) in numbers.enumerate() {
            self.work[first + stride * i] = number;
        }
    }

    fn entry(&mut self, [row, column]: [usize; 2], value: Sym) {
        if !value.is_zero() {
            self.tables.entries.push([row, column, self.work.len()]);
            self.work.push(value.settled());
        }
    }

    /// An entry that is added to what is solved.
    fn followed(&mut self, [row, column]: [usize; 2], value: Sym) {
        self.tables.followed.push([row, column, self.work.len()]);
        self.work.push(value.settled());
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
        let has_slopes = self.tables.product.has_slopes();
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
        let [freedoms, speeds] = self.tables.places.sizes;
        match self.tables.product {
            Product::Mass | Product::Inverse | Product::SecondInverse => {}
            Product::SecondForward => self.tables.columns = vec![[0, freedoms]],
            Product::InverseMass => {
                let driven = (0..speeds).filter(|&speed| self.tree.is_driven(speed));
                self.tables.held = driven.map(|speed| [speed, 0]).collect();
                self.tables.mirrored = Some(0);
                self.tables.columns = vec![[0, speeds]];
            }
            Product::Forward => {
                let plain = self.tables.held.is_empty() && self.is_plain();
                self.tables.mirrored = plain.then_some(freedoms + speeds);
                self.tables.columns = spans(&self.filled(), self.tables.mirrored);
            }
        }
        if self.tables.solved_columns().is_some() {
            self.tables.below = self.below();
        }
        (self.work, self.tables)
    }

    /// Which columns of the right-hand sides are not 0.
    fn filled(&self) -> Vec<bool> {
        let [_, width] = self.tables.size;
        // Numbers that tell where something is: sums of what has one sign are never 0.
        let marks = self
            .work
            .iter()
            .map(|sym| f64::from(u8::from(!sym.is_zero())));
        let marks = self.tables.right_hand_sides(&marks.collect::<Vec<f64>>());
        let mut filled = vec![false; width];
        for row in marks.chunks(width) {
            for (filled, &mark) in filled.iter_mut().zip(row) {
                *filled |= mark != 0.0;
            }
        }
        for &[_, column] in &self.tables.held {
            filled[column] = true;
        }
        filled
    }

    /// For each speed those that reach it on their way to the root.
    fn below(&self) -> Vec<Vec<[usize; 2]>> {
        let carriers = self.tree.carriers();
        let mut below = vec![vec![]; carriers.len()];
        for (k, carriers) in carriers.iter().enumerate().rev() {
            carriers.iter().for_each(|&i| below[i].push(k));
        }
        let below = below.into_iter();
        below.map(|all| descending(all.into_iter())).collect()
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
