//! What each body contributes to M̄ and to derivatives, read at one frame, so that loops over pairs of joints find the rest (`hamel_compiled::Pairs`).
//!
//! That frame is the root's body on the way from a body to the world: the mechanism may be anywhere in the world. What a joint contributes
//! to itself, and what elements, dampers and rotors do, is found here entry by entry.

use super::composite::Matrix;
use super::derivatives::{Rows, Shown};
use super::layout::Layout;
use super::variation::Variation;
use super::{Tree, number, to_parent, wrench_to_parent};
use crate::graph::{Argument, Sym, section};
use crate::pairs::{Product, Tables};
use crate::spatial::{Mat3, Step, Twist, Vec3, Wrench, apply, simplified};
use num_traits::Zero;

/// Numbers of the bodies, and the tables that say what is made of them.
pub type Paired = (Vec<Sym>, Tables);

/// What a body shows to those that it carries, and a joint to those that carry it.
#[derive(Clone, Default)]
pub(super) struct Contribution {
    /// Of each body of the joint that carries others: X̄, then W and U.
    pub(super) seen: Vec<(usize, Vec<Sym>)>,
    /// What each unit raises, then momenta; none where nothing carries the joint.
    pub(super) shown: Vec<Sym>,
}

/// Contributions, and what is found entry by entry.
#[derive(Default)]
pub(super) struct Found {
    /// One per body: those of joints stand at the bodies that stand for them.
    pub(super) contributions: Vec<Contribution>,
    /// Rows of derivatives.
    pub(super) rows: Rows,
    /// Own blocks of M̄.
    pub(super) matrix: Matrix,
    /// Half of the Hessian of contracted inverse dynamics, without pairs of different joints.
    pub(super) bends: Rows,
}

impl Tree<'_> {
    /// M̄.
    pub fn paired_mass(&self) -> Paired {
        self.paired_composites(Product::Mass)
    }

    /// M̄⁻¹.
    pub fn paired_inverse_mass(&self) -> Paired {
        self.paired_composites(Product::InverseMass)
    }

    fn paired_composites(&self, product: Product) -> Paired {
        let count = self.model.sizes()[2];
        let frames = self.root_frames();
        let mut found = self.nothing(count);
        self.composites(|index, composites| {
            let mut momenta = vec![Wrench::zero(); self.bodies[index].speeds.len()];
            let mut seen = vec![];
            for body in self.model.carried(index) {
                let columns = &self.bodies[body].columns;
                self.own_block(
                    body,
                    columns.iter().map(|x| composites[body].of(x)),
                    &mut found.matrix,
                );
                section(number(body), "pairs");
                for (sum, column) in momenta.iter_mut().zip(columns) {
                    let own = wrench_to_parent(&frames[body], &composites[body].of(column));
                    *sum = sum.plus(&own);
                }
                if self.carries(body) {
                    seen.push((body, self.seen_columns(body, &frames[body])));
                }
            }
            found.contributions[index] = Contribution {
                seen,
                shown: self.shown_by(index, momenta.iter().flat_map(of_wrench).collect()),
            };
        });
        self.add_armature(&mut found.matrix);
        self.tables(product, [count, count], found, None)
    }

    /// `∂τ̄/∂ϕ` and `∂τ̄/∂v̄` of inverse dynamics at v̄̇, the argument.
    pub fn paired_inverse(&self) -> Paired {
        let [_, freedoms, speeds] = self.model.sizes();
        let rates = (0..speeds).map(|i| Sym::input(Argument::Accelerations, i));
        let mut found = self.found((&rates.collect::<Vec<Sym>>(), false), None);
        found.matrix = vec![];
        self.tables(Product::Inverse, [speeds, freedoms + speeds], found, None)
    }

    /// `∂v̄̇/∂ϕ`, `∂v̄̇/∂v̄`, `∂v̄̇/∂τ` and v̄̇.
    pub fn paired_forward(&self) -> Paired {
        let [_, freedoms, speeds] = self.model.sizes();
        let rates = self.articulated_accelerations(super::Bias::Within);
        let mut found = self.found((&rates, true), Some(Argument::Efforts));
        self.add_armature(&mut found.matrix);
        let size = [speeds, 2 * freedoms + speeds + 1];
        self.tables(Product::Forward, size, found, Some(rates))
    }

    /// The same with all pairs found here: nothing but the solution is left to loops.
    pub fn solved_forward(&self) -> Paired {
        let [_, freedoms, speeds] = self.model.sizes();
        let rates = self.composite_accelerations();
        let found = Found {
            rows: self.needed_slopes(&rates, Some(Argument::Efforts)),
            matrix: self.mass_matrix(),
            ..Found::default()
        };
        let size = [speeds, 2 * freedoms + speeds + 1];
        self.tables(Product::Forward, size, found, Some(rates))
    }

    fn nothing(&self, width: usize) -> Found {
        let count = self.model.sizes()[2];
        Found {
            contributions: vec![Contribution::default(); self.bodies.len()],
            rows: vec![vec![Sym::zero(); width]; count],
            matrix: vec![vec![Sym::zero(); count]; count],
            bends: vec![],
        }
    }

    /// What derivatives at v̄̇ are made of; what bodies follow by themselves is left out where they are `solved` for.
    pub(super) fn found(
        &self,
        (rates, solved): (&[Sym], bool),
        efforts: Option<Argument>,
    ) -> Found {
        let [_, freedoms, speeds] = self.model.sizes();
        let frames = self.root_frames();
        let mut found = self.nothing(freedoms + speeds);
        self.carry((rates, solved), |index, carried, variations| {
            let mut sum: Option<Shown> = None;
            let mut seen = vec![];
            for body in self.model.carried(index) {
                section(number(body), "slope");
                let shown = self.shown(body, &carried[body], &variations[body], &mut found.rows);
                let momenta = shown.momenta.iter().map(|(momentum, _)| momentum.clone());
                self.own_block(body, momenta, &mut found.matrix);
                section(number(body), "pairs");
                if self.bodies[body].parent.is_some() {
                    let shown = shown.at_parent(&frames[body]);
                    sum = Some(match sum {
                        Some(others) => others.plus(shown),
                        None => shown,
                    });
                }
                if self.carries(body) {
                    let mut own = self.seen_columns(body, &frames[body]);
                    let units = variations[body].iter();
                    own.extend(units.flat_map(|unit| seen_unit(unit, &frames[body])));
                    seen.push((body, own));
                }
            }
            let shown = sum.map(of_shown).unwrap_or_default();
            found.contributions[index] = Contribution {
                seen,
                shown: self.shown_by(index, shown),
            };
        });
        self.add_acting_slopes(rates, efforts, &mut found.rows);
        found
    }

    /// A joint shows nothing where nothing carries it.
    pub(super) fn shown_by(&self, index: usize, shown: Vec<Sym>) -> Vec<Sym> {
        match self.bodies[index].parent {
            Some(_) => shown.into_iter().map(Sym::settled).collect(),
            None => vec![],
        }
    }

    /// Whether a body carries others.
    fn carries(&self, body: usize) -> bool {
        self.bodies.iter().any(|other| other.parent == Some(body))
    }

    /// The entries of M̄ between the speeds of one body's joint, without rotors.
    fn own_block(&self, body: usize, momenta: impl Iterator<Item = Wrench>, matrix: &mut Matrix) {
        let own = &self.bodies[body];
        let places = own.share.speeds.clone();
        for (j, momentum) in momenta.enumerate() {
            for k in j..places.len() {
                let (row, other) = (places.start + j, places.start + k);
                let entry = matrix[row][other] + own.columns[k].dot(&momentum);
                (matrix[row][other], matrix[other][row]) = (entry, entry);
            }
        }
    }

    pub(super) fn add_armature(&self, matrix: &mut Matrix) {
        for (index, body) in self.joints() {
            section(number(index), "rotors");
            let places = body.share.speeds.clone();
            for j in 0..places.len() {
                for k in 0..places.len() {
                    matrix[places.start + j][places.start + k] += self.armature(index, j, k);
                }
            }
        }
    }

    /// The frame of each body in that of its root's body.
    pub(super) fn root_frames(&self) -> Vec<Vec<Step>> {
        let mut places: Vec<(Mat3, Vec3)> = vec![];
        for (index, body) in self.bodies.iter().enumerate() {
            section(number(index), "place");
            let Some(parent) = body.parent else {
                places.push((Mat3::identity(), Vec3::zeros()));
                continue;
            };
            let (mut rotation, mut origin) = places[parent];
            for step in &body.steps {
                match step {
                    Step::Shift(by) => origin += apply(&rotation, by),
                    turn => {
                        let rows = [0, 1, 2].map(|i| turn.to_child(&rotation.row(i).transpose()));
                        rotation = Mat3::from_fn(|i, j| rows[i][j]);
                    }
                }
            }
            places.push((rotation.map(Sym::settled), origin.map(Sym::settled)));
        }
        let frame =
            |(rotation, origin)| simplified([Step::Shift(origin), Step::rotation(&rotation)]);
        places.into_iter().map(frame).collect()
    }

    /// X̄ at the root.
    fn seen_columns(&self, body: usize, frame: &[Step]) -> Vec<Sym> {
        let columns = self.bodies[body].columns.iter();
        columns
            .flat_map(|column| of_twist(&at_root(frame, column)))
            .collect()
    }

    /// The numbers of the bodies in order, body after body, and the tables.
    pub(super) fn tables(
        &self,
        product: Product,
        size: [usize; 2],
        found: Found,
        rates: Option<Vec<Sym>>,
    ) -> Paired {
        let mut layout = Layout::new(self, product, size);
        let all = found.contributions.iter();
        let all = all.map(|own| (&own.seen[..], &own.shown[..]));
        layout.place(
            all,
            [&found.rows, &found.matrix, &found.bends],
            rates.as_deref(),
        );
        layout.finish()
    }
}

pub(super) fn at_root(frame: &[Step], twist: &Twist) -> Twist {
    let steps = frame.iter().rev();
    steps.fold(twist.clone(), |twist, step| step.twist_to_parent(&twist))
}

pub(super) fn of_twist(twist: &Twist) -> Vec<Sym> {
    let both = twist.angular.iter().chain(&twist.linear);
    both.map(|entry| entry.settled()).collect()
}

pub(super) fn of_wrench(wrench: &Wrench) -> Vec<Sym> {
    wrench.moment.iter().chain(&wrench.force).copied().collect()
}

/// W and the angular part of U at the root.
fn seen_unit(unit: &Variation, frame: &[Step]) -> Vec<Sym> {
    let mut all = of_twist(&at_root(frame, &unit.rate));
    let drift = to_parent(frame, &unit.drift.angular);
    all.extend(drift.iter().map(|entry| entry.settled()));
    all
}

fn of_shown(shown: Shown) -> Vec<Sym> {
    let mut all: Vec<Sym> = shown.raised.iter().flat_map(of_wrench).collect();
    for (momentum, transposed) in &shown.momenta {
        all.extend(of_wrench(momentum));
        all.extend(transposed.iter());
    }
    all
}
