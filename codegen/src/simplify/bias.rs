//! `c = Ẋ̄^c v̄` and `Ẋ̄^cᵀ h`, in the way that takes fewest operations.

use super::kernels::{LONG, alternative, least_work, terms, with_lines};
use super::words::Words;
use crate::expand::{Expansion, Steps, speed_map};
use crate::expr::{Expr, Symbol};
use crate::kernel::{Kernel, KernelKind, Method, Step, Structure};
use crate::matrix::Matrix;
use crate::prepare::Prepared;
use std::collections::{BTreeMap, BTreeSet};

/// Both kernels; `map` is X̄^c = X^c S̄ in words.
pub fn kernels(
    joint: &Prepared,
    expansion: &Expansion,
    words: &Words<'_>,
    map: &Matrix,
) -> Vec<Kernel> {
    let maker = Maker { joint, expansion };
    let few = words.functions_alone();
    let speed_map = speed_map(joint, expansion);
    let is_long = terms(std::slice::from_ref(&speed_map)) > LONG / 2;
    let rate = maker.by_slices(words, map);
    let first = maker.with(&rate, Entries::Lines);
    let mut others = vec![maker.with(&rate, Entries::InPlace)];
    if !is_long {
        let by_coordinates = alternative(|| maker.by_coordinates(&few));
        let by_slices = alternative(|| {
            let rate = maker.by_slices(&few, &speed_map);
            maker.with(&rate, Entries::InPlace)
        });
        others.extend([by_coordinates, by_slices].into_iter().flatten());
    }
    let first = first.into_iter().enumerate();
    let least = first.map(|(n, kernel)| {
        let others = others.iter().map(|others| others[n].clone());
        least_work(kernel, others)
    });
    least.collect()
}

/// Ẋ̄^c, and the words that it is written in.
struct Rate<'a> {
    words: Words<'a>,
    entries: Matrix,
}

/// Where the entries of Ẋ̄^c stand.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Entries {
    /// As lines of their own.
    Lines,
    /// In the sums with v̄ and h, which may be shorter multiplied out.
    InPlace,
}

struct Maker<'a> {
    joint: &'a Prepared,
    expansion: &'a Expansion,
}

impl Maker<'_> {
    /// By the chain rule through the stored scalars, with their rates as lines.
    fn by_coordinates(&self, words: &Words<'_>) -> [Kernel; 2] {
        let map = speed_map(self.joint, self.expansion);
        let mut steps = Steps::default();
        let rates = self.coordinate_rates(&map, words, &mut steps);
        let along = |symbol: &Symbol| rates.get(symbol).cloned().unwrap_or_default();
        let rate = map.map(|entry| words.shorten(&entry.along(&along)));
        self.both(&rate, words, &steps.finish())
    }

    /// By slices: `Ẋ̄^c = Σ_k ∂X̄^c/∂ϕ_k ϕ̇_k`.
    fn by_slices<'a>(&self, words: &Words<'a>, map: &Matrix) -> Rate<'a> {
        let mut words = words.clone();
        let map = words.shorten_each(map);
        let local = self.local_rates(&words);
        let zero = Matrix::zeros(map.rows(), map.columns());
        let rate = (0..self.expansion.shape.freedoms).fold(zero, |sum, k| {
            let slice = words.along_each(&map, k);
            sum.plus(&slice.scale(local.at(k, 0)))
        });
        let entries = words.shorten_each(&rate);
        Rate { words, entries }
    }

    /// Both kernels, made of the rate.
    fn with(&self, rate: &Rate<'_>, entries: Entries) -> [Kernel; 2] {
        let mut steps = Steps::default();
        let lines = match entries {
            Entries::Lines => steps.bind_matrix("rate", &rate.entries),
            Entries::InPlace => rate.entries.clone(),
        };
        self.both(&lines, &rate.words, &steps.finish())
    }

    /// `ϕ̇ = S₀⁻¹ S̄ v̄`.
    fn local_rates(&self, words: &Words<'_>) -> Matrix {
        let basis = &self.expansion.nonholonomic.speed_basis;
        let inverse = &self.expansion.velocity_map_inverse;
        let speeds = Matrix::symbols(&self.expansion.arguments.speeds);
        words.shorten_each(&words.shorten_each(&inverse.times(basis)).times(&speeds))
    }

    /// `Q̇ = Σ_k δ_k ϕ̇_k` of the stored scalars that occur in a matrix, and the rates of the names of B that do.
    fn coordinate_rates(
        &self,
        matrix: &Matrix,
        words: &Words<'_>,
        steps: &mut Steps,
    ) -> BTreeMap<Symbol, Expr> {
        let occurring: BTreeSet<Symbol> = matrix.entries().iter().flat_map(Expr::symbols).collect();
        let local = self.local_rates(words);
        let rates = self.expansion.motion.tangent().times(&local);
        let coordinates = self.expansion.arguments.configuration.iter();
        let coordinates = coordinates.zip(rates.entries().iter().cloned());
        let named = self.expansion.named().iter().map(|word| {
            let terms = word.rates.iter().zip(local.entries());
            (&word.symbol, terms.map(|(rate, local)| rate * local).sum())
        });
        let all = coordinates.chain(named);
        let all = all.filter(|(symbol, _)| occurring.contains(*symbol));
        let shortened = all.map(|(symbol, rate)| (symbol, words.shorten(&rate)));
        let bound = shortened
            .filter(|(_, rate)| !rate.is_zero())
            .map(|(symbol, rate)| {
                let name = format!("{}_rate", symbol.name());
                (symbol.clone(), steps.bind(&name, rate))
            });
        bound.collect()
    }

    fn both(&self, rate: &Matrix, words: &Words<'_>, steps: &[Step]) -> [Kernel; 2] {
        let arguments = &self.expansion.arguments;
        let speeds = Matrix::symbols(&arguments.speeds);
        let wrench = Matrix::symbols(&arguments.wrench);
        let of_speeds = rate.times(&speeds);
        let of_wrench = rate.transpose().times(&wrench);
        [
            (KernelKind::BiasAcceleration, of_speeds),
            (KernelKind::BiasMomentum, of_wrench),
        ]
        .map(|(kind, value)| {
            let structure = Structure::of(std::slice::from_ref(&value));
            let steps = match structure {
                Structure::Zero => vec![],
                _ => steps.to_vec(),
            };
            let kernel = Kernel {
                kind,
                steps,
                outputs: vec![value],
                method: Method::Formula,
                structure,
            };
            with_lines(words, kernel)
        })
    }
}
