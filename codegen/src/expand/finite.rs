//! Finite maps of a joint whose Φ is `Q exp(ϕ)` on every factor: Φ, its inverse and differential; projection and residual of any joint.

use super::steps::Steps;
use crate::algebra;
use crate::expr::{Expr, Symbol};
use crate::kernel::{Primitive, Step};
use crate::manifold::{Factor, Kind};
use crate::matrix::Matrix;
use crate::model::Freedom;
use crate::prepare::{Prepared, local_element};

/// Lines and result of a kernel.
pub type Body = (Vec<Step>, Matrix);

/// Prefix of the names of one factor's intermediate values: none where it is the only one.
fn prefix(joint: &Prepared, factor: &Factor) -> String {
    match joint.space.manifold.factors().len() {
        1 => String::new(),
        _ => format!("{}_", factor.name.to_ascii_lowercase()),
    }
}

/// Φ(Q, ϕ) = Q exp(Σ b_k ϕ_k); `None` where exp has no closed form.
pub fn retract(joint: &Prepared) -> Option<Body> {
    let mut steps = Steps::default();
    let mut moved = vec![];
    for (n, factor) in joint.space.manifold.factors().iter().enumerate() {
        let prefix = prefix(joint, factor);
        let xi = local_element(&joint.spec, n);
        let mut square = None;
        let exp = algebra::exp_by(&xi, |order, s| {
            let bound = square
                .get_or_insert_with(|| steps.bind(&format!("{prefix}theta_squared"), s.clone()))
                .clone();
            steps.bind(&format!("{prefix}c{order}"), bound.stumpff(order))
        })?;
        let exp = match factor.kind {
            Kind::Real(_) => exp,
            _ => steps.bind_matrix(&format!("{prefix}e"), &exp),
        };
        moved.extend(factor.coordinates_of(&factor.matrix().times(&exp)));
    }
    Some((steps.finish(), Matrix::column_vector(moved)))
}

/// ϕ with Φ(Q, ϕ) = Q′: `log(Q⁻¹ Q′)` in the declared basis.
pub fn local(joint: &Prepared, target: &[Factor]) -> Option<Body> {
    let mut steps = Steps::default();
    let mut locals = vec![Expr::zero(); joint.spec.freedoms.value.len()];
    for (n, (factor, goal)) in joint
        .space
        .manifold
        .factors()
        .iter()
        .zip(target)
        .enumerate()
    {
        let relative = factor.inverse(&factor.matrix())?.times(&goal.matrix());
        let prefix = prefix(joint, factor);
        let standard = logarithm(factor.kind, &relative, &prefix, &mut steps)?;
        let freedoms = joint
            .spec
            .freedoms
            .value
            .iter()
            .enumerate()
            .filter(|(_, f)| f.factor == n);
        let (places, freedoms): (Vec<usize>, Vec<&Freedom>) = freedoms.unzip();
        for (place, value) in places.into_iter().zip(in_basis(&freedoms, &standard)) {
            locals[place] = value;
        }
    }
    Some((steps.finish(), Matrix::column_vector(locals)))
}

/// Coordinates in the declared basis of the element with the given standard coordinates.
pub fn in_basis(freedoms: &[&Freedom], standard: &[Expr]) -> Vec<Expr> {
    let columns: Vec<Vec<Expr>> = freedoms
        .iter()
        .map(|freedom| freedom.generator.clone())
        .collect();
    let basis = Matrix::from_columns(standard.len(), &columns);
    // A basis of a subalgebra has fewer columns than rows; within its orbit any left inverse gives the same.
    let inverse = algebra::simplified(&algebra::left_inverse(&basis));
    let coordinates = inverse.times(&Matrix::column_vector(standard.to_vec()));
    coordinates.entries().to_vec()
}

/// Standard coordinates of the logarithm of a group element given as a matrix.
fn logarithm(kind: Kind, m: &Matrix, prefix: &str, steps: &mut Steps) -> Option<Vec<Expr>> {
    let named = |name: &str| format!("{prefix}{name}");
    Some(match kind {
        Kind::Real(size) => (0..size).map(|i| m.at(i, size).clone()).collect(),
        Kind::S1 | Kind::So2 => vec![steps.bind(&named("angle"), m.at(1, 0).atan2(m.at(0, 0)))],
        Kind::So3 => rotation_vector(m.clone(), prefix, steps),
        // Not by its rotation matrix: differences of products there lose the digits of small components.
        Kind::S3 => {
            let quaternion = Matrix::column_vector(m.column(0));
            named_vector(Primitive::QuaternionVector, quaternion, prefix, steps)
        }
        Kind::Se2 => {
            let angle = steps.bind(&named("angle"), m.at(1, 0).atan2(m.at(0, 0)));
            let t = steps.bind_matrix(&named("t"), &m.block(0, 2, 2, 1));
            let square = steps.bind(&named("theta_squared"), angle.square());
            // (θ/2) cot(θ/2) = 1 − θ² G(θ²).
            let cotangent = &Expr::one() - &(&square * &square.dexp_inverse(0));
            let cotangent = steps.bind(&named("half_cotangent"), cotangent);
            let half = steps.bind(&named("half_angle"), &angle * &Expr::fraction(1, 2));
            let x = &(&cotangent * t.at(0, 0)) + &(&half * t.at(1, 0));
            let y = &(&cotangent * t.at(1, 0)) - &(&half * t.at(0, 0));
            vec![angle, x, y]
        }
        Kind::Se3 => {
            let omega = rotation_vector(m.block(0, 0, 3, 3), prefix, steps);
            let p = steps.bind_matrix(&named("t"), &m.block(0, 3, 3, 1));
            let square: Expr = omega.iter().map(Expr::square).sum();
            let square = steps.bind(&named("theta_squared"), square);
            let g = steps.bind(&named("g"), square.dexp_inverse(0));
            let tilde = Matrix::tilde(&omega);
            let once = steps.bind_matrix(&named("r_cross_t"), &tilde.times(&p));
            let twice = tilde.times(&once).scale(&g);
            let rho = p.minus(&once.scale(&Expr::fraction(1, 2))).plus(&twice);
            omega
                .into_iter()
                .chain(rho.entries().iter().cloned())
                .collect()
        }
        Kind::S2 => return None,
    })
}

fn rotation_vector(rotation: Matrix, prefix: &str, steps: &mut Steps) -> Vec<Expr> {
    named_vector(Primitive::RotationVector, rotation, prefix, steps)
}

fn named_vector(
    primitive: Primitive,
    argument: Matrix,
    prefix: &str,
    steps: &mut Steps,
) -> Vec<Expr> {
    let names = ["r1", "r2", "r3"].map(|name| format!("{prefix}{name}"));
    let names = names.each_ref().map(String::as_str);
    steps.call(primitive, argument, &names)
}

/// `D⁻¹ u` with `D = Σ (−ad_ϕ)ⁿ/(n+1)!`: `u + ½ [ϕ, u] + G [ϕ, [ϕ, u]] + …`; `None` where no closed form fits.
pub fn retract_differential_inverse(
    joint: &Prepared,
    constants: &[Matrix],
    rate: &[Symbol],
) -> Option<Body> {
    let size = rate.len();
    let mut steps = Steps::default();
    let mut rates = Matrix::symbols(rate);
    for (n, factor) in joint.space.manifold.factors().iter().enumerate() {
        let places: Vec<usize> = (0..size)
            .filter(|&k| joint.spec.freedoms.value[k].factor == n)
            .collect();
        let ad = restricted_adjoint(joint, constants, &places);
        if ad.is_zero() {
            continue;
        }
        let prefix = prefix(joint, factor);
        let rate = rates.select_rows(&places);
        let solved = inverse_differential(&ad, &rate, &prefix, &mut steps)?;
        rates = Matrix::from_fn(size, 1, |i, _| {
            match places.iter().position(|&place| place == i) {
                Some(row) => solved.at(row, 0).clone(),
                None => rates.at(i, 0).clone(),
            }
        });
    }
    Some((steps.finish(), rates))
}

/// `ad_ϕ` on the degrees of freedom at `places`: entry (i, j) is `Σ_k c^i_kj ϕ_k`.
fn restricted_adjoint(joint: &Prepared, constants: &[Matrix], places: &[usize]) -> Matrix {
    Matrix::from_fn(places.len(), places.len(), |i, j| {
        let term = |&k: &usize| {
            constants[k].at(places[i], places[j])
                * &Expr::symbol(&joint.spec.freedoms.value[k].local)
        };
        places.iter().map(term).sum()
    })
}

fn inverse_differential(
    ad: &Matrix,
    rate: &Matrix,
    prefix: &str,
    steps: &mut Steps,
) -> Option<Matrix> {
    let named = |name: &str| format!("{prefix}{name}");
    let ending = ending(ad)?;
    let once = steps.bind_matrix(&named("bracket"), &ad.times(rate));
    let half = once.scale(&Expr::fraction(1, 2));
    let linear = rate.plus(&half);
    let (Ending::Simple(s) | Ending::Double(s, _)) = &ending else {
        return Some(linear);
    };
    let theta_squared = steps.bind(&named("theta_squared"), s.clone());
    let g = steps.bind(&named("g"), theta_squared.dexp_inverse(0));
    let twice = steps.bind_matrix(&named("double_bracket"), &ad.times(&once));
    let quadratic = linear.plus(&twice.scale(&g));
    let Ending::Double(_, excess) = &ending else {
        return Some(quadratic);
    };
    // The even part is its tangent at the double root.
    let slope = steps.bind(&named("g_slope"), theta_squared.dexp_inverse(1));
    let excess = steps.bind_matrix(&named("excess"), &excess.times(rate));
    let excess = ad.times(&excess).scale(&slope);
    Some(quadratic.minus(&excess))
}

/// D with `Φ(Q, ϕ + δ) = Φ(Q′, D δ) + O(δ²)`: `Σ (−ad_ϕ)ⁿ/(n+1)!`, K×K; `None` where no closed form fits.
pub fn retract_differential(joint: &Prepared, constants: &[Matrix]) -> Option<Body> {
    let size = joint.spec.freedoms.value.len();
    let mut steps = Steps::default();
    let mut whole = Matrix::identity(size);
    for (n, factor) in joint.space.manifold.factors().iter().enumerate() {
        let places: Vec<usize> = (0..size)
            .filter(|&k| joint.spec.freedoms.value[k].factor == n)
            .collect();
        let ad = restricted_adjoint(joint, constants, &places);
        if ad.is_zero() {
            continue;
        }
        let own = differential(&ad, &prefix(joint, factor), &mut steps)?;
        let place = |i: usize| places.iter().position(|&place| place == i);
        whole = Matrix::from_fn(size, size, |i, j| match (place(i), place(j)) {
            (Some(row), Some(column)) => own.at(row, column).clone(),
            _ => whole.at(i, j).clone(),
        });
    }
    Some((steps.finish(), whole))
}

/// How powers of ad_ϕ end.
enum Ending {
    /// `ad² = 0`.
    Nilpotent,
    /// `ad (ad² + s) = 0`.
    Simple(Expr),
    /// `ad (ad² + s)² = 0`, and what one factor leaves, `ad (ad² + s)`: multiplied out, most of its entries vanish, and none cancels.
    Double(Expr, Matrix),
}

/// Every subalgebra of se(3) ends in one of these ways.
fn ending(ad: &Matrix) -> Option<Ending> {
    let square = algebra::simplified(&ad.times(ad));
    if algebra::vanishes(&square) {
        return Some(Ending::Nilpotent);
    }
    let cube = square.times(ad);
    for rank in [2, 4] {
        let s = &-square.trace() * &Expr::fraction(1, rank);
        let excess = algebra::simplified(&cube.plus(&ad.scale(&s)));
        if algebra::vanishes(&excess) {
            return Some(Ending::Simple(s));
        }
        let left = excess.times(&square).plus(&excess.scale(&s));
        if algebra::vanishes(&left) {
            return Some(Ending::Double(s, excess));
        }
    }
    None
}

/// `Σ (−ad)ⁿ/(n+1)! = I − ad O(ad²) + ad² E(ad²)` with `O(−s) = c₂(s)` and `E(−s) = c₃(s)`.
///
/// On the range of ad, ad² is −s, or nearly so: where −s is a double root, O and E are their tangents there, with the slopes
/// `dc₂/ds = c₄ − c₃/2` and `dc₃/ds = (3 c₅ − c₄)/2`, so that D is the chain rule through ϕ ↦ c₂, c₃: its summands do not cancel.
fn differential(ad: &Matrix, prefix: &str, steps: &mut Steps) -> Option<Matrix> {
    let identity = Matrix::identity(ad.rows());
    let named = |name: &str| format!("{prefix}{name}");
    let ending = ending(ad)?;
    let (Ending::Simple(s) | Ending::Double(s, _)) = &ending else {
        return Some(identity.minus(&ad.scale(&Expr::fraction(1, 2))));
    };
    let square = steps.bind_matrix(&named("ad_squared"), &ad.times(ad));
    let s = steps.bind(&named("theta_squared"), s.clone());
    let mut coefficient = |order: u8| steps.bind(&named(&format!("c{order}")), s.stumpff(order));
    let (c2, c3) = (coefficient(2), coefficient(3));
    let odd = ad.scale(&c2);
    let even = square.scale(&c3);
    let Ending::Double(_, excess) = &ending else {
        return Some(identity.minus(&odd).plus(&even));
    };
    let (c4, c5) = (coefficient(4), coefficient(5));
    let half = |e: Expr| &e * &Expr::fraction(1, 2);
    let odd_slope = steps.bind(&named("odd_slope"), &c4 - &half(c3.clone()));
    let even_slope = half(&(&Expr::integer(3) * &c5) - &c4);
    let even_slope = steps.bind(&named("even_slope"), even_slope);
    let odd_excess = steps.bind_matrix(&named("odd_excess"), excess);
    let even_excess = steps.bind_matrix(&named("even_excess"), &ad.times(&odd_excess));
    let odd = odd.minus(&odd_excess.scale(&odd_slope));
    let even = even.minus(&even_excess.scale(&even_slope));
    Some(identity.minus(&odd).plus(&even))
}

/// The nearest configuration on the manifold.
pub fn project(joint: &Prepared) -> Body {
    let mut steps = Steps::default();
    let mut projected = vec![];
    for factor in joint.space.manifold.factors() {
        projected.extend(projected_factor(factor, &prefix(joint, factor), &mut steps));
    }
    (steps.finish(), Matrix::column_vector(projected))
}

fn projected_factor(factor: &Factor, prefix: &str, steps: &mut Steps) -> Vec<Expr> {
    let q: Vec<Expr> = factor.coordinates.iter().map(Expr::symbol).collect();
    match factor.kind {
        Kind::Real(_) => q,
        Kind::S1 | Kind::S2 | Kind::S3 => normalised(&q, prefix, steps),
        Kind::So2 | Kind::Se2 => {
            let m = factor.matrix();
            let half = Expr::fraction(1, 2);
            let cos = steps.bind(&format!("{prefix}cos"), &(m.at(0, 0) + m.at(1, 1)) * &half);
            let sin = steps.bind(&format!("{prefix}sin"), &(m.at(1, 0) - m.at(0, 1)) * &half);
            let unit = normalised(&[cos, sin], prefix, steps);
            let turned = Matrix::from_fn(m.rows(), m.columns(), |i, j| match (i, j) {
                (0, 0) | (1, 1) => unit[0].clone(),
                (1, 0) => unit[1].clone(),
                (0, 1) => -&unit[1],
                _ => m.at(i, j).clone(),
            });
            factor.coordinates_of(&turned)
        }
        Kind::So3 | Kind::Se3 => {
            let m = factor.matrix();
            let names: Vec<String> = (0..9)
                .map(|n| format!("{prefix}r{}{}", n / 3 + 1, n % 3 + 1))
                .collect();
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let r = steps.call(Primitive::NearestRotation, m.block(0, 0, 3, 3), &names);
            let turned = Matrix::from_fn(m.rows(), m.columns(), |i, j| match i < 3 && j < 3 {
                true => r[3 * i + j].clone(),
                false => m.at(i, j).clone(),
            });
            factor.coordinates_of(&turned)
        }
    }
}

fn normalised(q: &[Expr], prefix: &str, steps: &mut Steps) -> Vec<Expr> {
    let square: Expr = q.iter().map(Expr::square).sum();
    let norm = steps.bind(&format!("{prefix}norm"), square.sqrt());
    let inverse = steps.bind(
        &format!("{prefix}inverse_norm"),
        norm.recip().unwrap_or_default(),
    );
    q.iter().map(|entry| entry * &inverse).collect()
}

/// The relations whose residual says how far Q is off its manifold: enough of them, none twice.
pub fn residual(joint: &Prepared) -> Matrix {
    Matrix::column_vector(
        joint
            .spec
            .manifold
            .value
            .factors()
            .iter()
            .flat_map(residual_of_factor)
            .chain(joint.space.manifold.declared().iter().cloned())
            .collect(),
    )
}

/// The relations of one factor: enough of them, none twice.
pub fn residual_of_factor(factor: &Factor) -> Vec<Expr> {
    match factor.kind {
        Kind::So3 | Kind::Se3 => {
            let r = factor.matrix().block(0, 0, 3, 3);
            let gram = r.transpose().times(&r).minus(&Matrix::identity(3));
            let upper = (0..3).flat_map(|i| (i..3).map(move |j| (i, j)));
            // RᵀR = I leaves reflections; the determinant does not.
            let orientation = &r.determinant(&Expr::clone) - &Expr::one();
            upper
                .map(|(i, j)| gram.at(i, j).clone())
                .chain([orientation])
                .collect()
        }
        _ => factor.relations(),
    }
}
