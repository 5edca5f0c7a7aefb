//! Kernels of the joints that loops make obey the laws of joints.

use super::import;
use hamel::joint::Coupled;
use hamel_scene::Coupling;
use hamel_tests::laws::{self, Reach};

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
    fn check<const K: usize>(coupling: &Coupling) {
        let (links, ties, start) = (&coupling.links, &coupling.ties, &coupling.start);
        let joint = Coupled::<K>::closed(links, ties, start, coupling.ports);
        let joint = joint.expect("a linkage");
        for body in 0..links.len() {
            laws::check_within(&joint.member(body).expect("a body"), Reach::Around(REACH));
        }
    }
    for (name, check) in [
        ("slider_crank", check::<1> as fn(&Coupling)),
        ("rssr", check::<1>),
        ("ankle", check::<2>),
        ("parallel_chains", check::<2>),
    ] {
        check(&linkage(name));
    }
}
