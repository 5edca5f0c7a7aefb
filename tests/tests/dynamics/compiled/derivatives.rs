//! Compiled derivatives against the tree's.

use super::{
    BOUND, Evaluate, Point, acted_on, bare, flops, of_solutions, robots, scene_files, with_elements,
};
use hamel::dynamics::{
    Dynamics, ForwardDerivatives, InverseDerivatives, MassMatrix, Recursive, Sensitivity,
};
use hamel_compiler::functions::{Kind, Loops, compile};
use hamel_tests::{compiled, random, scenes};
use std::sync::Arc;

/// Size of the terms that cancel where a matrix of derivatives is 0, such as ∂τ̄/∂v̄ of a pendulum: speeds and efforts of random states are about 1.
const TERMS: f64 = 1.0;

/// A matrix: its number of columns, and its entries by rows.
type Part<'a> = (usize, &'a [f64]);

fn of(matrix: &Sensitivity) -> Part<'_> {
    (matrix.columns(), matrix.entries())
}

impl Point {
    fn derivatives_agree(self) {
        self.derivatives_agree_by(&compiled::evaluate);
    }

    /// Both functions have the tree's values.
    pub fn derivatives_agree_by(mut self, by: Evaluate<'_>) {
        let mut tree = Recursive::new(Arc::clone(&self.mechanism));
        tree.complete_speeds(&self.q, &mut self.speeds)
            .expect("constraints determine them");
        let mut inverse = InverseDerivatives::new(&self.mechanism);
        let rates = &self.inputs[..self.speeds.len()];
        tree.inverse_dynamics_derivatives(&self.q, &self.speeds, rates, &mut inverse)
            .expect("all that acts has slopes");
        let parts = [inverse.by_local(), inverse.by_speeds()].map(of);
        self.parts_agree(by, (Kind::InverseDerivatives, rates), &parts, BOUND);

        let mut mass = MassMatrix::new(&self.mechanism);
        tree.mass_matrix(&self.q, &mut mass).expect("sizes fit");
        let mut forward = ForwardDerivatives::new(&self.mechanism);
        tree.forward_dynamics_derivatives(&self.q, &self.speeds, &self.inputs, &mut forward)
            .expect("M̄ is regular");
        let mut parts = vec![
            of(forward.by_local()),
            of(forward.by_speeds()),
            of(forward.by_efforts()),
            (1, forward.rates()),
        ];
        let completed = forward.completed_speeds();
        parts.extend(completed.into_iter().flatten().map(of));
        let bound = of_solutions(mass.matrix());
        self.parts_agree(by, (Kind::ForwardDerivatives, &self.inputs), &parts, bound);
    }

    /// Matrices that stand side by side in the rows of a function are these.
    fn parts_agree(
        &self,
        by: Evaluate<'_>,
        (kind, inputs): (Kind, &[f64]),
        parts: &[Part<'_>],
        bound: f64,
    ) {
        let width: usize = parts.iter().map(|(columns, _)| columns).sum();
        let how = (kind, Loops::Never);
        let found = by(&self.model, how, &self.q, &self.speeds, inputs);
        assert_eq!(found.len(), width * self.speeds.len(), "{kind:?}");
        let mut start = 0;
        for (number, (columns, entries)) in parts.iter().enumerate() {
            let rows = found.chunks_exact(width.max(1));
            let own = rows.flat_map(|row| &row[start..start + columns]);
            let own: Vec<f64> = own.copied().collect();
            let what = format!("{kind:?}, part {number}");
            self.close_beside(TERMS, &what, &own, entries, bound);
            start += columns;
        }
    }
}

#[test]
fn derivatives_of_scenes_agree() {
    for (seed, (scene, model)) in (0..).zip(scene_files()) {
        let model = model.unwrap_or_else(|refused| panic!("{refused}"));
        if compile(&model, Kind::ForwardDerivatives, Loops::Never).is_ok() {
            Point::random(model, &scene.mechanism, seed).derivatives_agree();
        }
    }
}

#[test]
fn derivatives_of_robots_agree() {
    for (name, mechanism) in robots().filter(|(name, _)| *name != "ball32") {
        let point = Point::random(compiled::model(name, &mechanism), &mechanism, 1);
        point.derivatives_agree();
    }
}

#[test]
fn derivatives_of_random_trees_agree() {
    let kinds = random::library();
    for case in random::cases(&kinds, 8, 60) {
        bare(case).derivatives_agree();
    }
}

#[test]
fn derivatives_of_random_trees_with_elements_agree() {
    let kinds = random::library();
    for case in random::cases(&kinds, 5, 60) {
        with_elements(case).derivatives_agree();
    }
}

#[test]
fn what_a_scene_does_not_have_costs_no_derivatives() {
    let scene = scenes::load("plate_cart_arm");
    let whole = compiled::model("whole", &scene.mechanism);
    let mut floating = whole.clone();
    floating.gravity = hamel::nalgebra::Vector3::zeros();
    let mut shorter = whole.clone();
    shorter.bodies.pop();
    let mut damped = whole.clone();
    for body in &mut damped.bodies {
        body.damping = vec![0.1; body.joint.derived.shape.freedoms];
    }
    // Efforts of a wrench in the axes of its body, and slopes of a linear spring, may be constant.
    let springs = acted_on(&whole).into_iter();
    let bends = ["a smooth spring at a joint", "a spring between points"];
    let springs = springs.filter(|(what, _)| bends.contains(what));
    let more: Vec<_> = springs.chain([("dampers", damped)]).collect();
    for kind in [Kind::ForwardDerivatives, Kind::InverseDerivatives] {
        let count = flops(&whole, kind);
        for (what, model) in &more {
            let with = flops(model, kind);
            assert!(
                count < with,
                "{kind:?}: without {what} {count}, with {with}"
            );
        }
        for (what, model) in [("gravity", &floating), ("the last body", &shorter)] {
            let without = flops(model, kind);
            assert!(
                without < count,
                "{kind:?}: without {what} {without}, with {count}"
            );
        }
    }
}

/// Operations counted when this was written: a change that costs more is seen.
#[test]
fn operations_of_derivatives_stay_few() {
    let counts = [("panda7", 4989, 2963), ("anymal", 20_621, 5912)];
    for (name, mechanism) in robots() {
        let count = |kind| flops(&compiled::model(name, &mechanism), kind);
        for (_, forward, inverse) in counts.iter().filter(|(known, ..)| *known == name) {
            assert!(count(Kind::ForwardDerivatives) <= *forward, "{name}");
            assert!(count(Kind::InverseDerivatives) <= *inverse, "{name}");
        }
    }
}
