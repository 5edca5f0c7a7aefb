"""Robots go from process to process and from thread to thread."""

import copy
import os
import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import hamel
import numpy as np
from conftest import PANDA, ROOT, SCENES, states


def test_pickles_are_robots_of_the_same_text():
    for robot in (
        hamel.load(PANDA),
        hamel.load(ROOT / "tests/data/urdf/anymal.urdf", floating_base=True),
        hamel.load((SCENES / "mixed_tree.toml").read_text()),
    ):
        q, v, tau = states(robot, 3)
        for other in (pickle.loads(pickle.dumps(robot)), copy.deepcopy(robot)):
            assert repr(other) == repr(robot) and other.source == robot.source
            assert np.array_equal(other.forward_dynamics(q, v, tau), robot.forward_dynamics(q, v, tau))


def test_motions_and_states_pickle(panda):
    motion = hamel.simulate(panda, 0.02)
    other = pickle.loads(pickle.dumps(motion))
    assert np.array_equal(other.q, motion.q) and repr(other) == repr(motion)
    assert np.array_equal(pickle.loads(pickle.dumps(panda.state())).configuration, panda.state().configuration)


def test_exceptions_pickle():
    for error in (hamel.FileError("a", source="b", mistakes=[(1, 2, "c")]), hamel.ArgumentError("a", index=(1,)), hamel.IntegrationError("a", time=1.0)):
        other = pickle.loads(pickle.dumps(error))
        assert str(other) == str(error) and vars(other) == vars(error)


def test_threads_share_a_robot(panda):
    q, v, tau = states(panda, 2000)
    expected = panda.forward_dynamics(q, v, tau)
    with ThreadPoolExecutor(8) as threads:
        found = threads.map(lambda _: panda.forward_dynamics(q, v, tau), range(32))
        assert all(np.array_equal(own, expected) for own in found)
        motions = list(threads.map(lambda _: hamel.simulate(panda, 0.1, estimate=False).q, range(8)))
    assert all(np.array_equal(own, motions[0]) for own in motions)


def test_a_fork_goes_on_where_batches_have_run():
    """No thread outlives a call, so that a fork lacks none."""
    program = f"""
import os, hamel, numpy as np
robot = hamel.load({str(PANDA)!r})
q = np.zeros((5000, 7))
hamel.set_threads(4)
robot.mass_matrix(q)
child = os.fork()
robot.mass_matrix(q)
if child == 0:
    os._exit(0)
assert os.waitpid(child, 0)[1] == 0
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)
