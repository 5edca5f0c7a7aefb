//! What a spec declares, as functions of Q and ϕ with their derivatives: H, Φ, X, A, S̄, and J of (23).

use super::environment::Environment;
use super::jet::{MOST, ONCE};
use super::{Grid, Jet, Node};
use hamel_codegen::algebra;
use hamel_codegen::expr::{Expr, Number, Symbol};
use hamel_codegen::matrix::Matrix;
use hamel_codegen::model::{JointSpec, VelocityFrame};

/// What a spec declares, ready for evaluation anywhere.
#[derive(Clone, Debug)]
pub struct Declared {
    /// The spec.
    pub spec: JointSpec,
    /// Symbols of the stored scalars.
    pub coordinates: Vec<Symbol>,
    locals: Vec<Symbol>,
    /// Φ(Q, ϕ), stored scalars.
    moved: Vec<Expr>,
    home: Vec<Expr>,
    parameters: Environment,
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
    /// The definition of the joint with these values of its parameters.
    pub fn new(spec: JointSpec, parameters: &[f64]) -> Self {
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
            moved: spec
                .retract
                .as_ref()
                .map_or_else(|| exponential(&spec), |declared| declared.value.clone()),
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
        self.at(q).with(&self.locals, phi).evaluate_all(&self.moved)
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

    /// H(Q).
    pub fn pose(&self, q: &[Jet]) -> Pose {
        let at = self.at(q);
        let pose = &self.spec.pose.value;
        (at.matrix(&pose.rotation), at.matrix(&pose.translation))
    }

    /// `vee(Ḣ H⁻¹)` by the variables from `first` on: J of (23), 6×k.
    pub fn jacobian(&self, pose: &Pose, first: usize) -> Grid<Jet> {
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

    /// J(Q, 0) where Q itself may vary: the twist of the child for each ϕ̇.
    fn directions(&self, q: &[Jet]) -> Grid<Jet> {
        let step = self.variables(&self.zero(), ONCE, MOST);
        self.jacobian(&self.pose(&self.moved(q, &step)), ONCE)
    }

    /// X(Q), as declared or as the frame of v has it.
    pub fn twist_map(&self, q: &[Jet]) -> Grid<Jet> {
        if let Some(declared) = &self.spec.twist_map {
            return self.at(q).matrix(&declared.value);
        }
        match self.spec.velocity.value {
            VelocityFrame::Parent => {
                let home = self.parameters.evaluate_all(&self.home);
                to_child(&self.pose(&home), &self.directions(&home))
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

/// Φ = Q exp(Σ b_k ϕ_k) on every factor.
fn exponential(spec: &JointSpec) -> Vec<Expr> {
    let factors = spec.manifold.value.factors().iter().enumerate();
    let moved = factors.flat_map(|(n, factor)| {
        let mut standard = vec![Expr::zero(); factor.kind.dimension()];
        for freedom in spec.freedoms.value.iter().filter(|f| f.factor == n) {
            for (sum, component) in standard.iter_mut().zip(&freedom.generator) {
                *sum += &(component * &Expr::symbol(&freedom.local));
            }
        }
        let step = algebra::hat(factor.kind, &standard);
        let step =
            algebra::exp(&step).unwrap_or_else(|| panic!("{}: exp has a closed form", factor.name));
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
    use super::exponential;
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
            let moved = exponential(&spec);
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
