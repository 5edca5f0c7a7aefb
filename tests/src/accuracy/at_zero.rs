//! A joint's kernels at ϕ = 0 from their definitions: (5), (17), (23), (28), (31), and those of c and its dual.

use super::declared::{Declared, constants, slopes, to_child, values};
use super::program::Sheet;
use super::{Grid, Jet, Node};
use hamel_codegen::expr::Number;

/// Degree in ϕ: first derivatives of an X that is one of H itself.
const DEGREE: usize = 2;

/// Everything at one Q.
#[derive(Clone, Debug)]
pub struct AtZero {
    /// R of the body's H(Q), with its derivatives along ϕ.
    rotation: Grid<Jet>,
    /// p of H(Q), likewise.
    translation: Grid<Jet>,
    /// X(Q) of the body, likewise.
    twist_map: Grid<Jet>,
    /// X^c(Q) of the body, likewise.
    twist_map_child: Grid<Jet>,
    /// S₀(Q).
    velocity_map: Grid<Node>,
    /// S₀⁻¹(Q).
    inverse: Grid<Node>,
    /// ∂S/∂ϕ_k.
    slopes: Vec<Grid<Node>>,
    /// J₀ in the child frame.
    local: Grid<Node>,
    /// A(Q), where declared.
    constraint: Option<Grid<Node>>,
    /// S̄(Q), with its derivatives along ϕ, where declared; the identity where nothing is.
    speed_basis: Option<Grid<Jet>>,
    /// ∂Φ/∂ϕ of the stored scalars.
    tangent: Grid<Node>,
    /// X S − J to first order in ϕ: at ϕ = 0, and its derivative by each ϕ_k. S being a least-squares solution, it vanishes where X spans J.
    mismatch: Vec<Grid<Node>>,
}

/// Arguments of kernels beside Q.
#[derive(Clone, Debug)]
pub struct Arguments {
    /// v, also p.
    pub velocity: Grid<Node>,
    /// v̄.
    pub speeds: Grid<Node>,
    /// h.
    pub wrench: Grid<Node>,
}

impl AtZero {
    /// The definitions at Q.
    ///
    /// The velocities of `still` degrees of freedom move no body: they are the rates of their coordinates, as rows of their own say beside X and J.
    pub fn new(declared: &Declared, still: &[usize], q: &[Node]) -> Self {
        let base = constants(q);
        let moving = declared.moved(&base, &declared.variables(&declared.zero(), 0, DEGREE));
        let mut poses = declared.poses(&moving);
        let jacobian = declared.jacobian(&poses, 0);
        let x = declared.twist_map(&moving);
        let rates = |map: &Grid<Jet>| with_rates(map, still);
        let (velocity_map, slopes) = velocity_map(&rates(&x), &rates(&jacobian));
        let mismatch = mismatch(&x, &jacobian, &velocity_map, &slopes);
        let own = |map: &Grid<Jet>| map.rows_of(6 * declared.body, 6);
        let (x, jacobian) = (own(&x), own(&jacobian));
        let pose = poses.swap_remove(declared.body);
        Self {
            mismatch,
            twist_map_child: to_child(&pose, &x),
            local: values(&to_child(&pose, &jacobian)),
            twist_map: x,
            inverse: velocity_map.inverse(),
            velocity_map,
            slopes,
            constraint: declared.constraint(&base),
            speed_basis: declared.speed_basis(&moving),
            tangent: Grid::from_fn(q.len(), declared.freedoms(), |i, k| moving[i].slope(k)),
            rotation: pose.0,
            translation: pose.1,
        }
    }

    fn freedoms(&self) -> usize {
        self.slopes.len()
    }

    /// All kernels by their names, slices of one kernel in order.
    pub fn kernels(&self, arguments: &Arguments) -> Sheet<Node> {
        let v = &arguments.velocity;
        let mut sheet = Sheet::default();
        sheet.put("pose", values(&self.rotation));
        sheet.put("pose", values(&self.translation));
        sheet.put("twist_map", values(&self.twist_map));
        sheet.put("twist_map_child", values(&self.twist_map_child));
        sheet.put("velocity_map", self.velocity_map.clone());
        sheet.put("velocity_map_inverse", self.inverse.clone());
        for k in 0..self.freedoms() {
            let of_child = slopes(&self.twist_map_child, k);
            sheet.put("twist_map_child_gradient", of_child);
            sheet.put("velocity_map_gradient", self.slopes[k].clone());
        }
        for mismatch in &self.mismatch {
            sheet.put("mismatch", mismatch.clone());
        }
        sheet.put("local_twist_map", self.local.clone());
        sheet.put("gamma", self.gamma(v));
        sheet.put("j22", self.j22(v));
        sheet.put("configuration_rate", self.configuration_rate(v));
        if let Some(constraint) = &self.constraint {
            sheet.put("constraint", constraint.clone());
        }
        if let Some(basis) = &self.speed_basis {
            self.speeds(basis, arguments, &mut sheet);
        }
        sheet
    }

    /// Kernels of S̄.
    fn speeds(&self, basis: &Grid<Jet>, arguments: &Arguments, sheet: &mut Sheet<Node>) {
        sheet.put("speed_basis", values(basis));
        for k in 0..self.freedoms() {
            sheet.put("speed_basis_gradient", slopes(basis, k));
        }
        let rate = self.twist_rate(basis, &arguments.speeds);
        sheet.put("bias_acceleration", rate.times(&arguments.speeds));
        sheet.put("bias_momentum", rate.transpose().times(&arguments.wrench));
    }

    /// The derivatives of R, p, X, X^c and S̄ along ϕ̇ = `rate`, and the motion of the stored scalars.
    pub fn derivatives(&self, rate: &Grid<Node>) -> Sheet<Node> {
        let mut sheet = Sheet::default();
        sheet.put("motion", self.tangent.times(rate));
        sheet.put("rotation", along(&self.rotation, rate));
        sheet.put("translation", along(&self.translation, rate));
        sheet.put("twist_map", along(&self.twist_map, rate));
        sheet.put("twist_map_child", along(&self.twist_map_child, rate));
        if let Some(basis) = &self.speed_basis {
            sheet.put("speed_basis", along(basis, rate));
        }
        sheet
    }

    /// Σ γ_k v_k, (17).
    fn gamma(&self, v: &Grid<Node>) -> Grid<Node> {
        let k = self.freedoms();
        let w = self.inverse.times(v);
        let inner = Grid::from_fn(k, k, |l, j| {
            let term = |m: usize| {
                let turned = self.slopes[l].at(j, m).negative();
                self.slopes[m].at(j, l).plus(&turned).times(w.at(m, 0))
            };
            (1..k).fold(term(0), |sum, m| sum.plus(&term(m)))
        });
        self.inverse.transpose().times(&inner)
    }

    /// J22(Q, p), (28).
    fn j22(&self, p: &Grid<Node>) -> Grid<Node> {
        let k = self.freedoms();
        let columns: Vec<Grid<Node>> = (0..k)
            .map(|m| self.slopes[m].transpose().times(p))
            .collect();
        let b = Grid::from_fn(k, k, |i, m| columns[m].at(i, 0).clone());
        let turned = b.transpose().minus(&b);
        self.inverse.transpose().times(&turned).times(&self.inverse)
    }

    /// Q̇(Q, v), (31).
    fn configuration_rate(&self, v: &Grid<Node>) -> Grid<Node> {
        self.tangent.times(&self.inverse.times(v))
    }

    /// Ẋ̄^c with X̄ = X S̄, at the speeds v̄.
    fn twist_rate(&self, basis: &Grid<Jet>, speeds: &Grid<Node>) -> Grid<Node> {
        let map = self.twist_map_child.times(basis);
        let rate = self.inverse.times(&values(basis).times(speeds));
        along(&map, &rate)
    }
}

/// The derivative along ϕ̇ = `rate`.
fn along(grid: &Grid<Jet>, rate: &Grid<Node>) -> Grid<Node> {
    let term = |k: usize| slopes(grid, k).map(|entry| entry.times(rate.at(k, 0)));
    (1..rate.rows).fold(term(0), |sum, k| sum.plus(&term(k)))
}

/// X₀ S₀ − J₀ and X₀ S_k + X_k S₀ − J_k.
fn mismatch(
    x: &Grid<Jet>,
    j: &Grid<Jet>,
    start: &Grid<Node>,
    slices: &[Grid<Node>],
) -> Vec<Grid<Node>> {
    let base = values(x);
    let first = base.times(start).minus(&values(j));
    let slice = |(k, slice): (usize, &Grid<Node>)| {
        let left = base.times(slice).plus(&slopes(x, k).times(start));
        left.minus(&slopes(j, k))
    };
    let rest = slices.iter().enumerate().map(slice);
    std::iter::once(first).chain(rest).collect()
}

/// The map with a unit row for each of these degrees of freedom.
fn with_rates(map: &Grid<Jet>, still: &[usize]) -> Grid<Jet> {
    Grid::from_fn(map.rows + still.len(), map.columns, |i, k| {
        match i < map.rows {
            true => map.at(i, k).clone(),
            false => Jet::input(f64::from(still[i - map.rows] == k)),
        }
    })
}

/// X₀ S₀ = J₀ and X₀ S_k = J_k − X_k S₀, (23) order by order.
fn velocity_map(x: &Grid<Jet>, j: &Grid<Jet>) -> (Grid<Node>, Vec<Grid<Node>>) {
    let base = values(x);
    let left = base.left_inverse();
    let start = base.solve_by(&left, &values(j));
    let slice = |k: usize| {
        let right = slopes(j, k).minus(&slopes(x, k).times(&start));
        base.solve_by(&left, &right)
    };
    let all = (0..j.columns).map(slice).collect();
    (start, all)
}
