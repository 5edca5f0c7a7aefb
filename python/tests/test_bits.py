"""Results are those of Rust, bit for bit, whatever the batch and the number of threads."""

import hamel
import numpy as np
import pytest
from conftest import PANDA, ROOT, SCENES, in_rust, states

FILES = {
    "panda": (PANDA, "panda_hand_tcp"),
    "tree": (SCENES / "mixed_tree.toml", "fork"),
    "nonholonomic": (SCENES / "plate_cart_arm.toml", "plate"),
    "closed": (ROOT / "tests/data/scenes/timed_ports.toml", None),
}
# More than one chunk of a thread has.
COUNT = 700


def ask(robot, what, q, v, last, frame):
    match what:
        case "bias_forces" | "energy":
            return getattr(robot, what)(q, v)
        case "mass_matrix" | "center_of_mass":
            return getattr(robot, what)(q)
        case "jacobian" | "pose":
            return getattr(robot, what)(q, frame)
        case "twist":
            return robot.twist(q, v, frame)
        case "forward_dynamics_derivatives" | "inverse_dynamics_derivatives":
            parts = getattr(robot, what)(q, v, last)
            return np.concatenate([part.reshape(len(q), -1) for part in parts], axis=1)
        case _:
            return getattr(robot, what)(q, v, last)


@pytest.mark.parametrize("file", FILES)
@pytest.mark.parametrize(
    "what",
    [
        "forward_dynamics",
        "inverse_dynamics",
        "bias_forces",
        "mass_matrix",
        "jacobian",
        "twist",
        "pose",
        "energy",
        "center_of_mass",
        "forward_dynamics_derivatives",
        "inverse_dynamics_derivatives",
    ],
)
def test_results_are_those_of_rust(file, what):
    path, frame = FILES[file]
    robot = hamel.load(path)
    frame = frame or robot.bodies[-1]
    q, v, tau = states(robot, COUNT)
    # Of accelerations there is one per speed.
    last = tau[:, : robot.sizes.speeds] if what.startswith("inverse") else tau
    expected = in_rust(path, what, (q, v, last), frame)
    for threads in (1, 2, 5):
        hamel.set_threads(threads)
        found = ask(robot, what, q, v, last, frame)
        assert found.ravel().tobytes() == expected.tobytes(), threads


def test_one_state_is_as_in_a_batch(panda):
    q, v, tau = states(panda, 40)
    batch = panda.forward_dynamics(q, v, tau)
    for i in range(40):
        assert panda.forward_dynamics(q[i], v[i], tau[i]).tobytes() == batch[i].tobytes()


def test_a_motion_is_that_of_rust(panda):
    q, v, tau = states(panda, 1)
    motion = hamel.simulate(panda, 0.5, start=(q[0], v[0]))
    expected = in_rust(PANDA, "motion", (q, v, tau))
    found = np.concatenate([motion.t[:, None], motion.q, motion.v], axis=1)
    assert found.ravel().tobytes() == expected.tobytes()
