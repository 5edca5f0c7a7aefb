//! Constraints that couple joints, as a scene gives them, and the speeds that depend on the others.

use super::acting::Held;
use super::emit::Function;
use super::equations::Tree;
use super::graph::{Argument, Sym, record};
use super::model::Model;
use super::prune::{Pruning, prune};
use hamel_runtime::elements::PointConstraint;
use hamel_runtime::mechanism::dependent_columns;
use hamel_scene::SceneDescription;
use nalgebra::DMatrix;

impl Model {
    /// Adds the constraints that couple joints. The speeds that depend on the others are those that the mechanism itself chooses.
    ///
    /// # Errors
    /// Constraints that depend on each other at time 0.
    pub(super) fn couple(&mut self, scene: &SceneDescription) -> Result<(), Vec<String>> {
        if scene.constraints.is_empty() {
            return Ok(());
        }
        let constraints = scene.constraints.iter();
        let constraints = constraints.map(|constraint| PointConstraint {
            name: constraint.name.value.clone(),
            body: constraint.body,
            point: constraint.point,
            direction: constraint.direction,
        });
        self.coupling.constraints = constraints.collect();
        let q = self.initial(scene)?;
        let matrix = self.constraint_matrix(&q);
        let dependent = dependent_columns(matrix, |speed| self.is_driven(speed));
        let names = &self.coupling.constraints;
        self.coupling.dependent = dependent.map_err(|rows| {
            let rows = rows.into_iter();
            rows.map(|(row, _)| format!("constraint `{}` depends on the others", names[row].name))
                .collect::<Vec<_>>()
        })?;
        Ok(())
    }

    /// All Q at time 0.
    fn initial(&self, scene: &SceneDescription) -> Result<Vec<f64>, Vec<String>> {
        let mut reasons = vec![];
        let mut all = vec![];
        for (index, own) in self.joints() {
            let body = &scene.bodies[index];
            let held = Held {
                what: "initial state",
                index,
                body,
                joint: &own.joint,
                parameters: &own.parameters,
            };
            match held.rest(&body.initial.position) {
                Ok(q) => all.extend(q),
                Err(reason) => reasons.push(reason),
            }
        }
        match reasons.is_empty() {
            true => Ok(all),
            false => Err(reasons),
        }
    }

    /// Aᵀ at a configuration.
    fn constraint_matrix(&self, q: &[f64]) -> DMatrix<f64> {
        let links = prune(self, Pruning::NONE);
        let (rows, graph) = record(|| {
            let rows = Tree::new(self, links).constraint_rows();
            rows.concat()
                .into_iter()
                .map(Sym::value)
                .collect::<Vec<_>>()
        });
        let matrix = Function {
            name: "constraint_matrix",
            summary: String::new(),
            arguments: vec![(Argument::Configuration, q.len())],
            graph,
            outputs: rows,
            columns: None,
            plan: None,
            packs: None,
            pairs: None,
        };
        let entries = matrix.evaluate(|_| q.to_vec());
        DMatrix::from_row_slice(self.coupling.constraints.len(), self.sizes()[2], &entries)
    }

    fn is_driven(&self, speed: usize) -> bool {
        let shares = self.shares().into_iter().zip(&self.bodies);
        let mut driven = shares.filter(|(_, body)| body.driven);
        driven.any(|(share, _)| share.speeds.contains(&speed))
    }
}
