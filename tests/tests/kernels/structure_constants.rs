//! ∂S/∂ϕ, γ and J22 of every joint of a group against the structure constants of its algebra, from matrices alone.
//!
//! With `[b_k, b_j] = Σ_i c^i_kj b_i` and Φ = Q exp(ϕ): in child axes `∂S_ij/∂ϕ_k = −½ c^i_kj`, `(γ_k)_ij = c^j_ik`,
//! `J22_im = −Σ_l c^l_im p_l`; in parent axes `∂S_ij/∂ϕ_k = ½ Σ_l (Ad_Q)_il c^l_kj`, and γ and J22 with the other sign.

use hamel::joint::{Joint, VelocityFrame};
use hamel::nalgebra::{DMatrix, DVector, SMatrix, SVector};
use hamel_codegen::algebra;
use hamel_codegen::derived::Derived;
use hamel_codegen::expr::{Expr, Symbol, evaluate_f64};
use hamel_codegen::manifold::{Factor, Kind};
use hamel_codegen::matrix::Matrix;

/// Products of two or three numbers below 4, sums of at most nine of them.
const BOUND: f64 = 64.0 * f64::EPSILON;

/// A group with its basis as matrices.
struct Group {
    factor: Factor,
    basis: Vec<DMatrix<f64>>,
}

fn numbers(m: &Matrix, value: &impl Fn(&Symbol) -> f64) -> DMatrix<f64> {
    DMatrix::from_fn(m.rows(), m.columns(), |i, j| {
        evaluate_f64(m.at(i, j), value)
    })
}

impl Group {
    /// The group of a joint: of one factor, moved by exp of a basis; `None` for other joints.
    fn of(joint: &Derived, parameter: impl Fn(&Symbol) -> f64) -> Option<Self> {
        let spec = &joint.spec;
        let [factor] = spec.manifold.value.factors() else {
            return None;
        };
        let freedoms = &spec.freedoms.value;
        let exponential = joint
            .claims
            .iter()
            .any(|c| c.name == "retract_is_exponential")
            || spec.retract.is_none();
        let group = !matches!(factor.kind, Kind::Real(_) | Kind::S2);
        let full = freedoms.len() == factor.kind.dimension()
            && freedoms.iter().all(|f| !f.generator.is_empty());
        let matrix =
            |generator: &Vec<Expr>| numbers(&algebra::hat(factor.kind, generator), &parameter);
        (exponential && group && full).then(|| Self {
            factor: factor.clone(),
            basis: freedoms.iter().map(|f| matrix(&f.generator)).collect(),
        })
    }

    /// Coordinates in the basis, by least squares.
    fn coordinates(&self, element: &DMatrix<f64>) -> DVector<f64> {
        let columns: Vec<DVector<f64>> = self.basis.iter().map(flat).collect();
        let columns = DMatrix::from_columns(&columns);
        let svd = columns.svd(true, true);
        svd.solve(&flat(element), 1e-9)
            .expect("both sides are computed")
    }

    /// Slice k: c^i_kj in row i and column j.
    fn constants(&self) -> Vec<DMatrix<f64>> {
        let slice = |x: &DMatrix<f64>| {
            let columns: Vec<DVector<f64>> = self
                .basis
                .iter()
                .map(|y| self.coordinates(&(x * y - y * x)))
                .collect();
            DMatrix::from_columns(&columns)
        };
        self.basis.iter().map(slice).collect()
    }

    /// Ad_Q on the basis.
    fn adjoint(&self, q: &[f64]) -> DMatrix<f64> {
        let value = |symbol: &Symbol| q[usize::from(symbol.index)];
        let matrix = self.factor.matrix();
        let inverse = self.factor.inverse(&matrix).expect("a group");
        let (matrix, inverse) = (numbers(&matrix, &value), numbers(&inverse, &value));
        let columns: Vec<DVector<f64>> = self
            .basis
            .iter()
            .map(|b| self.coordinates(&(&matrix * b * &inverse)))
            .collect();
        DMatrix::from_columns(&columns)
    }
}

fn flat(m: &DMatrix<f64>) -> DVector<f64> {
    DVector::from_column_slice(m.as_slice())
}

fn close<const K: usize>(what: &str, got: &SMatrix<f64, K, K>, expected: &DMatrix<f64>) {
    let error = (0..K * K)
        .map(|n| (got[n] - expected.as_slice()[n]).abs())
        .fold(0.0, f64::max);
    assert!(
        error <= BOUND,
        "{what}: {error:e}\ngot {got}expected {expected}"
    );
}

fn check<J, const N: usize, const K: usize, const S: usize, const C: usize>(joint: &J)
where
    J: Joint<N, K, S, C>,
{
    let derived = hamel_tests::derived(J::NAME);
    let values: Vec<f64> = joint.parameters().map(|(_, value)| value).collect();
    let Some(group) = Group::of(&derived, |symbol| values[usize::from(symbol.index)]) else {
        return;
    };
    // A declared X may read v in any way: that of a ball is known to be the parent's axes.
    let in_parent = match (J::VELOCITY_FRAME, derived.spec.velocity.value) {
        (VelocityFrame::Parent, _) => true,
        (VelocityFrame::Child, _) => false,
        (VelocityFrame::Declared, _) => return,
    };
    let constants = group.constants();
    for step in 0..20 {
        let away = SVector::from_fn(|i, _| f64::from(step) * 0.1 - 0.7 * i as f64);
        let q = joint.retract(&joint.home(), &away);
        let p: SVector<f64, K> = SVector::from_fn(|i, _| 1.0 - 0.4 * i as f64);
        let left = match in_parent {
            true => group.adjoint(q.as_slice()) * 0.5,
            false => DMatrix::identity(K, K) * -0.5,
        };
        let sign = if in_parent { -1.0 } else { 1.0 };
        for (k, slice) in joint.velocity_map_gradient(&q).iter().enumerate() {
            close(
                &format!("{} dS/dphi_{k}", J::NAME),
                slice,
                &(&left * &constants[k]),
            );
        }
        // Σ_k c^j_ik p_k with p in place of v, and −Σ_l c^l_im p_l.
        let gamma = DMatrix::from_fn(K, K, |i, j| {
            sign * (0..K).map(|k| constants[i][(j, k)] * p[k]).sum::<f64>()
        });
        close(&format!("{} gamma", J::NAME), &joint.gamma(&q, &p), &gamma);
        let j22 = DMatrix::from_fn(K, K, |i, m| {
            -sign * (0..K).map(|l| constants[i][(l, m)] * p[l]).sum::<f64>()
        });
        close(&format!("{} J22", J::NAME), &joint.j22(&q, &p), &j22);
    }
}

macro_rules! structure_test {
    ($module:ident, $joint:ty, $example:expr, $n:literal, $k:literal, $s:literal, $c:literal) => {
        #[test]
        fn $module() {
            check::<$joint, $n, $k, $s, $c>(&$example);
        }
    };
}

hamel_joints::for_each_joint!(structure_test);

/// The paper's groups are among those compared, on both sides.
#[test]
fn groups_of_the_paper_are_compared() {
    for (name, dimension) in [("ball", 3), ("planar", 3), ("cart", 3), ("free", 6)] {
        let group = Group::of(&hamel_tests::derived(name), |_| 0.7).expect("a group");
        assert_eq!(group.basis.len(), dimension, "{name}");
    }
}
