//! The mass matrix by composite rigid bodies, and its factorisation along the tree.

use super::{Tree, number, wrench_to_parent, wrenches_to_parent};
use crate::graph::{Argument, Sym, section};
use crate::spatial::{Rigid, Wrench};
use num_traits::Zero;

/// M̄ as a full matrix, with zeros where no path of the tree connects two speeds.
pub type Matrix = Vec<Vec<Sym>>;

/// `M̄ = LᵀDL`, which fills no zero of the tree.
pub(super) struct Factors {
    /// DL, in the lower triangle.
    matrix: Matrix,
    /// D⁻¹.
    inverses: Vec<Sym>,
    carriers: Vec<Vec<usize>>,
    sections: Vec<u32>,
}

impl Factors {
    /// `M̄⁻¹ b`, with a name for what that is.
    pub(super) fn solve(&self, mut right: Vec<Sym>, sought: &'static str) -> Vec<Sym> {
        self.inward(&mut right);
        for k in 0..right.len() {
            right[k] = self.outward(&right, k).named(sought);
        }
        right
    }

    /// M̄⁻¹; half of its entries are found, since it is symmetric.
    pub(super) fn inverse(&self) -> Matrix {
        let size = self.inverses.len();
        let mut inverse = vec![vec![Sym::zero(); size]; size];
        for unit in 0..size {
            let mut column = vec![Sym::zero(); size];
            column[unit] = Sym::Number(1.0);
            self.inward(&mut column);
            for k in 0..=unit {
                column[k] = self.outward(&column, k);
                (inverse[k][unit], inverse[unit][k]) = (column[k], column[k]);
            }
        }
        inverse
    }

    /// `L⁻ᵀ b`, in place.
    fn inward(&self, right: &mut [Sym]) {
        for k in (0..right.len()).rev() {
            section(self.sections[k], "load");
            for &i in &self.carriers[k] {
                let less = self.matrix[k][i] * self.inverses[k] * right[k];
                right[i] -= less;
            }
        }
    }

    /// Entry k of `(DL)⁻¹ x`, where those of its carriers are known.
    fn outward(&self, x: &[Sym], k: usize) -> Sym {
        section(self.sections[k], "response");
        let carriers = self.carriers[k].iter();
        let carried: Sym = carriers.map(|&i| self.matrix[k][i] * x[i]).sum();
        (x[k] - carried) * self.inverses[k]
    }
}

impl Tree<'_> {
    /// M̄(Q).
    pub fn mass_matrix(&self) -> Matrix {
        let count = self.model.sizes()[2];
        let mut matrix = vec![vec![Sym::zero(); count]; count];
        self.composites(|index, composites| {
            let body = &self.bodies[index];
            for (j, place) in body.share.speeds.clone().enumerate() {
                self.fill_row(index, (j, place), composites, &mut matrix);
            }
        });
        matrix
    }

    /// The inertia that each body carries, itself included, from the leaves to the root; `visit` sees those of a joint's bodies and of all behind them.
    pub(super) fn composites(&self, mut visit: impl FnMut(usize, &[Rigid])) {
        let mut composites: Vec<Rigid> = self
            .links
            .iter()
            .map(|link| link.inertia.on_graph())
            .collect();
        let mut seen: Vec<Vec<Rigid>> = self.bodies.iter().map(|_| vec![]).collect();
        for (index, body) in self.bodies.iter().enumerate().rev() {
            section(number(index), "composite inertia");
            for inertia in std::mem::take(&mut seen[index]) {
                composites[index] = composites[index].plus(&inertia);
            }
            // All other bodies of the joint come before in this order.
            if self.model.bodies[index].leads() {
                visit(index, &composites);
                section(number(index), "composite inertia");
            }
            if let Some(parent) = body.parent {
                seen[parent].push(composites[index].to_parent(&body.steps).settled());
            }
        }
    }

    /// The entries of one speed with those of its own joint and of the joints that carry it.
    fn fill_row(
        &self,
        index: usize,
        (j, place): (usize, usize),
        composites: &[Rigid],
        matrix: &mut Matrix,
    ) {
        let own = &self.bodies[self.model.carried(index)];
        let composites = &composites[self.model.carried(index)];
        let bodies = own.iter().zip(composites);
        let momenta = bodies.map(|(body, composite)| composite.of(&body.columns[j]));
        let momenta: Vec<Wrench> = momenta.collect();
        for (k, other) in own[0].share.speeds.clone().enumerate().skip(j) {
            let bodies = own.iter().zip(&momenta);
            let bodies = bodies.map(|(body, momentum)| body.columns[k].dot(momentum));
            let entry = bodies.sum::<Sym>() + self.armature(index, j, k);
            (matrix[place][other], matrix[other][place]) = (entry, entry);
        }
        let mut carrier = own[0].parent.map(|parent| {
            let bodies = own.iter().map(|body| &body.steps[..]);
            (parent, wrenches_to_parent(bodies.zip(momenta)))
        });
        while let Some((carries, momentum)) = carrier {
            let body = &self.bodies[carries];
            for (k, other) in body.share.speeds.clone().enumerate() {
                let entry = body.columns[k].dot(&momentum);
                (matrix[place][other], matrix[other][place]) = (entry, entry);
            }
            let raised = |parent| (parent, wrench_to_parent(&body.steps, &momentum));
            carrier = body.parent.map(raised);
        }
    }

    /// v̄̇ from the efforts of the argument and of the scene: M̄ factorised as `LᵀDL`, which fills no zero of the tree.
    pub fn composite_accelerations(&self) -> Vec<Sym> {
        let forces = self.inverse_dynamics(None);
        let matrix = self.mass_matrix();
        let mut right = vec![Sym::zero(); forces.len()];
        for (index, body) in self.joints() {
            section(number(index), "effort");
            for (place, effort) in body
                .share
                .speeds
                .clone()
                .zip(self.efforts(index, Some(Argument::Efforts)))
            {
                right[place] = effort - forces[place];
            }
        }
        self.solved(matrix, right, Argument::Efforts, "acceleration")
    }

    /// v̄ with M̄ v̄ = p̄, the argument.
    pub fn composite_speeds(&self) -> Vec<Sym> {
        let count = self.model.sizes()[2];
        let momenta = (0..count).map(|i| Sym::input(Argument::Momenta, i));
        self.solved(
            self.mass_matrix(),
            momenta.collect(),
            Argument::Momenta,
            "speed",
        )
    }

    /// `M̄⁻¹ b`, with a name for what that is; an argument holds the rates of driven joints.
    fn solved(
        &self,
        mut matrix: Matrix,
        mut right: Vec<Sym>,
        given: Argument,
        sought: &'static str,
    ) -> Vec<Sym> {
        self.prescribe(&mut matrix, &mut right, given);
        self.factorised(matrix).solve(right, sought)
    }

    /// `M̄ = LᵀDL`.
    pub(super) fn factorised(&self, mut matrix: Matrix) -> Factors {
        let carriers = self.carriers();
        let sections = self.sections();
        let mut inverses = vec![Sym::zero(); matrix.len()];
        for k in (0..matrix.len()).rev() {
            section(sections[k], "factor");
            let index = sections[k] as usize;
            let own = k - self.bodies[index].share.speeds.start;
            inverses[k] = self.inverse_of_inertia(index, own, matrix[k][k]);
            for (place, &i) in carriers[k].iter().enumerate() {
                let factor = matrix[k][i] * inverses[k];
                for &j in &carriers[k][place..] {
                    let less = factor * matrix[k][j];
                    matrix[i][j] -= less;
                    matrix[j][i] = matrix[i][j];
                }
            }
        }
        Factors {
            matrix,
            inverses,
            carriers,
            sections,
        }
    }

    /// Makes the rates of driven joints known: what they take of the others moves to the right-hand side.
    pub(super) fn prescribe(&self, matrix: &mut Matrix, right: &mut [Sym], argument: Argument) {
        for (index, body) in self.joints() {
            let Some(given) = self.prescribed(index, argument) else {
                continue;
            };
            for (place, rate) in body.share.speeds.clone().zip(given) {
                section(number(index), "prescribed motion");
                for (row, right) in right.iter_mut().enumerate() {
                    *right -= matrix[row][place] * rate;
                }
                hold(matrix, place);
                right[place] = rate;
            }
        }
    }

    /// The speeds that each speed's momentum reaches: those before it in its own joint and those of all joints that carry it, nearest
    /// first.
    pub(super) fn carriers(&self) -> Vec<Vec<usize>> {
        let mut carriers: Vec<Vec<usize>> = vec![];
        for (_, body) in self.joints() {
            for place in body.share.speeds.clone() {
                let own = (body.share.speeds.start..place).rev();
                let mut all: Vec<usize> = own.collect();
                let mut parent = body.parent;
                while let Some(index) = parent {
                    all.extend(self.bodies[index].share.speeds.clone().rev());
                    parent = self.bodies[index].parent;
                }
                carriers.push(all);
            }
        }
        carriers
    }

    /// The section of each speed.
    fn sections(&self) -> Vec<u32> {
        let joints = self.joints();
        joints
            .flat_map(|(index, body)| body.share.speeds.clone().map(move |_| number(index)))
            .collect()
    }
}

/// Makes a speed's rate its own right-hand side, which no other feels.
pub(super) fn hold(matrix: &mut Matrix, place: usize) {
    for row in matrix.iter_mut() {
        row[place] = Sym::zero();
    }
    matrix[place].fill(Sym::zero());
    matrix[place][place] = Sym::Number(1.0);
}
