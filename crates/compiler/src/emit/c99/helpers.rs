//! What functions use: names and arguments that they read, and functions of the runtime that C does not have, which a module brings along.

use super::super::lines::Formula;
use super::super::{Function, Lowered};
use super::formula::{adds_product, literal};
use crate::alike::Read;
use crate::graph::Argument;
use crate::pairs::Product;
use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::Function as Known;
use hamel_runtime::scalar::Scalar;
use serde::Serialize;
use std::collections::BTreeSet;

/// Terms of the Stumpff series in the template, two orders apart.
const STUMPFF_TERMS: usize = 14;

/// What formulas read and call.
#[derive(Default)]
pub struct Used {
    /// Values of earlier lines.
    pub names: BTreeSet<String>,
    /// Whether the array of sines is read.
    pub sines: bool,
    /// Whether the array of cosines is read.
    pub cosines: bool,
    arguments: BTreeSet<Argument>,
    mul_add: bool,
    curve: bool,
    dexp_inverse: bool,
    sech: bool,
    ln_cosh: bool,
    ln_1p_scaled: bool,
    /// Orders of Stumpff functions.
    stumpff: Option<u8>,
    primitives: Vec<Primitive>,
    products: Vec<Product>,
}

/// The helpers that a module brings along, for the templates.
#[derive(Serialize)]
pub struct Helpers {
    mul_add: bool,
    curve: bool,
    dexp_inverse: bool,
    sech: bool,
    ln_cosh: bool,
    ln_1p_scaled: bool,
    stumpff: bool,
    rotation_vector: bool,
    quaternion_vector: bool,
    nearest_rotation: bool,
    /// Loops over pairs of joints.
    pairs: bool,
    mass: bool,
    inverse_mass: bool,
    inverse: bool,
    forward: bool,
    second_inverse: bool,
    second_forward: bool,
    /// 1/n! as far as Stumpff functions take them.
    inverse_factorials: Vec<String>,
}

impl Used {
    /// Takes note of what a function uses.
    pub fn note(&mut self, lowered: &Lowered) {
        for line in &lowered.lines {
            line.each_formula(&mut |formula| self.of(formula));
        }
        for output in lowered.outputs.iter().flatten() {
            output.each(&mut |formula| self.of(formula));
        }
    }

    /// Takes note of loops over pairs of joints.
    pub fn note_pairs(&mut self, function: &Function) {
        self.products
            .extend(function.pairs.as_ref().map(|pairs| pairs.product));
    }

    /// Takes note of sines and cosines of many states, which are polynomials.
    pub fn note_turns(&mut self) {
        self.mul_add = true;
    }

    fn of(&mut self, formula: &Formula) {
        match formula {
            Formula::Name(name) => {
                self.names.insert(name.clone());
            }
            Formula::Input(Read::Argument(argument), _) => {
                self.arguments.insert(*argument);
            }
            Formula::Input(Read::Sines, _) => self.sines = true,
            Formula::Input(Read::Cosines, _) => self.cosines = true,
            Formula::Sum(terms) => self.mul_add |= adds_product(terms),
            Formula::Call(Known::Stumpff(order), _) => {
                self.stumpff = self.stumpff.max(Some(*order));
            }
            Formula::Call(Known::Curve(..), _) => self.curve = true,
            Formula::Call(Known::DexpInverse(_), _) => self.dexp_inverse = true,
            Formula::Call(Known::Sech, _) => self.sech = true,
            Formula::Call(Known::LnCosh, _) => self.ln_cosh = true,
            Formula::Call(Known::Ln1p, _) => self.ln_1p_scaled = true,
            Formula::Several(primitive, _) => self.primitives.push(*primitive),
            _ => {}
        }
    }

    /// Whether an argument is read.
    pub fn reads(&self, argument: Argument) -> bool {
        self.arguments.contains(&argument)
    }

    /// The helpers that are called, those too that only helpers call.
    pub fn helpers(&self) -> Helpers {
        let has = |primitive| self.primitives.contains(&primitive);
        let rotation_vector = has(Primitive::RotationVector);
        let orders = self.stumpff.map(usize::from);
        let orders = orders.map_or(0..0, |order| 0..order + 2 * STUMPFF_TERMS - 1);
        Helpers {
            pairs: !self.products.is_empty(),
            mass: self.products.contains(&Product::Mass),
            inverse_mass: self.products.contains(&Product::InverseMass),
            inverse: self.products.contains(&Product::Inverse),
            forward: self.products.contains(&Product::Forward),
            second_inverse: self.products.contains(&Product::SecondInverse),
            second_forward: self.products.contains(&Product::SecondForward),
            mul_add: self.mul_add
                || !self.products.is_empty()
                || self.curve
                || self.dexp_inverse
                || self.stumpff.is_some(),
            curve: self.curve,
            dexp_inverse: self.dexp_inverse,
            sech: self.sech,
            ln_cosh: self.ln_cosh,
            ln_1p_scaled: self.ln_1p_scaled,
            stumpff: self.stumpff.is_some(),
            rotation_vector,
            quaternion_vector: rotation_vector || has(Primitive::QuaternionVector),
            nearest_rotation: has(Primitive::NearestRotation),
            // What the series has for 0.
            inverse_factorials: orders.map(|n| literal(0.0_f64.stumpff(n))).collect(),
        }
    }
}

/// The helper for a function of the runtime with several results, and their number.
pub fn several(function: Primitive) -> (&'static str, usize) {
    match function {
        Primitive::RotationVector => ("rotation_vector", 3),
        Primitive::QuaternionVector => ("quaternion_vector", 3),
        Primitive::NearestRotation => ("nearest_rotation", 9),
    }
}
