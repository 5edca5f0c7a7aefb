//! The laws of a derived joint at a point: residuals of the definitions, enclosed.
//!
//! H, Φ, X, A and S̄ are those of the spec, kernels are the lowered programs that are written into Rust. Derivatives along ϕ are those of
//! truncated polynomials in ϕ. Nothing is divided that a law does not divide, so that a true law has a residual that holds 0.

mod products;

use super::ball::Ball;
use super::evaluate::Values;
use super::grid::Grid;
use super::jet::Jet;
use super::point::Point;
use hamel_codegen::algebra;
use hamel_codegen::derived::{Derived, Kernel, KernelKind};
use hamel_codegen::expr::{Expr, Symbol};
use hamel_codegen::matrix::Matrix;
use hamel_codegen::model::Declared;

/// A law with what must hold 0, or must not.
#[derive(Clone, Debug)]
pub struct Residual {
    /// The law, or the kernel.
    pub law: &'static str,
    /// The value.
    pub value: Ball,
    /// Whether the value must not be 0 (a rank), rather than be 0.
    pub regular: bool,
}

/// Whether a point belongs to the joint's domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    Inside,
    Outside,
    /// More precision may tell.
    Undecided,
}

/// A joint at a point.
pub struct At<'a> {
    derived: &'a Derived,
    values: Values,
    residuals: Vec<Residual>,
}

const FIRST: usize = 1;
const SECOND: usize = 2;

impl<'a> At<'a> {
    /// The joint at the point, in the precision of this thread.
    pub fn new(derived: &'a Derived, point: &Point) -> Self {
        let parameters = derived.spec.parameters.iter().map(|p| &p.symbol);
        let constant = |values: Vec<Ball>| values.into_iter().map(Jet::constant);
        let arguments = &derived.arguments;
        let numbers = |symbols: &[Symbol], first: f64| {
            let number = |i: usize| Jet::constant(Ball::exact(first / f64::from(1 << i)));
            (0..symbols.len()).map(number).collect::<Vec<Jet>>()
        };
        let values = Values::default()
            .with(parameters, constant(point.parameters()))
            .with(&arguments.velocity, numbers(&arguments.velocity, 0.75))
            .with(&arguments.momentum, numbers(&arguments.momentum, 0.625))
            .with(&arguments.speeds, numbers(&arguments.speeds, 0.875))
            .with(&arguments.wrench, numbers(&arguments.wrench, 1.125))
            .with(
                &arguments.local,
                (0..arguments.local.len()).map(|_| Jet::constant(Ball::zero())),
            );
        let q = point.configuration(&derived.space);
        let values = values.with(&arguments.configuration, constant(q));
        Self {
            derived,
            values,
            residuals: vec![],
        }
    }

    fn freedoms(&self) -> usize {
        self.derived.shape.freedoms
    }

    /// Whether parameters and configuration are ones that the spec admits.
    pub fn domain(&self) -> Domain {
        let spec = &self.derived.spec;
        let of = |e: &Expr| self.values.expression(e).value;
        let sides = self
            .derived
            .kernel(KernelKind::Singularity)
            .and_then(|kernel| {
                let positive = kernel.outputs.get(1)?;
                Some(positive.entries().to_vec())
            });
        let positive = spec
            .requirements
            .iter()
            .map(|r| r.value.value.clone())
            .chain(sides.into_iter().flatten());
        let positive: Vec<Ball> = positive.map(|e| of(&e)).collect();
        let space = &self.derived.space;
        let loci: Vec<Ball> = space.loci.iter().map(|l| of(&l.value.function)).collect();
        let relations: Vec<Ball> = space.manifold.relations().iter().map(of).collect();
        let outside = positive
            .iter()
            .any(|x| x.is_negative() || x.is_zero() || x.is_undefined())
            || loci.iter().any(|x| x.is_zero() || x.is_undefined())
            || relations.iter().any(Ball::excludes_zero);
        let inside = positive.iter().all(Ball::is_positive)
            && loci.iter().all(Ball::excludes_zero)
            && relations.iter().all(Ball::is_known);
        match (outside, inside) {
            (true, _) => Domain::Outside,
            (_, true) => Domain::Inside,
            _ => Domain::Undecided,
        }
    }

    fn kernel_of(&self, kind: KernelKind) -> Option<&'a Kernel> {
        self.derived.kernel(kind)
    }

    /// All outputs of a kernel at these values.
    fn run(&self, kind: KernelKind, values: &Values) -> Vec<Grid> {
        let Some(kernel) = self.kernel_of(kind) else {
            return vec![];
        };
        let mut entries = values.program(self.derived.program(kernel)).into_iter();
        let shapes = kernel.outputs.iter().map(Matrix::shape);
        let grids = shapes.map(|(rows, columns)| {
            Grid::new(
                rows,
                columns,
                entries.by_ref().take(rows * columns).collect(),
            )
        });
        grids.collect()
    }

    /// The first output of a kernel at the point.
    fn kernel(&self, kind: KernelKind) -> Grid {
        self.kernel_at(kind, &self.values)
    }

    fn kernel_at(&self, kind: KernelKind, values: &Values) -> Grid {
        let first = self.run(kind, values).into_iter().next();
        first.unwrap_or_else(|| Grid::new(0, 0, vec![]))
    }

    /// The values at Φ(Q, ϕ), ϕ varying to this order.
    fn moved(&self, order: usize) -> Values {
        let count = self.freedoms();
        let zero = Ball::zero();
        let locals = (0..count).map(|i| Jet::variable(zero.clone(), i, count, order));
        let at = self.values.with(&self.derived.arguments.local, locals);
        let moved = match &self.derived.spec.retract {
            Some(declared) => declared.value.iter().map(|e| at.expression(e)).collect(),
            None => self.kernel_at(KernelKind::Retract, &at).entries,
        };
        self.values
            .with(&self.derived.arguments.configuration, moved)
    }

    fn vanish(&mut self, law: &'static str, values: impl IntoIterator<Item = Ball>) {
        let residual = |value| Residual {
            law,
            value,
            regular: false,
        };
        self.residuals.extend(values.into_iter().map(residual));
    }

    fn equal(&mut self, law: &'static str, got: &Grid, want: &Grid) {
        let entries = got.entries.iter().zip(&want.entries);
        let apart: Vec<Ball> = entries.map(|(g, w)| g.value.minus(&w.value)).collect();
        self.vanish(law, apart);
    }

    /// Equal with all derivatives.
    fn alike(&mut self, law: &'static str, got: &Grid, want: &Grid) {
        for (g, w) in got.entries.iter().zip(&want.entries) {
            let Jet {
                value,
                first,
                second,
            } = g.minus(w);
            self.vanish(law, std::iter::once(value).chain(first).chain(second));
        }
    }

    fn regular(&mut self, law: &'static str, matrix: &Grid) {
        let values = matrix.values();
        if values.columns == 0 {
            return;
        }
        // Of columns of very different sizes a minor may exclude 0 where the sum of their squares does not.
        let minor = values.minors().find(Ball::excludes_zero);
        let value = minor.unwrap_or_else(|| values.transpose().times(&values).determinant());
        self.residuals.push(Residual {
            law,
            value,
            regular: true,
        });
    }

    /// The residuals of all laws.
    pub fn laws(mut self) -> Vec<Residual> {
        self.manifold();
        self.pose_and_velocity();
        self.hamel();
        self.speeds();
        self.residuals
    }

    /// Φ(Q, 0) = Q, Φ on the manifold to second order and at finite ϕ, and what was lowered of Φ.
    fn manifold(&mut self) {
        let arguments = &self.derived.arguments;
        let manifold = &self.derived.space.manifold;
        let there = self.moved(SECOND);
        let q: Vec<Jet> = arguments
            .configuration
            .iter()
            .map(|s| self.values.symbol(s))
            .collect();
        let start: Vec<Jet> = arguments
            .configuration
            .iter()
            .map(|s| there.symbol(s))
            .collect();
        self.equal(
            "Φ(Q, 0) = Q",
            &Grid::column(start.clone()),
            &Grid::column(q),
        );
        for relation in manifold.relations() {
            let Jet {
                value,
                first,
                second,
            } = there.expression(&relation);
            self.vanish(
                "Φ(Q, ϕ) on the manifold",
                std::iter::once(value).chain(first).chain(second),
            );
        }
        let count = self.freedoms();
        let locals = (0..count).map(|i| Jet::variable(Ball::zero(), i, count, SECOND));
        let at = self.values.with(&arguments.local, locals);
        let lowered = self.kernel_at(KernelKind::Retract, &at);
        let want = match self.derived.spec.retract {
            Some(_) => start,
            None => self.exponential(&at),
        };
        self.alike("retract", &lowered, &Grid::column(want));
        let finite = (0..count).map(|i| Jet::constant(Ball::exact(0.5 / f64::from(1 << i))));
        let at = self.values.with(&arguments.local, finite);
        let moved = self.kernel_at(KernelKind::Retract, &at).entries;
        let at = self.values.with(&arguments.configuration, moved);
        let relations = manifold.relations();
        self.vanish(
            "retract stays on the manifold",
            relations
                .iter()
                .map(|r| at.expression(r).value)
                .collect::<Vec<_>>(),
        );
    }

    /// Q (1 + ξ + ξ²/2), ξ the element of the algebra: Q exp(ϕ) to second order.
    fn exponential(&self, at: &Values) -> Vec<Jet> {
        let spec = &self.derived.spec;
        let factors = spec.manifold.value.factors().iter().enumerate();
        let moved = factors.flat_map(|(n, factor)| {
            let mut standard = vec![Expr::zero(); factor.kind.dimension()];
            for freedom in spec.freedoms.value.iter().filter(|f| f.factor == n) {
                for (sum, part) in standard.iter_mut().zip(&freedom.generator) {
                    *sum += &(part * &Expr::symbol(&freedom.local));
                }
            }
            let hat = algebra::hat(factor.kind, &standard);
            let grid = |m: &Matrix| Grid::new(m.rows(), m.columns(), at.matrix(m));
            let (q, xi) = (grid(&factor.matrix()), grid(&hat));
            let half = Jet::constant(Ball::exact(0.5));
            let square = xi.times(&xi).map(|x| x.times(&half));
            let step = Grid::identity(xi.rows).plus(&xi).plus(&square);
            let turned = q.times(&step);
            // Which entry of the matrix each stored scalar is.
            let places = Matrix::from_fn(turned.rows, turned.columns, |i, j| {
                Expr::integer((turned.columns * i + j) as i64)
            });
            let places = factor.coordinates_of(&places);
            let of =
                |place: &Expr| hamel_codegen::expr::evaluate_f64(place, &|_| f64::NAN) as usize;
            places
                .iter()
                .map(|place| turned.entries[of(place)].clone())
                .collect::<Vec<Jet>>()
        });
        moved.collect()
    }

    /// H, X, S and what belongs to them.
    fn pose_and_velocity(&mut self) {
        let spec = &self.derived.spec;
        let (k, arguments) = (self.freedoms(), &self.derived.arguments);
        let there = self.moved(SECOND);
        let grid = |values: &Values, m: &Matrix| Grid::new(m.rows(), m.columns(), values.matrix(m));
        let pose = &spec.pose.value;
        let (rotation, translation) = (
            grid(&there, &pose.rotation),
            grid(&there, &pose.translation),
        );
        let lowered = self.run(KernelKind::Pose, &self.values);
        if let [turned, shifted] = lowered.as_slice() {
            self.equal("pose", turned, &rotation);
            self.equal("pose", shifted, &translation);
        }
        let (r, p) = (rotation.values(), translation.values());
        self.equal("RᵀR = I", &r.transpose().times(&r), &Grid::identity(3));
        let volume = r.determinant().minus(&Ball::one());
        self.vanish("det R = 1", [volume]);
        // J to first order: vee(Ḣ H⁻¹) of H(Φ(Q, ϕ)).
        let first = |g: &Grid| g.map(Jet::to_first_order);
        let (back, lever) = (first(&rotation).transpose(), first(&translation));
        let columns: Vec<Grid> = (0..k)
            .map(|i| {
                let spin = rotation.map(|x| x.partial(i)).times(&back);
                let omega = [(2, 1), (0, 2), (1, 0)].map(|(a, b)| spin.at(a, b).clone());
                let moved = cross(&omega, &lever.entries);
                let linear = translation
                    .map(|x| x.partial(i))
                    .minus(&Grid::column(moved));
                Grid::column([omega.to_vec(), linear.entries].concat())
            })
            .collect();
        let jacobian = Grid::beside(&columns);
        let near = self.moved(FIRST);
        let x = self.kernel_at(KernelKind::TwistMap, &near);
        if let Some(declared) = &spec.twist_map {
            self.alike("twist_map", &x, &grid(&near, &declared.value));
        }
        let (start, slices) = (
            self.kernel(KernelKind::VelocityMap),
            self.run(KernelKind::VelocityMapGradient, &self.values),
        );
        let s = Grid::from_fn(k, k, |i, j| {
            let slopes = slices.iter().map(|slice| slice.at(i, j).value.clone());
            Jet::linear(start.at(i, j).value.clone(), slopes.collect())
        });
        self.alike("X S = J to first order", &x.times(&s), &jacobian);
        let inverse = self.kernel(KernelKind::VelocityMapInverse);
        self.equal("S₀ S₀⁻¹ = I", &start.times(&inverse), &Grid::identity(k));
        self.regular("rank X = k", &x);
        let child = self.kernel_at(KernelKind::TwistMapChild, &near);
        let adjoint: Vec<Grid> = (0..k)
            .map(|i| to_parent(&r, &p, &child.values(), i))
            .collect();
        self.equal("X = Ad X^c", &Grid::beside(&adjoint), &x);
        let gradient = self.run(KernelKind::TwistMapChildGradient, &self.values);
        for (i, slice) in gradient.iter().enumerate() {
            self.equal("twist_map_child_gradient", slice, &child.slope(i));
        }
        let v = Grid::column(
            arguments
                .velocity
                .iter()
                .map(|s| self.values.symbol(s))
                .collect(),
        );
        let rate = inverse.times(&v);
        let moved = Grid::column(
            arguments
                .configuration
                .iter()
                .map(|s| near.symbol(s))
                .collect(),
        );
        let want = along(&moved, &rate);
        self.equal(
            "configuration_rate",
            &self.kernel(KernelKind::ConfigurationRate),
            &want,
        );
    }

    /// (17) and (28).
    fn hamel(&mut self) {
        let (k, arguments) = (self.freedoms(), &self.derived.arguments);
        let slices = self.run(KernelKind::VelocityMapGradient, &self.values);
        let inverse = self.kernel(KernelKind::VelocityMapInverse);
        let column = |symbols: &[Symbol]| {
            Grid::column(symbols.iter().map(|s| self.values.symbol(s)).collect())
        };
        let (v, p) = (column(&arguments.velocity), column(&arguments.momentum));
        let w = inverse.times(&v);
        let zero = Jet::constant(Ball::zero());
        let inner = Grid::from_fn(k, k, |l, j| {
            (0..k).fold(zero.clone(), |sum, m| {
                let apart = slices[m].at(j, l).minus(slices[l].at(j, m));
                sum.plus(&apart.times(w.at(m, 0)))
            })
        });
        self.equal(
            "gamma",
            &self.kernel(KernelKind::Gamma),
            &inverse.transpose().times(&inner),
        );
        let columns: Vec<Grid> = slices
            .iter()
            .map(|slice| slice.transpose().times(&p))
            .collect();
        let b = Grid::beside(&columns);
        let turned = inverse
            .transpose()
            .times(&b.transpose().minus(&b))
            .times(&inverse);
        self.equal("j22", &self.kernel(KernelKind::J22), &turned);
    }

    /// A, S̄, c and what belongs to them.
    fn speeds(&mut self) {
        let arguments = &self.derived.arguments;
        let spec = &self.derived.spec;
        let near = self.moved(FIRST);
        let basis = self.kernel_at(KernelKind::SpeedBasis, &near);
        let a = self.kernel(KernelKind::Constraint);
        for (name, lowered, declared) in [
            ("speed_basis", &basis, &spec.speed_basis),
            ("constraint", &a, &spec.constraint),
        ] {
            if let Some(Declared { value: m, .. }) = declared {
                let want = Grid::new(m.rows(), m.columns(), self.values.matrix(m));
                self.equal(name, lowered, &want);
            }
        }
        if a.columns > 0 {
            let forbidden = a.transpose().times(&basis.values());
            self.vanish("Aᵀ S̄ = 0", forbidden.entries.into_iter().map(|x| x.value));
            self.regular("rank A", &a);
        }
        self.regular("rank S̄", &basis);
        let gradient = self.run(KernelKind::SpeedBasisGradient, &self.values);
        for (i, slice) in gradient.iter().enumerate() {
            self.equal("speed_basis_gradient", slice, &basis.slope(i));
        }
        let column = |symbols: &[Symbol]| {
            Grid::column(symbols.iter().map(|s| self.values.symbol(s)).collect())
        };
        let (speeds, wrench) = (column(&arguments.speeds), column(&arguments.wrench));
        let map = self
            .kernel_at(KernelKind::TwistMapChild, &near)
            .times(&basis);
        let inverse = self.kernel(KernelKind::VelocityMapInverse);
        let turned = |speeds: &Grid| along(&map, &inverse.times(&basis.values().times(speeds)));
        let rate = turned(&speeds);
        self.equal(
            "bias_acceleration",
            &self.kernel(KernelKind::BiasAcceleration),
            &rate.times(&speeds),
        );
        self.equal(
            "bias_momentum",
            &self.kernel(KernelKind::BiasMomentum),
            &rate.transpose().times(&wrench),
        );
    }
}

/// The derivative along ϕ̇ = `rate`.
fn along(grid: &Grid, rate: &Grid) -> Grid {
    let zero = grid.map(|_| Jet::constant(Ball::zero()));
    (0..rate.rows).fold(zero, |sum, k| {
        sum.plus(&grid.slope(k).map(|x| x.times(rate.at(k, 0))))
    })
}

fn cross(a: &[Jet; 3], b: &[Jet]) -> Vec<Jet> {
    let entry = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].times(&b[k]).minus(&a[k].times(&b[j]))
    };
    (0..3).map(entry).collect()
}

/// Column `i` of `Ad_H` times twists of the child frame: (Rω, Rv + p × Rω).
fn to_parent(r: &Grid, p: &Grid, twists: &Grid, i: usize) -> Grid {
    let part = |first: usize| {
        Grid::column(
            (0..3)
                .map(|row| twists.at(first + row, i).clone())
                .collect(),
        )
    };
    let (omega, linear) = (r.times(&part(0)), r.times(&part(3)));
    let lever = cross(&[0, 1, 2].map(|i| p.entries[i].clone()), &omega.entries);
    let moved = linear.plus(&Grid::column(lever));
    Grid::column([omega.entries, moved.entries].concat())
}
