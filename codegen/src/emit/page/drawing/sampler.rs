//! Kernels of a joint in numbers, for a drawing.

use crate::derived::{Derived, KernelKind, Step};
use crate::expr::{Expr, Symbol, evaluate_f64};
use rustc_hash::FxHashMap;

type Values<'a> = FxHashMap<&'a Symbol, f64>;

/// Rounds of projection onto the relations: enough for a picture, since each comes nearer by a factor.
const PROJECTIONS: usize = 200;

/// A placed frame: its axes and its origin in parent coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Rotation, row by row.
    pub rotation: [[f64; 3]; 3],
    /// Origin, m.
    pub origin: [f64; 3],
}

impl Frame {
    /// A point of the frame in parent coordinates.
    pub fn point(&self, local: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| {
            let row = self.rotation[i];
            self.origin[i] + row[0] * local[0] + row[1] * local[1] + row[2] * local[2]
        })
    }
}

/// A joint with values for its parameters.
pub struct Sampler<'a> {
    derived: &'a Derived,
    parameters: Values<'a>,
}

impl<'a> Sampler<'a> {
    /// The joint with the given parameters, in the order of the spec.
    pub fn new(derived: &'a Derived, parameters: &[f64]) -> Self {
        let symbols = derived.spec.parameters.iter().map(|p| &p.symbol);
        Self {
            derived,
            parameters: symbols.zip(parameters.iter().copied()).collect(),
        }
    }

    /// Whether every condition on the parameters holds.
    pub fn meets_requirements(&self) -> bool {
        let mut conditions = self.derived.spec.requirements.iter();
        conditions.all(|condition| self.value(&condition.value.value, &self.parameters) > 0.0)
    }

    /// The stored scalars of the home configuration; where that is a guess, brought onto the manifold.
    pub fn home(&self) -> Vec<f64> {
        let values = self.parameters.clone();
        let outputs = self.outputs(KernelKind::Home, values);
        let home = outputs.into_iter().next().unwrap_or_default();
        match self.derived.space.home_is_guess {
            true => self.projected(home),
            false => home,
        }
    }

    /// Onto the manifold by the method of Kaczmarz: the shortest step to each relation in turn.
    fn projected(&self, mut q: Vec<f64>) -> Vec<f64> {
        let manifold = &self.derived.space.manifold;
        let coordinates = manifold.coordinates();
        let slopes = |relation: &Expr| -> Vec<Expr> {
            coordinates.iter().map(|q| relation.derivative(q)).collect()
        };
        let relations: Vec<(Expr, Vec<Expr>)> = manifold
            .relations()
            .into_iter()
            .map(|relation| (relation.clone(), slopes(&relation)))
            .collect();
        for _ in 0..PROJECTIONS {
            let before = q.clone();
            for (relation, slopes) in &relations {
                let at = self.at(&q);
                let slopes: Vec<f64> = slopes.iter().map(|slope| self.value(slope, &at)).collect();
                let square: f64 = slopes.iter().map(|slope| slope * slope).sum();
                let step = self.value(relation, &at) / square;
                if step.is_finite() {
                    q.iter_mut()
                        .zip(slopes)
                        .for_each(|(q, slope)| *q -= step * slope);
                }
            }
            if q == before {
                break;
            }
        }
        q
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        self.derived.bodies().count()
    }

    /// H(Q) of every body; nothing where one is not finite.
    pub fn poses(&self, q: &[f64]) -> Option<Vec<Frame>> {
        self.each_body().map(|body| body.pose(q)).collect()
    }

    /// The twist of every body in its child frame: angular, linear.
    pub fn twists(&self, q: &[f64], v: &[f64]) -> Option<Vec<[f64; 6]>> {
        self.each_body().map(|body| body.twist(q, v)).collect()
    }

    fn each_body(&self) -> impl Iterator<Item = Sampler<'a>> {
        self.derived.bodies().map(|derived| Sampler {
            derived,
            parameters: self.parameters.clone(),
        })
    }

    /// H(Q); nothing where it is not finite.
    pub fn pose(&self, q: &[f64]) -> Option<Frame> {
        let outputs = self.outputs(KernelKind::Pose, self.at(q));
        let (rotation, origin) = (outputs.first()?, outputs.get(1)?);
        let frame = Frame {
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| rotation[3 * i + j])),
            origin: std::array::from_fn(|i| origin[i]),
        };
        let finite = |row: &[f64; 3]| row.iter().all(|value| value.is_finite());
        (frame.rotation.iter().all(finite) && finite(&frame.origin)).then_some(frame)
    }

    /// Q̇(Q, v).
    pub fn rate(&self, q: &[f64], v: &[f64]) -> Vec<f64> {
        let mut values = self.at(q);
        let velocity = self.derived.arguments.velocity.iter();
        values.extend(velocity.zip(v.iter().copied()));
        let outputs = self.outputs(KernelKind::ConfigurationRate, values);
        outputs.into_iter().next().unwrap_or_default()
    }

    /// The twist in the child frame: angular, linear.
    fn twist(&self, q: &[f64], v: &[f64]) -> Option<[f64; 6]> {
        let matrix = self.matrix(KernelKind::TwistMapChild, q)?;
        let entry = |i: usize| (0..v.len()).map(|j| matrix[i * v.len() + j] * v[j]).sum();
        Some(std::array::from_fn(entry))
    }

    /// Column `j` of S̄ or A.
    pub fn column(&self, kind: KernelKind, q: &[f64], j: usize) -> Option<Vec<f64>> {
        let columns = self.derived.kernel(kind)?.outputs.first()?.columns();
        let matrix = self.matrix(kind, q)?;
        Some(
            matrix
                .iter()
                .skip(j)
                .step_by(columns.max(1))
                .copied()
                .collect(),
        )
    }

    /// The degree of freedom that a constraint forbids, if it is one alone.
    pub fn only_freedom(&self, constraint: usize) -> Option<usize> {
        let column = self.column(KernelKind::Constraint, &self.home(), constraint)?;
        let mut others = column
            .iter()
            .enumerate()
            .filter(|(_, entry)| **entry != 0.0);
        match (others.next(), others.next()) {
            (Some((k, _)), None) => Some(k),
            _ => None,
        }
    }

    /// K.
    pub fn freedoms(&self) -> usize {
        self.derived.shape.freedoms
    }

    fn matrix(&self, kind: KernelKind, q: &[f64]) -> Option<Vec<f64>> {
        self.outputs(kind, self.at(q)).into_iter().next()
    }

    fn at(&self, q: &[f64]) -> Values<'a> {
        let mut values = self.parameters.clone();
        let symbols = self.derived.arguments.configuration.iter();
        values.extend(symbols.zip(q.iter().copied()));
        values
    }

    /// Every output of a kernel, row by row; none for kernels that call the runtime.
    fn outputs(&self, kind: KernelKind, mut values: Values<'a>) -> Vec<Vec<f64>> {
        let Some(kernel) = self.derived.kernel(kind) else {
            return vec![];
        };
        for step in &kernel.steps {
            let Step::Let(symbol, value) = step else {
                return vec![];
            };
            let value = self.value(value, &values);
            values.insert(symbol, value);
        }
        let entries = kernel.outputs.iter().map(|matrix| {
            let entries = matrix.entries().iter();
            entries.map(|entry| self.value(entry, &values)).collect()
        });
        entries.collect()
    }

    fn value(&self, expression: &Expr, values: &Values<'_>) -> f64 {
        evaluate_f64(expression, &|symbol| {
            values.get(symbol).copied().unwrap_or(f64::NAN)
        })
    }
}
