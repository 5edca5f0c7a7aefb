//! Examples 1–6 of the paper, with the errata: what the generator derives, compared in symbols.

use hamel_codegen::derived::{Derived, KernelKind, Structure};
use hamel_codegen::expr::{Expr, Symbol};
use hamel_codegen::matrix::Matrix;
use hamel_tests::derived;

fn output(joint: &Derived, kind: KernelKind) -> Matrix {
    joint
        .kernel(kind)
        .expect("every joint has every kernel")
        .expanded()
        .swap_remove(0)
}

fn structure(joint: &Derived, kind: KernelKind) -> Structure {
    joint
        .kernel(kind)
        .expect("every joint has every kernel")
        .structure
}

fn same_on_manifold(joint: &Derived, a: &Matrix, b: &Matrix) -> bool {
    joint
        .spec
        .manifold
        .value
        .ideal()
        .normal_forms(&a.minus(b))
        .is_zero()
}

fn vector(symbols: &[Symbol]) -> Vec<Expr> {
    symbols.iter().map(Expr::symbol).collect()
}

/// Q as the group element's square matrix.
fn q(joint: &Derived) -> Matrix {
    joint.spec.manifold.value.factors()[0].matrix()
}

fn series(joint: &Derived) -> Matrix {
    let (left, right) = &joint.velocity_map_series;
    left.times(right)
}

fn half() -> Expr {
    Expr::fraction(1, 2)
}

/// (9) and (32).
#[test]
fn ball_velocity_map_is_q_times_one_plus_half_phi() {
    let ball = derived("ball");
    let phi = Matrix::tilde(&vector(&ball.arguments.local));
    let expected = q(&ball).times(&Matrix::identity(3).plus(&phi.scale(&half())));
    assert!(same_on_manifold(&ball, &series(&ball), &expected));
    // By itself: S₀ is printed as the entries of Q, which needs cof Q = Q, and I + ½ ϕ~ as it stands.
    assert_eq!(ball.velocity_map_series.0, q(&ball));
    assert_eq!(
        ball.velocity_map_series.1,
        Matrix::identity(3).plus(&phi.scale(&half()))
    );
    assert_eq!(
        output(&ball, KernelKind::TwistMap),
        Matrix::identity(3).stack(&Matrix::zeros(3, 3))
    );
}

/// Example 5.
#[test]
fn ball_j22_is_minus_p_tilde() {
    let ball = derived("ball");
    let p = vector(&ball.arguments.momentum);
    assert_eq!(
        output(&ball, KernelKind::J22),
        Matrix::tilde(&p).map(|entry| -entry)
    );
}

/// (13), whose entries are those of Q.
#[test]
fn planar_twist_map_is_that_of_example_2() {
    let planar = derived("planar");
    let q = q(&planar);
    let zero = Expr::zero;
    let rows = vec![
        zero(),
        zero(),
        zero(),
        zero(),
        zero(),
        zero(),
        Expr::one(),
        zero(),
        zero(),
        q.at(1, 2).clone(),
        q.at(0, 0).clone(),
        q.at(0, 1).clone(),
        -q.at(0, 2),
        q.at(1, 0).clone(),
        q.at(1, 1).clone(),
        zero(),
        zero(),
        zero(),
    ];
    let expected = Matrix::from_entries(6, 3, rows).expect("18 entries");
    assert_eq!(output(&planar, KernelKind::TwistMap), expected);
}

/// `ad_ϕ` of se(2) in the order (turn, forward, sideways).
fn ad_of_se2(x: &[Expr]) -> Matrix {
    let zero = Expr::zero;
    let rows = vec![
        zero(),
        zero(),
        zero(),
        x[2].clone(),
        zero(),
        -&x[0],
        -&x[1],
        x[0].clone(),
        zero(),
    ];
    Matrix::from_entries(3, 3, rows).expect("9 entries")
}

/// Erratum of Example 6: S is not I but I − ½ ad_ϕ.
#[test]
fn planar_velocity_map_has_a_first_order_part() {
    let planar = derived("planar");
    let ad = ad_of_se2(&vector(&planar.arguments.local));
    assert_eq!(
        series(&planar),
        Matrix::identity(3).minus(&ad.scale(&half()))
    );
    assert_eq!(
        structure(&planar, KernelKind::VelocityMap),
        Structure::Identity
    );
    assert_ne!(
        structure(&planar, KernelKind::VelocityMapGradient),
        Structure::Zero
    );
}

/// With M = diag(J, m, m): `m v̇₂ − m v₁ v₃ = 0`, `m v̇₃ + m v₁ v₂ = 0`: the velocity is constant in world axes.
#[test]
fn a_free_planar_body_moves_straight() {
    let planar = derived("planar");
    let v = vector(&planar.arguments.velocity);
    let p = &planar.arguments.momentum;
    let mass = Expr::integer(3);
    let values = [&Expr::integer(2) * &v[0], &mass * &v[1], &mass * &v[2]];
    let momentum = p.iter().cloned().zip(values).collect();
    let j22 = output(&planar, KernelKind::J22).map(|entry| entry.substitute(&momentum));
    let force = j22.times(&Matrix::column_vector(v.clone()));
    assert!(force.at(0, 0).is_zero());
    assert_eq!(*force.at(1, 0), &mass * &(&v[0] * &v[2]));
    assert_eq!(*force.at(2, 0), -&(&mass * &(&v[0] * &v[1])));
}

/// Examples 3 and 6: (14), (15), and the entries ∓p₃ of S̄ᵀJ22S̄ that an offset centre of mass brings.
#[test]
fn cart_constraint_and_reduced_j22() {
    let cart = derived("cart");
    assert_eq!(
        output(&cart, KernelKind::Constraint),
        Matrix::integers(&[[0], [0], [1]])
    );
    let basis = output(&cart, KernelKind::SpeedBasis);
    assert_eq!(basis, Matrix::integers(&[[1, 0], [0, 1], [0, 0]]));
    assert_eq!(
        structure(&cart, KernelKind::SpeedBasisGradient),
        Structure::Zero
    );
    let reduced = basis
        .transpose()
        .times(&output(&cart, KernelKind::J22))
        .times(&basis);
    let lateral = Expr::symbol(&cart.arguments.momentum[2]);
    let expected = Matrix::from_entries(2, 2, vec![Expr::zero(), -&lateral, lateral, Expr::zero()])
        .expect("4 entries");
    assert_eq!(reduced, expected);
    assert_eq!(cart.speed_names, ["turn", "forward"]);
}

/// Example 4, and the closing note of Example 2: where v is the rate of Euclidean coordinates, S = I and J22 = 0.
#[test]
fn euclidean_joints_have_trivial_hamel_terms() {
    for name in ["revolute", "prismatic", "planar_euclidean"] {
        let joint = derived(name);
        for kind in [
            KernelKind::VelocityMap,
            KernelKind::VelocityMapInverse,
            KernelKind::RetractDifferentialInverse,
        ] {
            assert_eq!(
                structure(&joint, kind),
                Structure::Identity,
                "{name} {kind:?}"
            );
        }
        for kind in [
            KernelKind::VelocityMapGradient,
            KernelKind::Gamma,
            KernelKind::J22,
        ] {
            assert_eq!(structure(&joint, kind), Structure::Zero, "{name} {kind:?}");
        }
    }
}

/// SE(3) in child axes: `S = I − ½ ad_ϕ`, and momenta turn by the dual bracket, `J22 v = ad_vᵀ p`.
#[test]
fn free_joint_is_the_bracket_of_se3() {
    let free = derived("free");
    let local = vector(&free.arguments.local);
    let ad = hamel_codegen::expand::bracket(&local);
    assert_eq!(series(&free), Matrix::identity(6).minus(&ad.scale(&half())));
    let v = vector(&free.arguments.velocity);
    let force = output(&free, KernelKind::J22).times(&Matrix::column_vector(v.clone()));
    let dual = hamel_codegen::expand::bracket(&v).transpose();
    let expected = dual.times(&Matrix::column_vector(vector(&free.arguments.momentum)));
    assert_eq!(force, expected);
}

/// Signs of the table of structure constants: γ on the left of (24), J22 on the right of (27), `Σ γ_k v_k p = −J22 v`.
#[test]
fn gamma_and_j22_are_two_forms_of_one_term() {
    for name in hamel_tests::spec_names() {
        let joint = derived(&name);
        let p = Matrix::symbols(&joint.arguments.momentum);
        let v = Matrix::symbols(&joint.arguments.velocity);
        let sum = output(&joint, KernelKind::Gamma)
            .times(&p)
            .plus(&output(&joint, KernelKind::J22).times(&v));
        assert!(
            same_on_manifold(&joint, &sum, &Matrix::zeros(v.rows(), 1)),
            "{name}"
        );
    }
}
