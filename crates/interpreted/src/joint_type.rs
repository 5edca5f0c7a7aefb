//! [`JointType`]: what a registry has of a joint that is interpreted.

use crate::facts;
use crate::joint::Interpreted;
use crate::kernels::Kernels;
use crate::sizes::{self, MOST_STORED, TooLarge};
use crate::tape::{Inputs, Places, Tape, assemble};
use hamel_codegen::derived::Derived;
use hamel_codegen::expr::Expr;
use hamel_codegen::formula::{Program, factored};
use hamel_codegen::model::Interval;
use hamel_runtime::erased::Shared;
use hamel_runtime::registry::{
    DuplicateJoint, JointRegistry, ParameterError, ParameterInfo, check_requirement, check_values,
};
use std::sync::Arc;

/// A joint's name is taken.
pub type NameTaken = DuplicateJoint;

/// A joint type that was derived while the program runs. Its names live as long as the program, as those of others.
#[derive(Clone, Debug)]
pub struct JointType {
    kernels: Arc<Kernels>,
    summary: &'static str,
    parameters: &'static [ParameterInfo],
    /// Parameters without a range: any number but 0.
    nonzero: Vec<usize>,
    /// Each as the spec writes it, and what must be positive.
    requirements: Vec<(&'static str, Tape)>,
    shape: sizes::Shape,
}

impl JointType {
    /// The type of a derived joint.
    ///
    /// # Errors
    /// A joint of more stored scalars, degrees of freedom or relations than there is room for.
    pub fn new(derived: &Derived) -> Result<Self, TooLarge> {
        let shape = sizes::Shape::of(derived)?;
        let spec = &derived.spec;
        let has_no_range = |place: &usize| {
            let parameter = spec.parameters.get(*place);
            parameter.is_some_and(|parameter| parameter.range == Interval::default())
        };
        let requirements = spec
            .requirements
            .iter()
            .map(|requirement| &requirement.value);
        let inputs = Inputs {
            arguments: vec![],
            parameters: spec.parameters.iter().map(|own| &own.symbol).collect(),
        };
        // As `build` of an emitted joint has it.
        let margin = |value: &Expr| Program {
            bindings: vec![],
            outputs: vec![factored(value).polished()],
        };
        Ok(Self {
            kernels: Arc::new(Kernels::new(derived, MOST_STORED)),
            summary: facts::line(derived),
            parameters: facts::parameters(derived),
            nonzero: (0..spec.parameters.len()).filter(has_no_range).collect(),
            requirements: requirements
                .map(|own| {
                    (
                        facts::kept(&own.text),
                        assemble(&margin(&own.value), &inputs),
                    )
                })
                .collect(),
            shape,
        })
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        self.kernels.facts.name
    }

    /// What is said of its parameters, in order.
    pub const fn parameters(&self) -> &'static [ParameterInfo] {
        self.parameters
    }

    /// The joint with these values of its parameters.
    ///
    /// # Errors
    /// Another number of values; the first that is not finite or out of range; a requirement that they break.
    pub fn build(&self, values: &[f64]) -> Result<Shared, ParameterError> {
        self.check(values)?;
        Ok(sizes::erased(self.shape, &self.kernels, values.into()))
    }

    /// The joint as a type of these sizes, without idle ones: N stored scalars, K degrees of freedom, S speeds, C constraints, R relations where these alone
    /// give Φ, and G = K + R. `None` where its sizes are others.
    ///
    /// # Errors
    /// Those of [`JointType::build`].
    pub fn exact<
        const N: usize,
        const K: usize,
        const S: usize,
        const C: usize,
        const R: usize,
        const G: usize,
    >(
        derived: &Derived,
        values: &[f64],
    ) -> Result<Option<Interpreted<N, K, S, C, R, G>>, ParameterError> {
        let shape = derived.shape;
        let relations = match derived.spec.implicit.is_some() {
            true => derived.relation_counts()[0],
            false => 0,
        };
        let found = [
            shape.configuration,
            shape.freedoms,
            shape.speeds,
            shape.constraints,
            relations,
            shape.freedoms + relations,
        ];
        let Some(own) = Self::new(derived)
            .ok()
            .filter(|_| found == [N, K, S, C, R, G])
        else {
            return Ok(None);
        };
        own.check(values)?;
        let kernels = Arc::new(Kernels::new(derived, N));
        Ok(Some(Interpreted::new(kernels, values.into())))
    }

    /// Adds the type to a registry.
    ///
    /// # Errors
    /// When the name is taken.
    pub fn register(&self, registry: &mut JointRegistry) -> Result<(), NameTaken> {
        let own = self.clone();
        let make = Arc::new(move |values: &[f64]| own.build(values));
        registry.insert_made((self.name(), self.summary), self.parameters, make)
    }

    /// As `build` of an emitted joint checks them.
    fn check(&self, values: &[f64]) -> Result<(), ParameterError> {
        let joint = self.name();
        check_values(joint, self.parameters, values)?;
        for (text, margin) in &self.requirements {
            let mut found = [f64::NAN];
            margin.run(&[], values, (&mut found, Places::IN_ORDER));
            check_requirement(joint, text, found[0], self.parameters, values)?;
        }
        for &place in &self.nonzero {
            if let (Some(info), Some(0.0)) = (self.parameters.get(place), values.get(place)) {
                return Err(ParameterError::OutOfRange {
                    joint,
                    parameter: info.name,
                    value: 0.0,
                    requirement: "other than 0",
                });
            }
        }
        Ok(())
    }
}
