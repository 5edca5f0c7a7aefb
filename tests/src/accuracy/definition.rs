//! The definition of a joint, read once: all that kernels are compared with, at any number of points.

use super::at_zero::{Arguments, AtZero};
use super::declared::{Declared, constants};
use super::jet::ONCE;
use super::pinned::pinned;
use super::program::{Program, Sheet};
use super::tracked::larger;
use super::{Grid, Node, Tracked};
use hamel_codegen::derived::{Derived, KernelKind};
use hamel_codegen::expr::Expr;
use hamel_codegen::model::{ConfigurationSpace, JointSpec};

/// What a spec declares and its consequences, with the values of the joint's parameters.
#[derive(Clone, Debug)]
pub struct Definition {
    declared: Declared,
    space: ConfigurationSpace,
    configuration: usize,
    speeds: usize,
    /// Degrees of freedom that move no body.
    still: Vec<usize>,
    /// Q, v, v̄ and h to the kernels at ϕ = 0.
    kernels: Program,
    /// Q and ϕ to Φ(Q, ϕ).
    moved: Program,
    /// Q and ϕ to Φ(Q, ϕ) and ∂Φ/∂ϕ.
    moved_with_tangent: Program,
    /// Q to ∂Φ/∂ϕ at ϕ = 0.
    directions: Program,
    /// Q to the functions of loci and the relations.
    functions: Program,
}

/// The exact numbers.
pub fn numbers(values: &[f64]) -> Vec<Tracked> {
    values.iter().map(|value| Tracked::input(*value)).collect()
}

fn column(entries: &[Node]) -> Grid<Node> {
    Grid::column(entries.to_vec())
}

/// Φ(Q, ϕ) and ∂Φ/∂ϕ.
fn moved_with_tangent(declared: &Declared, q: &[Node], phi: &[Node]) -> Sheet<Node> {
    let moved = declared.moved(&constants(q), &declared.variables(phi, ONCE, 1));
    let mut sheet = Sheet::default();
    let entry = |i: usize, k: usize| moved[i].slope(ONCE + k);
    sheet.put("tangent", Grid::from_fn(moved.len(), phi.len(), entry));
    let values = moved.iter().map(|jet| jet.value.clone()).collect();
    sheet.put("moved", Grid::column(values));
    sheet
}

fn functions(declared: &Declared, loci: &[Expr], relations: &[Expr], q: &[Node]) -> Sheet<Node> {
    let mut sheet = Sheet::default();
    sheet.put("loci", declared.evaluate(loci, &constants(q)));
    sheet.put("relations", declared.evaluate(relations, &constants(q)));
    if let Some((shifts, values)) = declared.shifts(&constants(q)) {
        sheet.put("shifts", shifts);
        sheet.put("shifting", values);
    }
    sheet
}

impl Definition {
    /// The definition of the joint as one of its bodies sees it, with these values of its parameters.
    pub fn new(derived: &Derived, body: usize, parameters: &[f64]) -> Self {
        let declared = Declared::new(derived, body, parameters);
        let (n, k) = (declared.coordinates.len(), declared.freedoms());
        let speeds = derived.shape.speeds;
        let relations = derived.kernel(KernelKind::Residual);
        let relations = relations.map_or(&[][..], |kernel| kernel.outputs[0].entries());
        let zero = declared.zero();
        let still = derived.still.clone();
        let loci = derived.space.loci.iter();
        let loci: Vec<Expr> = loci.map(|locus| locus.value.function.clone()).collect();
        Self {
            kernels: Program::new(n + k + speeds + 6, |all| {
                let (q, rest) = all.split_at(n);
                let (v, rest) = rest.split_at(k);
                let (speeds, wrench) = rest.split_at(speeds);
                let arguments = Arguments {
                    velocity: column(v),
                    speeds: column(speeds),
                    wrench: column(wrench),
                };
                AtZero::new(&declared, &still, q).kernels(&arguments)
            }),
            moved: Program::new(n + k, |all| {
                let (q, phi) = all.split_at(n);
                moved_with_tangent(&declared, q, phi).only("moved")
            }),
            moved_with_tangent: Program::new(n + k, |all| {
                let (q, phi) = all.split_at(n);
                moved_with_tangent(&declared, q, phi)
            }),
            directions: Program::new(n, |q| moved_with_tangent(&declared, q, &zero)),
            functions: Program::new(n, |q| functions(&declared, &loci, relations, q)),
            configuration: n,
            speeds,
            still,
            declared,
            space: pinned(&derived.space, parameters),
        }
    }

    /// The spec.
    pub fn spec(&self) -> &JointSpec {
        &self.declared.spec
    }

    /// Where the joint lives, with its parameters at their values.
    pub fn space(&self) -> &ConfigurationSpace {
        &self.space
    }

    /// What the spec declares.
    pub fn declared(&self) -> &Declared {
        &self.declared
    }

    /// Number of stored scalars.
    pub fn configuration(&self) -> usize {
        self.configuration
    }

    /// Number of degrees of freedom.
    pub fn freedoms(&self) -> usize {
        self.declared.freedoms()
    }

    /// Number of speeds.
    pub fn speeds(&self) -> usize {
        self.speeds
    }

    /// All kernels at ϕ = 0 by their names.
    pub fn kernels(&self, q: &[f64], v: &[f64], speeds: &[f64], wrench: &[f64]) -> Sheet<Tracked> {
        self.kernels.run(&numbers(&[q, v, speeds, wrench].concat()))
    }

    /// Q and v to derivatives of kernels along ϕ̇ = v.
    pub fn derivatives(&self) -> Program {
        let n = self.configuration;
        Program::new(n + self.freedoms(), |all| {
            let (q, v) = all.split_at(n);
            AtZero::new(&self.declared, &self.still, q).derivatives(&column(v))
        })
    }

    /// The home configuration.
    pub fn home(&self) -> Vec<Tracked> {
        let known = |node: Node| node.known().unwrap_or(Tracked::input(f64::NAN));
        self.declared.home().into_iter().map(known).collect()
    }

    /// Φ(Q, ϕ).
    pub(super) fn moved(&self, q: &[Tracked], phi: &[Tracked]) -> Grid<Tracked> {
        self.moved.run(&[q, phi].concat()).get("moved").clone()
    }

    /// Φ(Q, ϕ) as `moved` and ∂Φ/∂ϕ as `tangent`.
    pub(super) fn moved_with_tangent(&self, q: &[Tracked], phi: &[Tracked]) -> Sheet<Tracked> {
        self.moved_with_tangent.run(&[q, phi].concat())
    }

    /// ∂Φ/∂ϕ at ϕ = 0.
    pub(super) fn directions(&self, q: &[Tracked]) -> Grid<Tracked> {
        self.directions.run(q).get("tangent").clone()
    }

    /// The functions of the joint's loci at Q.
    pub fn loci(&self, q: &[f64]) -> Grid<Tracked> {
        self.functions.run(&numbers(q)).get("loci").clone()
    }

    /// How far roundings of the relations that Φ follows from move each stored scalar: the largest of them; nothing where Φ does not.
    pub fn shifts(&self, q: &[f64]) -> Vec<f64> {
        let found = self.functions.run(&numbers(q));
        let (Some(shifts), Some(values)) = (found.find("shifts"), found.find("shifting")) else {
            return vec![0.0; q.len()];
        };
        let moves = |i: usize, r: usize| shifts.at(i, r).scale * values.at(r, 0).scale;
        let largest = |i: usize| (0..values.rows).map(|r| moves(i, r)).fold(0.0, larger);
        (0..q.len()).map(largest).collect()
    }

    /// The relations of the manifold at Q.
    pub fn relations(&self, q: &[f64]) -> Grid<Tracked> {
        self.functions.run(&numbers(q)).get("relations").clone()
    }
}
