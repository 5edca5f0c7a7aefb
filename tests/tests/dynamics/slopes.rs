//! Derivatives on the graph of a scene's functions: those of exponentials against dual numbers, also where exponentials overflow.

use hamel::scalar::{Dual, Scalar};
use hamel_codegen::expr::Function as Known;
use hamel_compiler::emit::Function;
use hamel_compiler::graph::{Argument, Slopes, Sym, call, call_two, record};

/// Value and slope of a function of one number, as the lines of a compiled scene compute them.
fn on_graph(of: impl Fn(Sym) -> Sym) -> Function {
    let (outputs, graph) = record(|| {
        let x = Sym::input(Argument::Configuration, 0);
        let value = of(x);
        let slopes = Slopes::new(vec![value]);
        let slope = slopes.along(|_, _| Sym::from(1.0));
        let both = std::iter::once(value).chain(slope);
        both.map(Sym::value).collect::<Vec<_>>()
    });
    Function {
        name: "both",
        summary: "Value and slope.".to_owned(),
        arguments: vec![(Argument::Configuration, 1)],
        columns: None,
        graph,
        outputs,
        plan: None,
        packs: None,
        pairs: None,
    }
}

/// Compares at arguments of all sizes; `dual` is the same in dual numbers.
fn agrees(name: &str, of: impl Fn(Sym) -> Sym, dual: impl Fn(Dual<f64>) -> Dual<f64>) {
    let function = on_graph(of);
    for x in [
        0.0, 1e-9, 0.3, -0.3, 7.2, -7.2, 100.0, -100.0, 720.0, -720.0, 1e4, -1e4,
    ] {
        let expected = dual(Dual::variable(x));
        let found = function.evaluate(|_| vec![x]);
        for (found, expected) in found
            .into_iter()
            .zip([expected.value, expected.derivative()])
        {
            let same = found.to_bits() == expected.to_bits();
            // A few roundings in another order.
            let near = (found - expected).abs() <= 8.0 * f64::EPSILON * expected.abs();
            assert!(same || near, "{name} at {x}: {found:e} for {expected:e}");
        }
    }
}

#[test]
fn slopes_of_hyperbolic_functions_are_those_of_dual_numbers() {
    agrees("sinh", |x| call(Known::Sinh, x), Dual::sinh);
    agrees("cosh", |x| call(Known::Cosh, x), Dual::cosh);
    agrees("sech", |x| call(Known::Sech, x), Dual::sech);
    agrees("tanh", |x| call(Known::Tanh, x), Dual::tanh);
    agrees("ln cosh", |x| call(Known::LnCosh, x), Dual::ln_cosh);
}

/// ln(1 + eˣ) and its slope by a scale, whose own rate counts as 0 on the graph, but not in dual numbers.
#[test]
fn slopes_do_not_depend_on_scales() {
    let on_graph = |x: Sym| {
        let scale = call_two(Known::Larger, x - Sym::from(64.0), Sym::from(0.0));
        call_two(Known::Ln1p, call(Known::Exp, x - scale), scale)
    };
    let in_duals = |x: Dual<f64>| {
        let scale = (x - Dual::constant(64.0)).larger(Dual::constant(0.0));
        (x - scale).exp().ln_1p_scaled(scale)
    };
    agrees("softplus", on_graph, in_duals);
}
