//! Derivatives of the dynamics and linearised steps on random trees of this crate's joints.

use hamel::erased::AnyJoint;
use hamel::joint::Member;
use hamel::registry::JointRegistry;
use hamel::scalar::Scalar;
use hamel_downstream::joints::{
    BallCayley, BallTurns, Bead, CamCircle, CarWheels, Catenary, CatenaryLength, CrankCoupler,
    CrankRocker, DirectionSensor, FourBarThrough, GearedRotor, MeasuredRocker, PlanarTurns,
    PowerGuide, Press, RollingBallCayley, Scara, SkateHeading, SkewScrew, SliderCrankLinks,
    SliderCrankRod, SpherePoint, Unpinned, Valley,
};
use hamel_downstream::{WITH_KNOTS, of_trees};
use hamel_tests::derivatives::{self, Equipped, Kernels, bare_and_equipped, behind, of, second};
use hamel_tests::differences::FINE;
use hamel_tests::linear_step;
use hamel_tests::random::{self, cases};
use std::sync::Arc;

/// Every joint at the root of three trees.
const TREES: u64 = 60;

fn kinds() -> Vec<Arc<dyn AnyJoint>> {
    let mut registry = JointRegistry::new();
    registry.extend(of_trees()).expect("distinct names");
    random::kinds(&registry)
}

/// Those that are smooth to all orders, as differences of high order need it.
fn without_knots() -> Vec<Arc<dyn AnyJoint>> {
    let mut kinds = kinds();
    kinds.retain(|kind| !WITH_KNOTS.contains(&kind.name()));
    kinds
}

/// The kernels of the joints of [`kinds`].
fn kernels<D: Scalar>(joint: &dyn AnyJoint) -> Box<dyn Kernels<D>> {
    let car = CarWheels::new(0.7, 0.85, 1.0);
    let linkage = CrankRocker::new(0.9, 0.2, 0.9 + 0.1 * 2.0, 0.9 + 0.1 * 3.0);
    let slider = SliderCrankLinks::new(0.9, 0.9 / 3.0, 0.9 / 9.0);
    let press = Press::new(0.7, 0.85);
    let all = [
        of(BallCayley),
        of(BallTurns),
        of(Bead::new(0.7)),
        of(CamCircle::new(0.7)),
        of(MeasuredRocker),
        of(Valley),
        of(Catenary::new(0.7)),
        of(CatenaryLength::new(0.7)),
        of(DirectionSensor::new(0.7)),
        of(CrankCoupler::new(
            0.9,
            0.2,
            0.9 + 0.1 * 2.0,
            0.9 + 0.1 * 3.0,
        )),
        of(FourBarThrough),
        of(PlanarTurns),
        of(PowerGuide::new(0.7)),
        of(press),
        of(Member::<_, 1>(press)),
        of(Member::<_, 2>(press)),
        of(RollingBallCayley::new(0.7)),
        of(Scara),
        of(SkateHeading),
        of(SkewScrew),
        of(SliderCrankRod),
        of(SpherePoint::new(0.7)),
        of(Unpinned::new(0.7)),
        of(Member::<_, 1>(Unpinned::new(0.7))),
        of(car),
        of(Member::<_, 1>(car)),
        of(Member::<_, 2>(car)),
        of(Member::<_, 3>(car)),
        of(Member::<_, 4>(car)),
        of(linkage),
        of(Member::<_, 1>(linkage)),
        of(Member::<_, 2>(linkage)),
        of(GearedRotor::new(0.7)),
        of(Member::<_, 1>(GearedRotor::new(0.7))),
        of(slider),
        of(Member::<_, 1>(slider)),
        of(Member::<_, 2>(slider)),
    ];
    behind(joint, all)
}

/// Bare, and with elements of all kinds and rotors at every joint.
fn all() -> Vec<Equipped> {
    let kinds = kinds();
    let trees = || cases(&kinds, 8, TREES);
    let all = bare_and_equipped(trees(), trees()).into_iter();
    all.map(|equipped| equipped.on(kernels)).collect()
}

/// Bare, and with elements of all kinds and rotors at every joint: smaller trees, since all pairs of coordinates are moved along.
fn small() -> Vec<Equipped> {
    let kinds = kinds();
    let trees = || cases(&kinds, 4, TREES);
    let all = bare_and_equipped(trees(), trees()).into_iter();
    all.map(|equipped| equipped.on(kernels)).collect()
}

#[test]
fn second_derivatives_of_inverse_dynamics() {
    second::inverse_dynamics(small(), kernels);
}

#[test]
fn second_derivatives_of_forward_dynamics() {
    second::forward_dynamics(small(), kernels);
}

#[test]
fn inverse_dynamics() {
    derivatives::inverse_dynamics(all());
}

#[test]
fn forward_dynamics() {
    derivatives::forward_dynamics(all());
}

#[test]
fn port_hamiltonian_form() {
    derivatives::port_hamiltonian_form(all());
}

#[test]
fn energies() {
    derivatives::energies(all());
}

#[test]
fn linear_steps_of_bare_trees() {
    linear_step::bare(cases(&without_knots(), 5, TREES), FINE);
}

#[test]
fn linear_steps_of_equipped_trees() {
    linear_step::equipped(cases(&without_knots(), 4, TREES), FINE);
}

#[test]
fn linear_steps_of_coupled_trees() {
    // One of the cases bends more when constrained: 7e-8 is left of h⁶ f⁽⁷⁾ with the finer step, and 4⁶ times less with a quarter of it.
    linear_step::constrained(cases(&without_knots(), 5, TREES), 20, FINE / 4.0);
}
