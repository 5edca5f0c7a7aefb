"""Results are those of Pinocchio and of 200-bit arithmetic, in `tests/data/robots`."""

import json
import re

import hamel
import numpy as np
import pytest
from conftest import PANDA, ROOT

REFERENCE = json.loads((ROOT / "tests/data/robots/panda7.json").read_text())
# As in `tests/tests/dynamics/robot_references.rs`: what double precision leaves of numbers of that size after sums over seven bodies.
BOUND = 1e-13


def column(name):
    return np.array([state[name] for state in REFERENCE["states"]])


def relative(found, expected):
    return np.abs(found - expected).max() / np.abs(expected).max()


@pytest.fixture(scope="module")
def panda():
    """Without the damping of its joints, which Pinocchio leaves out."""
    return hamel.load(re.sub('damping="[^"]*"', 'damping="0"', PANDA.read_text()))


@pytest.fixture
def q():
    return column("q")


@pytest.fixture
def v():
    return column("v")


def test_mass_matrix(panda, q):
    assert relative(panda.mass_matrix(q), column("M")) < BOUND


def test_bias_and_gravity(panda, q, v):
    assert relative(panda.bias_forces(q, v), column("nle")) < BOUND
    assert relative(panda.bias_forces(q, 0 * v), column("gravity")) < BOUND


def test_inverse_dynamics(panda, q, v):
    assert relative(panda.inverse_dynamics(q, v, column("rnea_a")), column("rnea_tau_exact")) < BOUND


def test_forward_dynamics(panda, q, v):
    found = panda.forward_dynamics(q, v, column("tau"))
    expected = column("aba_qdd_exact")
    for own, known, mass in zip(found, expected, panda.mass_matrix(q)):
        # Rounding of the efforts, enlarged by the condition of M.
        assert relative(own, known) < 10 * np.finfo(float).eps * np.linalg.cond(mass)


def test_energies_and_center_of_mass(panda, q, v):
    assert relative(panda.kinetic_energy(q, v), column("kinetic_energy")) < BOUND
    # Zero of the potential energy: links that are fixed to the world count in one of them.
    found, expected = panda.potential_energy(q), column("potential_energy")
    assert np.abs((found - expected) - (found - expected)[0]).max() < BOUND * np.abs(expected).max()
    assert np.array_equal(panda.energy(q, v), panda.kinetic_energy(q, v) + panda.potential_energy(q))


def test_derivatives_are_those_of_differences(panda, q, v):
    """Central differences of step h: their error is h² of third derivatives and eps / h of values."""
    tau, step = column("tau"), 1e-6
    found = panda.forward_dynamics_derivatives(q, v, tau)
    assert np.array_equal(found.rates, panda.forward_dynamics(q, v, tau))
    for k, unit in enumerate(step * np.eye(7)):
        parts = {
            "by_local": panda.forward_dynamics(q + unit, v, tau) - panda.forward_dynamics(q - unit, v, tau),
            "by_speeds": panda.forward_dynamics(q, v + unit, tau) - panda.forward_dynamics(q, v - unit, tau),
            "by_efforts": panda.forward_dynamics(q, v, tau + unit) - panda.forward_dynamics(q, v, tau - unit),
        }
        for name, difference in parts.items():
            own = getattr(found, name)
            assert np.abs(own[..., k] - difference / (2 * step)).max() < 1e-7 * np.abs(own).max(), name


def test_derivatives_of_inverse_and_forward_dynamics_fit(panda, q, v):
    """∂a/∂x = −M⁻¹ ∂tau/∂x where a is that of tau."""
    forward = panda.forward_dynamics_derivatives(q, v, column("tau"))
    inverse = panda.inverse_dynamics_derivatives(q, v, forward.rates)
    mass = panda.mass_matrix(q)
    for own, other in ((forward.by_local, inverse.by_local), (forward.by_speeds, inverse.by_speeds)):
        residual = mass @ own + other
        assert np.abs(residual).max() < 1e-11 * np.abs(other).max()


def test_second_derivatives_are_differences_of_first_ones(panda, q, v):
    """Central differences of step h: their error is h² of fourth derivatives and eps / h of values."""
    tau, step = column("tau"), 1e-5
    weights = np.linspace(-1.0, 1.0, 7)

    def slopes(q, v, tau):
        found = panda.forward_dynamics_derivatives(q, v, tau)
        return weights @ np.concatenate([found.by_local, found.by_speeds, found.by_efforts], axis=-1)

    found = panda.forward_dynamics_second_derivatives(q, v, tau, weights)
    assert found.shape == (*q.shape[:-1], 21, 21)
    assert np.abs(found - np.swapaxes(found, -1, -2)).max() < 1e-12 * np.abs(found).max()
    for k, unit in enumerate(step * np.eye(21)):
        by_q, by_v, by_tau = unit[:7], unit[7:14], unit[14:]
        difference = slopes(q + by_q, v + by_v, tau + by_tau) - slopes(q - by_q, v - by_v, tau - by_tau)
        assert np.abs(found[..., k, :] - difference / (2 * step)).max() < 1e-6 * np.abs(found).max(), k


def test_second_derivatives_of_inverse_and_forward_dynamics_fit(panda, q, v):
    """By q and a it is the derivative of the mass matrix: central differences of step h, whose error is h² of third derivatives and eps / h of values."""
    weights = np.linspace(-1.0, 1.0, 7)
    zero, a = np.zeros(7), np.linspace(0.5, 2.0, 7)
    found, rest = (panda.inverse_dynamics_second_derivatives(q, v, own, weights) for own in (a, zero))
    step = 1e-5
    size = np.abs(panda.mass_matrix(q)).max()
    for k, unit in enumerate(step * np.eye(7)):
        mass = (panda.mass_matrix(q + unit) - panda.mass_matrix(q - unit)) / (2 * step)
        assert np.abs(found[..., k, 14:] - weights @ mass).max() < 1e-8 * size
    # Efforts are linear in a.
    assert np.allclose(found[..., 7:14, 7:14], rest[..., 7:14, 7:14], rtol=0, atol=1e-12)
    assert not found[..., 7:, 14:].any()


def test_a_jacobian_takes_speeds_to_twists(panda, q, v):
    for axes in ("world_aligned", "body", "world"):
        twist = panda.twist(q, v, "panda_hand_tcp", axes)
        product = panda.jacobian(q, "panda_hand_tcp", axes) @ v[..., None]
        assert np.abs(product[..., 0] - twist).max() < BOUND * np.abs(twist).max()


def test_poses_move_with_twists(panda, q, v):
    step = 1e-6
    after, before = (panda.pose(q + dt * v, "panda_hand_tcp") for dt in (step, -step))
    velocity = (after - before)[..., :3, 3] / (2 * step)
    # Rounding of positions, over the step.
    assert np.abs(velocity - panda.twist(q, v, "panda_hand_tcp")[..., 3:]).max() < 1e-8
    rotation = panda.pose(q, "panda_hand_tcp")[..., :3, :3]
    assert np.abs(rotation @ np.swapaxes(rotation, -1, -2) - np.eye(3)).max() < BOUND


def test_poses_of_all_bodies(panda, q):
    poses = panda.poses(q)
    for i, body in enumerate(panda.bodies):
        assert np.array_equal(poses[:, i], panda.pose(q, body))
