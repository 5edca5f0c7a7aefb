//! Compiled second derivatives against the tree's.

use super::{flops, robots, scene_files};
use hamel_compiler::functions::{Kind, Loops, compile, compile_with};
use hamel_compiler::model::Model;
use hamel_compiler::prune::{Pruning, prune};
use hamel_tests::compiled::Point;
use hamel_tests::{compiled, random};

/// Operations from which on a scene is left to the random trees.
const LONG: usize = 10_000;

#[test]
fn second_derivatives_of_scenes_agree() {
    let mut met = 0;
    for (seed, (scene, model)) in (0..).zip(scene_files()) {
        let model = model.unwrap_or_else(|refused| panic!("{refused}"));
        let inverse = compile(&model, Kind::InverseSecondDerivatives, Loops::Never);
        if inverse.is_ok_and(|chosen| chosen.function.written() < LONG) {
            let point = Point::random(model, &scene.mechanism, seed);
            point
                .compiled_with(&[Loops::Long])
                .second_derivatives_agree();
            met += 1;
        }
    }
    assert!(met > 20, "only {met} scenes");
}

/// Operations without loops, however many.
fn straight(model: &Model, kind: Kind) -> usize {
    let links = prune(model, Pruning::ALL);
    let chosen = compile_with(model, &links, kind, Loops::Never);
    chosen.function.operations().flops()
}

/// Second derivatives of forward dynamics take at most three times the operations of the first ones.
#[test]
fn second_derivatives_of_robots_agree_and_stay_few() {
    for (name, mechanism) in robots() {
        let model = compiled::model(name, &mechanism);
        let point = Point::random(model.clone(), &mechanism, 1);
        if name == "ball32" {
            // As a module has them: in loops.
            point
                .compiled_with(&[Loops::Long])
                .second_derivatives_agree();
            continue;
        }
        point.second_derivatives_agree();
        let [first, second] = [Kind::ForwardDerivatives, Kind::ForwardSecondDerivatives]
            .map(|kind| straight(&model, kind));
        assert!(second <= 3 * first, "{name}: {first}, {second}");
    }
}

#[test]
fn second_derivatives_of_random_trees_agree() {
    for case in random::cases(&random::library(), 4, 40) {
        Point::bare(case).second_derivatives_agree();
    }
}

#[test]
fn second_derivatives_of_random_trees_with_elements_agree() {
    for case in random::cases(&random::library(), 3, 40) {
        Point::with_elements(case).second_derivatives_agree();
    }
}

/// Where constraints couple joints, second derivatives of forward dynamics are refused by the constraint's name; those of inverse dynamics are not.
#[test]
fn constraints_are_named() {
    let coupled = scene_files().into_iter().filter_map(|(_, model)| {
        let model = model.ok()?;
        let name = model.coupling.constraints.first()?.name.clone();
        Some((model, name))
    });
    let (model, name) = coupled.last().expect("a scene with constraints");
    let refused = compile(&model, Kind::ForwardSecondDerivatives, Loops::Long);
    let message = refused.expect_err("it is coupled").to_string();
    let expected = format!(
        "forward_dynamics_second_derivatives: second derivatives of the dynamics do not cover forward dynamics under a constraint that \
         couples joints: `{name}`"
    );
    assert_eq!(message, expected);
    assert!(flops(&model, Kind::InverseSecondDerivatives) > 0);
}
