use super::{Expr, Role, Symbol, evaluate_f64};

fn symbols() -> (Symbol, Symbol, Expr, Expr) {
    let a = Symbol::new(Role::Coordinate, 0, "a");
    let b = Symbol::new(Role::Coordinate, 1, "b");
    let (x, y) = (Expr::symbol(&a), Expr::symbol(&b));
    (a, b, x, y)
}

#[test]
fn sums_that_are_equal_are_the_same_value() {
    let (_, _, x, y) = symbols();
    assert_eq!(
        (&x + &y).square(),
        &(&x.square() + &y.square()) + &(&Expr::integer(2) * &(&y * &x))
    );
}

#[test]
fn angles_written_differently_agree() {
    let (_, _, x, y) = symbols();
    let two = Expr::integer(2);
    assert_eq!((&two * &x).sin(), &two * &(&x.sin() * &x.cos()));
    assert_eq!(
        (&x + &y).cos(),
        &(&x.cos() * &y.cos()) - &(&x.sin() * &y.sin())
    );
    assert_eq!((-&x).sin(), -x.sin());
    assert_eq!((&x + &Expr::pi()).sin(), -x.sin());
}

#[test]
fn cosines_of_parts_of_a_turn_are_exact() {
    for twelfths in (-30..=30).filter(|n| n % 2 == 0 || n % 3 == 0) {
        let angle = &Expr::fraction(twelfths, 12) * &Expr::pi();
        let at = |e: &Expr| e.evaluate(&0.0, &|_| f64::NAN);
        let (sin, cos) = (twelfths as f64 * std::f64::consts::PI / 12.0).sin_cos();
        assert!((at(&angle.cos()) - cos).abs() < 1e-14, "{twelfths} π/12");
        assert!((at(&angle.sin()) - sin).abs() < 1e-14, "{twelfths} π/12");
        let functions = angle.cos().related_functions();
        assert!(!format!("{functions:?}").contains("Cos"), "{twelfths} π/12");
    }
}

/// Central differences with step 1e-5 of functions with third derivatives below 100: error below 2e-9.
#[test]
fn derivatives_agree_with_differences() {
    let (a, _, x, y) = symbols();
    let s = &x.square() + &y;
    let candidates = [
        x.sin(),
        (&x * &y).exp(),
        s.sinh(),
        s.cosh(),
        s.sech(),
        s.tanh(),
        s.cosh().ln(),
        s.sqrt(),
        s.recip().expect("not zero"),
        y.atan2(&x),
        s.ln(),
        s.stumpff(0),
        s.stumpff(1),
        s.stumpff(3),
        s.dexp_inverse(0),
        s.dexp_inverse(1),
    ];
    for f in candidates {
        let at = |value: f64| {
            evaluate_f64(&f, &|symbol: &Symbol| {
                if *symbol == a { value } else { 0.7 }
            })
        };
        let exact = evaluate_f64(&f.derivative(&a), &|symbol: &Symbol| {
            if *symbol == a { 0.4 } else { 0.7 }
        });
        let difference = (at(0.4 + 1e-5) - at(0.4 - 1e-5)) / 2e-5;
        assert!(
            (difference - exact).abs() < 2e-9,
            "{f}: {exact} against {difference}"
        );
    }
}

#[test]
fn values_at_zero_are_the_limits() {
    let (a, _, x, _) = symbols();
    let tiny = |f: &Expr| evaluate_f64(f, &|_| 1e-9);
    for f in [
        x.stumpff(2),
        x.stumpff(3),
        x.dexp_inverse(0),
        x.dexp_inverse(1),
    ] {
        let limit = evaluate_f64(&f.at_zero(std::slice::from_ref(&a)), &|_| f64::NAN);
        // The functions change by less than their argument here.
        assert!((limit - tiny(&f)).abs() < 1e-9, "{f}: {limit}");
    }
}

#[test]
fn reciprocals_of_parameters_cancel() {
    let lead = Expr::symbol(&Symbol::new(Role::Parameter, 0, "lead"));
    assert!((&lead * &lead.recip().expect("not zero")).is_one());
}

#[test]
fn equal_functions_are_one_indeterminate_whether_shared_or_not() {
    let root = || Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x")).sqrt();
    let (one, other) = (root(), root());
    assert_eq!(one.atoms(), other.atoms());
    assert!((&one - &other).is_zero() && (&one - &one.clone()).is_zero());
    // Symbols stand before functions, whatever the functions hold.
    let last = Expr::symbol(&Symbol::new(Role::Intermediate, 9, "z"));
    let atom = |e: &Expr| e.atoms().into_iter().next().expect("one atom");
    assert!(atom(&last) < atom(&one));
}
