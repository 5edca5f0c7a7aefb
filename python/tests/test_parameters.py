"""Inertial parameters: efforts as linear functions of them."""

import hamel
import numpy as np
import pytest
from conftest import PANDA, ROOT, SCENES, states

# Roundings of sums over some ten bodies with ten parameters each, of the largest effort.
ROUNDING = 1e-12


@pytest.mark.parametrize("path", [PANDA, ROOT / "tests/data/urdf/anymal.urdf", SCENES / "mixed_tree.toml"], ids=["panda", "anymal", "mixed_tree"])
def test_efforts_are_linear_in_inertial_parameters(path):
    robot = hamel.load(path)
    q, v, _ = states(robot, 12)
    a = np.random.default_rng(2).normal(size=v.shape)
    matrix, rest = found = robot.joint_torque_regressor(q, v, a)
    parameters = robot.inertial_parameters
    assert (matrix.shape, rest.shape) == ((12, robot.sizes.speeds, 10 * len(robot.bodies)), (12, robot.sizes.speeds))
    expected = robot.inverse_dynamics(q, v, a)
    assert np.abs(matrix @ parameters + rest - expected).max() <= ROUNDING * np.abs(expected).max()
    one = robot.joint_torque_regressor(q[3], v[3], a[3])
    assert np.array_equal(one.matrix, found.matrix[3]) and np.array_equal(one.rest, found.rest[3])

    base = robot.base_parameters()
    assert base.is_minimal
    assert base.matrix.shape == (len(base.names), len(parameters)) and len(base.kept) == len(base.names)
    by_base = matrix[..., base.kept] @ (base.matrix @ parameters)
    assert np.abs(by_base - matrix @ parameters).max() <= ROUNDING * np.abs(expected).max()


def test_base_parameters_are_as_few_as_a_pendulum_feels():
    text = """<robot name="pendulum"><link name="base"/><link name="arm"><inertial><origin xyz="0.1 0 -0.3"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.2" izz="0.15" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint></robot>"""
    robot = hamel.load(text)
    base = robot.base_parameters()
    assert len(base.names) == 3 and base.kept.tolist() == [1, 3, 6]
    assert np.allclose(base.matrix @ robot.inertial_parameters, [2 * 0.1, 2 * -0.3, 0.2 + 2 * (0.1**2 + 0.3**2)])


def test_wrong_arguments_are_refused(panda):
    q = panda.state().configuration
    with pytest.raises(hamel.ArgumentError, match="a has shape"):
        panda.joint_torque_regressor(q, np.zeros(7), np.zeros(6))
    with pytest.raises(hamel.ArgumentError, match="not finite|finite"):
        panda.joint_torque_regressor(q, np.full(7, np.nan), np.zeros(7))
