"""What several tests need."""

import os
import subprocess
from pathlib import Path

import hamel
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PANDA = ROOT / "tests/data/urdf/panda7.urdf"
SCENES = ROOT / "scenes"
PENDULUM = ROOT / "tests/data/scenes/double_pendulum.toml"


def pendulums(count):
    """Rows of `PENDULUM` that go side by side, except for one that fails and one that leaves the finite numbers. Masses are the same in two rows each."""
    random = np.random.default_rng(11)
    rows = {"body.lower.mass": np.repeat(random.uniform(0.8, 1.2, -(-count // 2)), 2)[:count]}
    rows["body.upper.initial.configuration.1"] = random.uniform(-0.5, 0.5, count)
    rows["body.lower.initial.speeds.1"] = random.uniform(-1.0, 1.0, count)
    rows["body.lower.mass"][count // 3] = -1.0
    rows["body.lower.initial.speeds.1"][count // 2] = 1e200
    return rows


def states(robot, count, seed=1):
    """q, v and tau of random states: positions from -1 to 1 off home, all else normal."""
    random = np.random.default_rng(seed)
    sizes = robot.sizes
    q = robot.configuration(random.uniform(-1.0, 1.0, (count, sizes.freedoms)))
    return q, random.normal(size=(count, sizes.speeds)), random.normal(size=(count, sizes.freedoms))


def in_rust(path, what, parts, frame=""):
    """The doubles that `python/examples/states.rs` makes of states, one after the other."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target/python"))
    program = target / "release/examples/states"
    text = np.concatenate(parts, axis=-1).astype("<f8").tobytes()
    done = subprocess.run([program, path, what, frame], input=text, capture_output=True, timeout=120)
    assert done.returncode == 0, done.stderr.decode()
    return np.frombuffer(done.stdout, "<f8")


@pytest.fixture(scope="session")
def panda():
    return hamel.load(PANDA)


@pytest.fixture(autouse=True)
def all_threads():
    """Each test leaves the number of threads as it was."""
    yield
    hamel.set_threads(None)
