//! Kernels of the joints that loops make: the laws of joints, and types that are larger than a joint.

use super::import;
use hamel::erased::{AnyJoint, Shared, erase};
use hamel::joint::{self, Coupled};
use hamel_scene::Coupling;
use hamel_tests::laws::{self, Reach};
use std::sync::Arc;

/// The joint that the loop of a robot makes.
fn linkage(name: &str) -> Coupling {
    let scene = import(name, [0.0, 0.0, -9.81]).scene;
    let coupled = scene.coupled().expect("it closes");
    let mut bodies = coupled.bodies.iter();
    let found = bodies.find_map(|body| body.joint.coupling.clone());
    found.expect("a loop")
}

/// How far the independent coordinates go, which end all around: less than at any of these linkages.
const REACH: f64 = 0.2;

/// The laws that the joints of the library are held to, by dual numbers, at random configurations.
#[test]
fn kernels_of_loops_obey_the_laws_of_joints() {
    fn check<const N: usize, const K: usize, const C: usize>(coupling: &Coupling) {
        let (links, ties, start) = (&coupling.links, &coupling.ties, &coupling.start);
        let joint = Coupled::<N, K, C>::closed(links, ties, start, coupling.ports);
        let joint = joint.expect("a linkage");
        for body in 0..links.len() {
            laws::check_within(&joint.member(body).expect("a body"), Reach::Around(REACH));
        }
    }
    for (name, check) in [
        ("slider_crank", check::<3, 1, 2> as fn(&Coupling)),
        ("rssr", check::<4, 1, 3>),
        ("ankle", check::<8, 2, 6>),
        ("parallel_chains", check::<5, 2, 3>),
    ] {
        check(&linkage(name));
    }
}

/// Kernels of a joint, one after the other, a step away from its start.
fn kernels(joint: &dyn AnyJoint) -> Vec<f64> {
    let layout = joint.layout();
    let (size, freedoms) = (layout.configuration, layout.freedoms);
    let numbers: Vec<f64> = (0..freedoms).map(|k| 0.03 + 0.01 * k as f64).collect();
    let mut home = vec![0.0; size];
    joint.home(&mut home);
    let mut q = vec![0.0; size];
    joint.retract(&home, &numbers, &mut q);
    let mut phi = vec![0.0; freedoms];
    joint.local(&home, &q, &mut phi).expect("near home");
    let mut projected = q.clone();
    projected[size - 1] += 1e-3;
    joint.project(&mut projected).expect("near the relations");
    let mut rate = vec![0.0; size];
    joint.configuration_rate(&q, &numbers, &mut rate);
    let mut columns = vec![0.0; 6 * freedoms * (1 + freedoms)];
    let (map, gradient) = columns.split_at_mut(6 * freedoms);
    joint.twist_map_child(&q, map);
    joint.twist_map_child_gradient(&q, gradient);
    let bias = joint.bias_acceleration(&q, &numbers);
    let relations = (0..joint.relations().len()).map(|relation| joint.relation_twist(&q, relation));
    let relations: Vec<f64> = relations
        .flat_map(|twist| twist.as_slice().to_vec())
        .collect();
    let ends = [joint.residual(&q), joint.singularity(&q)];
    let mut wrong = vec![0.0; size + 1];
    joint.retract(&q, &numbers, &mut wrong);
    assert!(wrong.iter().all(|entry| entry.is_nan()), "a wrong size");
    [home, q, phi, projected, rate, columns]
        .concat()
        .into_iter()
        .chain(bias.iter().copied())
        .chain(relations)
        .chain(ends)
        .collect()
}

/// Sizes that have no type of their own take a larger one, whose last coordinates are idle.
#[test]
fn linkages_of_a_larger_type_are_the_same() {
    fn check<const N: usize, const K: usize, const C: usize>(coupling: &Coupling) {
        let (links, ties, start) = (&coupling.links, &coupling.ties, &coupling.start);
        let own = joint::closed(links, ties, start, coupling.ports).expect("a linkage");
        let larger = Coupled::<N, K, C>::closed(links, ties, start, coupling.ports);
        let larger = erase(larger.expect("a linkage"));
        assert_eq!(larger.layout(), own.layout());
        assert_eq!(larger.coordinates(), own.coordinates());
        assert_eq!(larger.relations(), own.relations());
        let all = |joint: &Shared| {
            std::iter::once(Arc::clone(joint))
                .chain(joint.more())
                .collect::<Vec<Shared>>()
        };
        for (own, larger) in all(&own).iter().zip(all(&larger)) {
            let (own, larger) = (kernels(&**own), kernels(&*larger));
            assert_eq!(own.len(), larger.len());
            for (a, b) in own.iter().zip(&larger) {
                // Reflections of matrices of other sizes round otherwise, a few times, at conditions below 100.
                assert!((a - b).abs() <= 1e-12 * a.abs().max(1.0), "{a:e}, {b:e}");
            }
        }
    }
    for (name, check) in [
        ("slider_crank", check::<13, 1, 12> as fn(&Coupling)),
        ("rssr", check::<13, 1, 12>),
        ("ankle", check::<14, 2, 12>),
        ("parallel_chains", check::<14, 2, 12>),
    ] {
        check(&linkage(name));
    }
}
