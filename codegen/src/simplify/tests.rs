//! Forms that adding multiples of relations must find.

use super::verify;
use crate::expr::{Expr, Role, Symbol};
use crate::kernel::{Kernel, Method, Step};
use crate::manifold::{Kind, Manifold};

fn shortened(expression: &Expr, relations: &[Expr]) -> Expr {
    let functions = expression.related_functions();
    let given = relations.iter().map(|relation| (None, relation));
    super::shortened(expression, &functions, given)
}

fn rotation() -> (Vec<Expr>, impl Fn(usize, usize) -> Expr) {
    let manifold = Manifold::new(&[("R".to_owned(), Kind::So3)]);
    let coordinates = manifold.coordinates();
    let entry = move |i: usize, j: usize| Expr::symbol(&coordinates[3 * i + j - 4]);
    (manifold.relations(), entry)
}

#[test]
fn a_minor_is_an_entry_with_any_factor_and_beside_other_terms() {
    let (relations, r) = rotation();
    let x = Expr::symbol(&Symbol::new(Role::Velocity, 0, "x"));
    let minor = &(&r(1, 1) * &r(2, 2)) - &(&r(1, 2) * &r(2, 1));
    let other = &x * &r(2, 3);
    let sum = &(&minor * &(&x * &r(3, 1))) + &other;
    let expected = &(&r(3, 3) * &(&x * &r(3, 1))) + &other;
    assert_eq!(shortened(&sum, &relations), expected);
}

#[test]
fn quotients_of_a_root_come_on_one_denominator() {
    let (relations, r) = rotation();
    let root = (&Expr::one() - &r(3, 3).square()).sqrt();
    let quotient = root.recip().expect("a root of a sum is not zero");
    let sum = &(&r(3, 3).square() * &quotient) + &root;
    assert_eq!(shortened(&sum, &relations), quotient);
}

#[test]
fn sines_and_cosines_of_one_angle_add_up() {
    let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
    let sum = &Expr::one() - &x.cos().square();
    assert_eq!(shortened(&sum, &[]), x.sin().square());
}

#[test]
fn a_power_of_a_sum_over_the_sum_is_a_number() {
    let x = Expr::symbol(&Symbol::new(Role::Parameter, 0, "x"));
    let y = Expr::symbol(&Symbol::new(Role::Parameter, 1, "y"));
    let z = Expr::symbol(&Symbol::new(Role::Velocity, 0, "z"));
    let square = (&x - &y).square();
    let inverse = square.recip().expect("not 0");
    for power in 1..3 {
        let quotient = &square.pow(power) * &inverse.pow(power);
        assert_eq!(shortened(&(&quotient * &z), &[]), z, "{power}");
    }
}

#[test]
fn nothing_is_divided_by_that_was_not() {
    let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
    let y = Expr::symbol(&Symbol::new(Role::Coordinate, 1, "y"));
    let relation = &(&x * &y) - &Expr::one();
    let product = &x * &y.square();
    assert_eq!(shortened(&product, &[relation]), y);
}

/// A ball whose X the spec declares with a `let`.
const NAMED: &str = "hamel = 1;
joint slide {
    config x: R1, y: R1;
    let length = sqrt(1 + x * x + y * y);
    H = trans([x, y, length]) * rot_z(2 * length);
}";

#[test]
fn a_kernel_with_another_value_is_found() {
    let spec = crate::spec::parse(NAMED, "slide").expect("a spec");
    let joint = crate::prepare::Prepared::new(spec).expect("a joint");
    let expansion = crate::expand::expand(&joint).expect("it can be expanded");
    let of_all = crate::expand::kernels(&joint, &expansion, &[]).expect("kernels");
    let mut view = super::View::of_body(&joint, &expansion, 0);
    view.kernels.extend(of_all);
    let derived = view.kernels.clone();
    let ((written, words), _) = super::in_words(&joint, &view, &[]);
    assert!(words.iter().any(|word| word.symbol.name() == "length"));
    let is_right =
        |kernels: &[Kernel]| verify::have_values_of(kernels, &derived, &joint, &expansion);
    assert!(is_right(&written));
    for wrong in 0..written.len() {
        let mut kernels = written.clone();
        let output = &mut kernels[wrong].outputs[0];
        let formula = kernels_of_formulas(&written[wrong]);
        *output = output.map(|entry| entry + &Expr::one());
        assert_eq!(is_right(&kernels), !formula, "{:?}", kernels[wrong].kind);
    }
}

/// Whether a kernel has entries, all of them by formulas.
fn kernels_of_formulas(kernel: &Kernel) -> bool {
    let is_line = |step: &Step| matches!(step, Step::Let(..));
    kernel.method == Method::Formula
        && kernel.steps.iter().all(is_line)
        && !kernel.outputs[0].entries().is_empty()
}
