//! What a spec declares, as functions of Q and ϕ with their derivatives: H, Φ, X, A, S̄, and J of (23).

use super::environment::Environment;
use super::jet::{MOST, ONCE};
use super::relations::Relations;
use super::{Grid, Jet, Node};
use hamel_codegen::algebra;
use hamel_codegen::derived::Derived;
use hamel_codegen::expr::{Atom, Expr, Number, Symbol};
use hamel_codegen::manifold::Manifold;
use hamel_codegen::matrix::Matrix;
use hamel_codegen::model::{JointSpec, PoseExpr, VelocityFrame};
use std::collections::{BTreeMap, BTreeSet};

/// What a spec declares, ready for evaluation anywhere.
#[derive(Clone, Debug)]
pub struct Declared {
    /// The spec.
    pub spec: JointSpec,
    /// Which of its bodies is looked at.
    pub body: usize,
    /// H in the author's names and, where declared, X of every body.
    bodies: Vec<(PoseExpr, Option<Matrix>)>,
    /// Symbols of the stored scalars.
    pub coordinates: Vec<Symbol>,
    locals: Vec<Symbol>,
    motion: Motion,
    home: Vec<Expr>,
    parameters: Environment,
}

/// Φ.
#[derive(Clone, Debug)]
enum Motion {
    /// Φ(Q, ϕ), stored scalars.
    Explicit(Vec<Expr>),
    /// By relations alone.
    Implicit(Box<Relations>),
}

/// H(Q), rotation and translation.
pub type Pose = (Grid<Jet>, Grid<Jet>);

/// The part of a matrix that does not vary.
pub fn values(grid: &Grid<Jet>) -> Grid<Node> {
    grid.map(|entry| entry.value.clone())
}

/// The derivative of a matrix by the i-th variable.
pub fn slopes(grid: &Grid<Jet>, i: usize) -> Grid<Node> {
    grid.map(|entry| entry.slope(i))
}

/// Numbers that do not vary.
pub fn constants(values: &[Node]) -> Vec<Jet> {
    values.iter().cloned().map(Jet::constant).collect()
}

impl Declared {
    /// The definition of the joint as one of its bodies sees it, with these values of its parameters.
    pub fn new(derived: &Derived, body: usize, parameters: &[f64]) -> Self {
        let spec = derived.spec.clone();
        let bodies = derived.bodies().map(|own| {
            let pose = own.spec.worded.poses.first();
            let pose = pose.unwrap_or(&own.spec.pose.value).clone();
            let twists = own.spec.twist_map.as_ref();
            (pose, twists.map(|x| x.value.clone()))
        });
        let symbols = spec.parameters.iter().map(|parameter| &parameter.symbol);
        let manifold = &spec.manifold.value;
        let home = spec.home.as_ref().map(|home| home.value.clone());
        let parameters: Vec<Jet> = parameters.iter().map(|x| Jet::input(*x)).collect();
        Self {
            parameters: Environment::default().with(symbols, &parameters),
            coordinates: manifold.coordinates(),
            locals: spec
                .freedoms
                .value
                .iter()
                .map(|f| f.local.clone())
                .collect(),
            motion: motion(&spec),
            body,
            bodies: bodies.collect(),
            home: home.unwrap_or_else(|| manifold.home()),
            spec,
        }
    }

    /// Number of degrees of freedom.
    pub fn freedoms(&self) -> usize {
        self.locals.len()
    }

    fn at(&self, q: &[Jet]) -> Environment {
        self.parameters.with(&self.coordinates, q)
    }

    /// With the values of the author's names: H is evaluated as it is written, so that the sum of two angles is an inexact argument.
    fn in_words(&self, q: &[Jet]) -> Environment {
        let mut at = self.at(q);
        for named in &self.spec.worded.named {
            let value = at.evaluate(&named.value);
            at = at.with([&named.symbol], &[value]);
        }
        at
    }

    /// Expressions of Q and the parameters.
    pub fn evaluate(&self, expressions: &[Expr], q: &[Jet]) -> Grid<Node> {
        values(&Grid::column(self.at(q).evaluate_all(expressions)))
    }

    /// A(Q), where declared.
    pub fn constraint(&self, q: &[Jet]) -> Option<Grid<Node>> {
        let declared = self.spec.constraint.as_ref()?;
        Some(values(&self.at(q).matrix(&declared.value)))
    }

    /// Φ(Q, ϕ).
    pub fn moved(&self, q: &[Jet], phi: &[Jet]) -> Vec<Jet> {
        match &self.motion {
            Motion::Explicit(moved) => self.at(q).with(&self.locals, phi).evaluate_all(moved),
            Motion::Implicit(relations) => relations.moved(&self.at(q), &self.coordinates, phi),
        }
    }

    /// [`Relations::shifts`] at Q, where Φ follows from relations alone.
    pub fn shifts(&self, q: &[Jet]) -> Option<(Grid<Node>, Grid<Node>)> {
        match &self.motion {
            Motion::Explicit(_) => None,
            Motion::Implicit(relations) => Some(relations.shifts(&self.at(q))),
        }
    }

    /// The stored scalars of the home configuration.
    pub fn home(&self) -> Vec<Node> {
        let home = self.parameters.evaluate_all(&self.home);
        home.into_iter().map(|entry| entry.value).collect()
    }

    /// ϕ, each coordinate a variable; numbered from `first`.
    pub fn variables(&self, phi: &[Node], first: usize, degree: usize) -> Vec<Jet> {
        let variable = |(i, value): (usize, &Node)| Jet::variable(value.clone(), first + i, degree);
        phi.iter().enumerate().map(variable).collect()
    }

    /// ϕ = 0.
    pub fn zero(&self) -> Vec<Node> {
        vec![Node::input(0.0); self.freedoms()]
    }

    /// Symbols inside the arguments of functions in H of any body.
    pub fn arguments(&self) -> BTreeSet<Symbol> {
        let named = self.spec.worded.named.iter();
        let values: BTreeMap<&Symbol, &Expr> = named.map(|own| (&own.symbol, &own.value)).collect();
        let poses = self.bodies.iter().flat_map(|(pose, _)| pose.entries());
        let mut inside: Vec<Expr> = poses
            .chain(values.values().copied())
            .flat_map(arguments_in)
            .collect();
        let mut found = BTreeSet::new();
        while let Some(argument) = inside.pop() {
            for symbol in argument.symbols() {
                match values.get(&symbol) {
                    Some(value) => inside.push((*value).clone()),
                    None => _ = found.insert(symbol),
                }
            }
        }
        found
    }

    /// H(Q) of every body.
    pub fn poses(&self, q: &[Jet]) -> Vec<Pose> {
        let at = self.in_words(q);
        let poses = self.bodies.iter();
        let poses =
            poses.map(|(pose, _)| (at.matrix(&pose.rotation), at.matrix(&pose.translation)));
        poses.collect()
    }

    /// J of (23) of every body, one below the other, by the variables from `first` on: 6m×k.
    pub fn jacobian(&self, poses: &[Pose], first: usize) -> Grid<Jet> {
        Grid::below(poses.iter().map(|pose| self.jacobian_of(pose, first)))
    }

    /// `vee(Ḣ H⁻¹)` of one body, 6×k.
    fn jacobian_of(&self, pose: &Pose, first: usize) -> Grid<Jet> {
        let (rotation, translation) = pose;
        let outer = |grid: &Grid<Jet>| match first < ONCE {
            true => grid.clone(),
            false => grid.map(Jet::at_zero_of_once),
        };
        let (transposed, p) = (outer(rotation).transpose(), outer(translation));
        let column = |k: usize| {
            let spin = rotation.map(|e| e.partial(first + k)).times(&transposed);
            let omega = [(2, 1), (0, 2), (1, 0)].map(|(i, j)| spin.at(i, j).clone());
            let velocity = translation.map(|e| e.partial(first + k));
            let lever = cross(&omega, p.entries());
            let linear = velocity.minus(&lever);
            [&omega, linear.entries()].concat()
        };
        let columns: Vec<Vec<Jet>> = (0..self.freedoms()).map(column).collect();
        Grid::from_fn(6, columns.len(), |i, k| columns[k][i].clone())
    }

    /// J(Q, 0) where Q itself may vary: the twists of the bodies for each ϕ̇, 6m×k.
    fn directions(&self, q: &[Jet]) -> Grid<Jet> {
        let step = self.variables(&self.zero(), ONCE, MOST);
        self.jacobian(&self.poses(&self.moved(q, &step)), ONCE)
    }

    /// X(Q) of every body, as declared or as the frame of v has it: 6m×k.
    pub fn twist_map(&self, q: &[Jet]) -> Grid<Jet> {
        let at = self.at(q);
        let declared: Option<Vec<Grid<Jet>>> = self
            .bodies
            .iter()
            .map(|(_, twists)| twists.as_ref().map(|x| at.matrix(x)))
            .collect();
        if let Some(declared) = declared {
            return Grid::below(declared);
        }
        match self.spec.velocity.value {
            VelocityFrame::Parent => {
                let home = self.parameters.evaluate_all(&self.home);
                let directions = self.directions(&home);
                let poses = self.poses(&home);
                let own = poses.iter().enumerate();
                Grid::below(own.map(|(n, pose)| to_child(pose, &directions.rows_of(6 * n, 6))))
            }
            VelocityFrame::Child | VelocityFrame::Rates => self.directions(q),
        }
    }

    /// S̄ as declared; the identity for a joint without constraint; nothing where only A is declared.
    pub fn speed_basis(&self, q: &[Jet]) -> Option<Grid<Jet>> {
        match (&self.spec.speed_basis, &self.spec.constraint) {
            (Some(declared), _) => Some(self.at(q).matrix(&declared.value)),
            (None, None) => Some(self.at(q).matrix(&Matrix::identity(self.freedoms()))),
            (None, Some(_)) => None,
        }
    }
}

/// The arguments of the functions in an expression.
fn arguments_in(expression: &Expr) -> Vec<Expr> {
    let atoms = expression.atoms().into_iter();
    let arguments = atoms.flat_map(|atom| match atom {
        Atom::Apply(application) => application.arguments.clone(),
        Atom::Symbol(_) => vec![],
    });
    arguments.collect()
}

/// Φ as declared, or as it follows from the manifold.
fn motion(spec: &JointSpec) -> Motion {
    if let Some(relations) = Relations::of(spec) {
        return Motion::Implicit(Box::new(relations));
    }
    let declared = spec.retract.as_ref().map(|declared| declared.value.clone());
    Motion::Explicit(declared.unwrap_or_else(|| exponential_of_freedoms(spec)))
}

/// Φ = Q exp(Σ b_k ϕ_k) on every factor.
fn exponential_of_freedoms(spec: &JointSpec) -> Vec<Expr> {
    let manifold = &spec.manifold.value;
    let factors = manifold.factors().iter().enumerate();
    let standard = factors.flat_map(|(n, factor)| {
        let mut standard = vec![Expr::zero(); factor.kind.dimension()];
        for freedom in spec.freedoms.value.iter().filter(|f| f.factor == n) {
            for (sum, component) in standard.iter_mut().zip(&freedom.generator) {
                *sum += &(component * &Expr::symbol(&freedom.local));
            }
        }
        standard
    });
    exponential(manifold, &standard.collect::<Vec<_>>())
}

/// Q exp(ξ), stored scalars, with ξ in the standard directions of all factors.
pub fn exponential(manifold: &Manifold, displacement: &[Expr]) -> Vec<Expr> {
    let mut rest = displacement;
    let moved = manifold.factors().iter().flat_map(|factor| {
        let (own, others) = rest.split_at(factor.kind.dimension());
        rest = others;
        let step = algebra::exp(&algebra::hat(factor.kind, own))
            .unwrap_or_else(|| panic!("{}: exp has a closed form", factor.name));
        factor.coordinates_of(&factor.matrix().times(&step))
    });
    moved.collect()
}

/// `a × b`.
fn cross(a: &[Jet; 3], b: &[Jet]) -> Grid<Jet> {
    let minus = |x: Jet| Grid::column(vec![x]).negative().at(0, 0).clone();
    let entry = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].times(&b[k]).plus(&minus(a[k].times(&b[j])))
    };
    Grid::column((0..3).map(entry).collect())
}

/// `Ad_{H⁻¹} = [Rᵀ 0; −Rᵀp~ Rᵀ]` times twists.
pub fn to_child((rotation, translation): &Pose, twists: &Grid<Jet>) -> Grid<Jet> {
    let transposed = rotation.transpose();
    let column = |k: usize| {
        let omega = [0, 1, 2].map(|i| twists.at(i, k).clone());
        let linear = Grid::from_fn(3, 1, |i, _| twists.at(3 + i, k).clone());
        // v − p × ω = v + ω × p.
        let moved = linear.plus(&cross(&omega, translation.entries()));
        let angular = transposed.times(&Grid::column(omega.to_vec()));
        [angular.entries(), transposed.times(&moved).entries()].concat()
    };
    let columns: Vec<Vec<Jet>> = (0..twists.columns).map(column).collect();
    Grid::from_fn(6, columns.len(), |i, k| columns[k][i].clone())
}

#[cfg(test)]
mod tests {
    use super::exponential_of_freedoms;
    use crate::accuracy::environment::Environment;
    use crate::accuracy::{Grid, Jet, Tracked};
    use hamel_codegen::algebra;
    use hamel_codegen::expr::{Expr, Number};
    use hamel_codegen::manifold::Kind;

    const JOINTS: [(&str, Kind); 6] = [
        (
            "config Q: SO3; basis a, b, c of so3; velocity in child; H = Q;",
            Kind::So3,
        ),
        (
            "config Q: S3; basis a, b, c of so3; velocity in child; H = rot(Q);",
            Kind::S3,
        ),
        (
            "config Q: SE3; basis a, b, c, d, e, f of se3; velocity in child; H = Q;",
            Kind::Se3,
        ),
        (
            "config Q: SE2; basis a, b, c of se2; velocity in child; H = pose(rot_z(Q), [Q.x, Q.y, 0]);",
            Kind::Se2,
        ),
        (
            "config Q: S1; basis a of so2; velocity in child; H = rot_z(Q);",
            Kind::S1,
        ),
        (
            "config Q: SO2; basis a of so2; velocity in child; H = rot_z(Q);",
            Kind::So2,
        ),
    ];

    fn known(jet: &Jet) -> Tracked {
        jet.value.known().expect("arguments are known")
    }

    /// The power series of exp: 120 terms at |ξ| < 10 leave 10¹²⁰/120! = 1e-79.
    fn series(xi: &Grid<Tracked>) -> Grid<Tracked> {
        let identity = Grid::from_fn(xi.rows, xi.rows, |i, j| {
            Tracked::input(f64::from(u8::from(i == j)))
        });
        let (mut sum, mut power) = (identity.clone(), identity);
        for n in 1..120 {
            let inverse = Tracked::input(1.0).over(&Tracked::input(f64::from(n)));
            power = power.times(xi).map(|entry| entry.times(&inverse));
            sum = sum.plus(&power);
        }
        sum
    }

    /// Φ at the identity is the power series, near 0, at half a turn and beyond.
    #[test]
    fn closed_forms_of_exp_are_the_series() {
        for (text, kind) in JOINTS {
            let source = format!("hamel = 1;\njoint test {{ {text} }}\n");
            let spec = hamel_codegen::spec::parse(&source, "test.joint").expect("a right spec");
            let moved = exponential_of_freedoms(&spec);
            for scale in [1e-150, 1e-3, 1.0, std::f64::consts::PI, 4.0] {
                let phi: Vec<f64> = (0..kind.dimension())
                    .map(|i| scale / (1.0 + i as f64))
                    .collect();
                let jets: Vec<Jet> = phi.iter().map(|x| Jet::input(*x)).collect();
                let locals = spec.freedoms.value.iter().map(|freedom| &freedom.local);
                let coordinates = spec.manifold.value.coordinates();
                let home = Environment::default().evaluate_all(&spec.manifold.value.home());
                let at = Environment::default()
                    .with(locals, &jets)
                    .with(&coordinates, &home);
                let symbols: Vec<Expr> = spec
                    .freedoms
                    .value
                    .iter()
                    .map(|f| Expr::symbol(&f.local))
                    .collect();
                let xi = at.matrix(&algebra::hat(kind, &symbols)).map(known);
                let factor = &spec.manifold.value.factors()[0];
                let place = factor.coordinates_of(&algebra_index(kind));
                let expected = series(&xi);
                for (got, place) in at.evaluate_all(&moved).iter().zip(place) {
                    let place = hamel_codegen::expr::evaluate_f64(&place, &|_| f64::NAN) as usize;
                    let error = known(got).value - expected.entries()[place].value;
                    // 2⁻²²⁰ of terms up to 10⁴.
                    assert!(error.to_f64().abs() < f64::powi(0.5, 207), "{text} {scale}");
                }
            }
        }
    }

    /// The square matrix of a group whose entries are their own places, row by row.
    fn algebra_index(kind: Kind) -> hamel_codegen::matrix::Matrix {
        let size = algebra::hat(kind, &vec![Expr::zero(); kind.dimension()]).rows();
        hamel_codegen::matrix::Matrix::from_fn(size, size, |i, j| {
            Expr::integer((size * i + j) as i64)
        })
    }
}
