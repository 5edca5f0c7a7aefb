"""`Robot.compile`: the same methods with compiled equations of motion."""

import os
import pickle
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import hamel
import numpy as np
import pytest
from conftest import PANDA, ROOT, SCENES, states

pytestmark = pytest.mark.skipif(not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler")

ALL = (
    "forward_dynamics",
    "inverse_dynamics",
    "bias_forces",
    "mass_matrix",
    "energy",
    "poses",
    "forward_dynamics_derivatives",
    "inverse_dynamics_derivatives",
)

FILES = {
    "panda": (PANDA, {}),
    "mixed tree": (SCENES / "mixed_tree.toml", {}),
    "floating base": (ROOT / "tests/data/urdf/anymal.urdf", {"floating_base": True}),
    "nonholonomic": (SCENES / "plate_cart_arm.toml", {}),
    "loop": (ROOT / "tests/data/scenes/loops.toml", {}),
    "rotors": (SCENES / "elastic_joint.toml", {}),
    "constraints": (SCENES / "tractor_trailers.toml", {}),
    "efforts in time": (ROOT / "tests/data/scenes/timed_ports.toml", {}),
}

# Relative to the largest entry, or to 1 where that is more: the bound of the scene compiler's own tests is 1e-12, or 10 roundings for each unit of the condition of the mass matrix;
# that of these robots at these states is below 1e6.
BOUND = 1e-9


@pytest.fixture(scope="module", params=FILES)
def pair(request):
    path, options = FILES[request.param]
    robot = hamel.load(path, **options)
    # Derivatives of a walking robot take a C compiler half a minute.
    return robot, robot.compile() if options else robot.compile(ALL)


def near(robot, count):
    """States near that of the file, where loops close; where constraints couple joints, states of a motion, whose speeds meet them."""
    q, v, tau = states(robot, count)
    if "[[constraint]]" in robot.source:
        motion = hamel.simulate(robot, samples=np.linspace(0.0, 1.0, count), estimate=False)
        return motion.q, motion.v, tau
    start = robot.state()
    random = np.random.default_rng(2)
    home = robot.positions(start.configuration)
    return robot.configuration(home + random.uniform(-0.1, 0.1, (count, robot.sizes.freedoms))), v, tau


def agree(found, expected):
    """Whether these are the same numbers to rounding, in the same shape."""
    assert found.shape == expected.shape
    scale = max(np.abs(expected).max(initial=0.0), 1.0)
    assert np.abs(found - expected).max(initial=0.0) <= BOUND * scale


def test_all_that_is_compiled_is_what_the_tree_has(pair):
    tree, compiled = pair
    assert tree.compiled == () and set(compiled.compiled) in ({*ALL}, {*ALL[:6]})
    q, v, tau = near(tree, 20)
    a = tau[:, : tree.sizes.speeds]
    for name in ("forward_dynamics", "inverse_dynamics"):
        agree(getattr(compiled, name)(q, v, a if name[0] == "i" else tau), getattr(tree, name)(q, v, a if name[0] == "i" else tau))
    for name in ("bias_forces", "energy", "kinetic_energy"):
        agree(getattr(compiled, name)(q, v), getattr(tree, name)(q, v))
    for name in ("mass_matrix", "poses", "potential_energy"):
        agree(getattr(compiled, name)(q), getattr(tree, name)(q))
    for name, last in (("forward_dynamics_derivatives", tau), ("inverse_dynamics_derivatives", a)):
        for found, expected in zip(getattr(compiled, name)(q, v, last), getattr(tree, name)(q, v, last)):
            agree(found, expected)


def test_what_is_not_compiled_is_that_of_the_tree(panda):
    compiled = panda.compile(["mass_matrix"])
    q, v, tau = states(panda, 5)
    assert compiled.compiled == ("mass_matrix",)
    assert np.array_equal(compiled.forward_dynamics(q, v, tau), panda.forward_dynamics(q, v, tau))
    assert np.array_equal(compiled.jacobian(q, "panda_hand_tcp"), panda.jacobian(q, "panda_hand_tcp"))
    assert np.array_equal(compiled.center_of_mass(q), panda.center_of_mass(q))
    assert "compiled" in repr(compiled) and "compiled" not in repr(panda)


def test_compiled_functions_are_called(panda):
    """Rounding differs from that of the tree, which would not if the tree answered."""
    q, v, tau = states(panda, 100)
    compiled = panda.compile()
    assert not np.array_equal(compiled.forward_dynamics(q, v, tau), panda.forward_dynamics(q, v, tau))
    assert "forward_dynamics_derivatives" not in compiled.compiled and "poses" in compiled.compiled


def test_batches_broadcast_and_bits_depend_on_no_threads(panda):
    compiled = panda.compile(["forward_dynamics"])
    q, v, tau = states(panda, 3000)
    expected = compiled.forward_dynamics(q, v, tau)
    for threads in (1, 2, 5):
        hamel.set_threads(threads)
        assert np.array_equal(compiled.forward_dynamics(q, v, tau), expected)
    for i in range(0, 3000, 500):
        assert np.array_equal(compiled.forward_dynamics(q[i], v[i], tau[i]), expected[i])
    square = compiled.forward_dynamics(q[:6].reshape(2, 3, 7), v[0], tau[:3])
    assert square.shape == (2, 3, 7)
    assert np.array_equal(square[1, 2], compiled.forward_dynamics(q[5], v[0], tau[2]))
    assert compiled.forward_dynamics(q[:0], v[:0], tau[:0]).shape == (0, 7)


def test_several_are_there_at_once_and_threads_share_them(panda):
    robots = [panda, hamel.load(SCENES / "mixed_tree.toml")]
    with ThreadPoolExecutor(4) as threads:
        compiled = list(threads.map(lambda robot: robot.compile(["forward_dynamics"]), robots * 2))
        for own, robot in zip(compiled, robots * 2):
            state = states(robot, 500)
            expected = own.forward_dynamics(*state)
            agree(expected, robot.forward_dynamics(*state))
            found = threads.map(lambda _: own.forward_dynamics(*state), range(8))
            assert all(np.array_equal(one, expected) for one in found)
    first, state = compiled[0], states(panda, 5)
    expected = first.forward_dynamics(*state)
    del compiled, own
    assert np.array_equal(first.forward_dynamics(*state), expected)


def test_it_pickles(panda):
    state = states(panda, 5)
    for functions in (None, ["forward_dynamics"]):
        compiled = panda.compile(functions)
        other = pickle.loads(pickle.dumps(compiled))
        assert other.compiled == compiled.compiled and repr(other) == repr(compiled)
        assert np.array_equal(other.forward_dynamics(*state), compiled.forward_dynamics(*state))


def test_a_joint_of_ones_own_is_compiled():
    spec = (ROOT / "joint-specs/revolute.joint").read_text().replace("joint revolute", "joint hinge")
    text = (ROOT / "tests/data/scenes/pendulum.toml").read_text().replace('"revolute"', '"hinge"')
    assert '"hinge"' in text
    robot = hamel.load(text, joints=[hamel.Joint(spec)])
    compiled = robot.compile(ALL)
    state = states(robot, 10)
    agree(compiled.forward_dynamics(*state), robot.forward_dynamics(*state))
    other = pickle.loads(pickle.dumps(compiled))
    assert np.array_equal(other.mass_matrix(state[0]), compiled.mass_matrix(state[0]))


def test_a_motion_of_compiled_equations_is_that_of_the_tree(panda):
    compiled = panda.compile(["forward_dynamics", "forward_dynamics_derivatives"])
    q, v, _ = states(panda, 1)
    for method in ("dop853", "radau5"):
        tree, own = (hamel.simulate(robot, 0.3, start=(q[0], v[0]), method=method, tolerance=1e-10) for robot in (panda, compiled))
        # Both are as near to the exact motion as their estimates say, which tests of motions hold to a factor of ten.
        assert np.abs(tree.q[-1] - own.q[-1]).max() <= 10 * (tree.end_error + own.end_error)
    assert np.array_equal(hamel.simulate(compiled, 0.1, arithmetic="refined").q, hamel.simulate(panda, 0.1, arithmetic="refined").q)


def test_states_are_refused_as_by_the_tree(panda):
    compiled = panda.compile()
    q, v, tau = states(panda, 3)
    with pytest.raises(hamel.ArgumentError, match=r"q has shape \(3, 6\)"):
        compiled.forward_dynamics(q[:, :6], v, tau)
    v[1, 2] = np.nan
    with pytest.raises(hamel.ArgumentError) as error:
        compiled.forward_dynamics(q, v, tau)
    assert error.value.index == (1,)
    text = (SCENES / "mixed_tree.toml").read_text()
    tree = hamel.load(text)
    own = tree.compile(["forward_dynamics"])
    q, v, tau = states(tree, 1)
    for robot in (tree, own):
        with pytest.raises(hamel.ArgumentError, match="off"):
            robot.forward_dynamics(q * 1.1, v, tau)


def test_functions_are_named():
    robot = hamel.load(PANDA)
    with pytest.raises(hamel.ArgumentError, match='functions has "pose": it may have forward_dynamics, '):
        robot.compile(["pose"])
    with pytest.raises(hamel.ArgumentError, match="functions is empty"):
        robot.compile([])


def test_what_is_not_written_is_told():
    text = (ROOT / "tests/data/scenes/pendulum.toml").read_text()
    wrench = '[[wrench]]\nbody = "bob"\npoint = [0.0, 0.0, 0.0]\nforce = ["sin(t)", 0.0, 0.0]\naxes = "world"\n'
    refused = hamel.load(text.replace("[simulation]", wrench + "[simulation]"))
    with pytest.raises(hamel.CompilationError, match="wrench 1: it changes with time, which is not compiled"):
        refused.compile()


def in_environment(program, **environment):
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, env={**os.environ, **environment})


def test_a_machine_without_a_compiler_is_told(tmp_path):
    program = f"""
import hamel
robot = hamel.load({str(PANDA)!r})
try:
    robot.compile()
except hamel.CompilationError as error:
    print(error)
"""
    done = in_environment(program, PATH=str(tmp_path), CC="")
    assert "none of `cc`, `gcc`, `clang` can be run: install one" in done.stdout, done.stderr
    done = in_environment(program, CC="no_such_compiler")
    assert "`no_such_compiler`, which the variable CC names, cannot be run" in done.stdout, done.stderr


def test_ctrl_c_ends_the_compiler_and_nothing_is_left(tmp_path):
    slow = tmp_path / "slow"
    slow.write_text("#!/bin/sh\ncase \"$1\" in --version) exit 0 ;; esac\nexec sleep 60\n")
    slow.chmod(0o755)
    folder = tmp_path / "temporary"
    folder.mkdir()
    program = f"""
import hamel, os, signal, threading, time
robot = hamel.load({str(PANDA)!r})
signal.signal(signal.SIGINT, signal.default_int_handler)
threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
began = time.monotonic()
try:
    robot.compile(["forward_dynamics"])
except KeyboardInterrupt:
    print("ended", time.monotonic() - began < 20)
"""
    done = in_environment(program, CC=str(slow), TMPDIR=str(folder))
    assert done.stdout == "ended True\n", done.stderr
    assert list(folder.iterdir()) == []
