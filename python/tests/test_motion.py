"""Motions, their accuracy, and what ends them."""

import os
import signal
import subprocess
import sys
import threading
import time

import hamel
import numpy as np
import pytest
from conftest import SCENES

PENDULUM = """hamel = 1
name = "pendulum"
gravity = [0.0, -9.81, 0.0]

[[body]]
name = "rod"
parent = "world"
mass = 1.0
com = [0.5, 0.0, 0.0]
inertia = [[0.0, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
joint = { type = "revolute", name = "hinge" }
"""


def test_arrays_have_a_row_for_each_sample():
    motion = hamel.simulate(hamel.load(PENDULUM), 2.0, sample_step=0.5)
    assert motion.t.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert motion.q.shape == motion.v.shape == (5, 1)
    assert motion.energy.shape == motion.error.shape == (5,)
    # It starts level and at rest. The default tolerance is 1e-10 a step.
    assert np.abs(motion.energy).max() < 1e-8
    assert motion.kinetic_energy.max() > 1.0
    assert 0.0 < motion.end_error < 1e-6 and motion.doubt is None
    assert motion.end.time == 2.0 and motion.end.configuration.tolist() == motion.q[-1].tolist()
    assert motion.statistics["steps"] > 0


def test_the_error_estimate_is_about_the_error():
    robot = hamel.load(PENDULUM)
    coarse = hamel.simulate(robot, 2.0, method="dopri5", tolerance=1e-5, samples=[2.0])
    fine = hamel.simulate(robot, 2.0, method="verner9", tolerance=1e-14, samples=[2.0])
    error = np.abs(coarse.q - fine.q).max()
    # Estimates are right within a factor of ten.
    assert error / 10 < coarse.end_error < 100 * error


def test_open_arithmetic_is_refined_where_rounding_decides():
    robot = hamel.load(SCENES / "report/ratio_heavy_tip.toml")
    ends = {
        name: hamel.simulate(robot, 0.2, tolerance=1e-10, arithmetic=name, samples=[0.2], estimate=False).q
        for name in ("doubles", "refined", "auto")
    }
    assert np.array_equal(ends["auto"], ends["refined"])
    assert not np.array_equal(ends["doubles"], ends["refined"])


def test_methods_tolerances_and_steps():
    robot = hamel.load(PENDULUM)
    assert hamel.simulate(robot, 0.1, method="gauss2", dt=0.01).statistics["steps"] == 10
    assert hamel.simulate(robot, 0.1, dt=0.01, estimate=False).method == "rk4"
    assert hamel.simulate(robot, 0.1, method="radau5", tolerance=1e-6).method == "radau5"
    assert hamel.simulate(robot, 0.1, method="auto", form="hamiltonian").error is not None
    exact = hamel.simulate(robot, 1.0, accuracy=1e-8)
    assert exact.end_error <= 1e-8
    # The method is that of the tolerance that was found.
    assert hamel.simulate(robot, 1.0, accuracy=1e-3).method == "dopri5"
    assert hamel.simulate(robot, samples=[0.5, 2.0], estimate=False).t[-1] == 2.0
    none = hamel.simulate(robot, 0.1, estimate=False)
    assert none.error is None and none.end_error is None


def test_a_start_is_taken_from_a_state_or_a_pair():
    robot = hamel.load(PENDULUM)
    whole = hamel.simulate(robot, 2.0, samples=[0.0, 1.0, 2.0], tolerance=1e-12)
    later = hamel.simulate(robot, 2.0, start=hamel.State(whole.q[1], whole.v[1], 1.0), samples=[2.0], tolerance=1e-12)
    # Errors of both, by the estimate.
    assert np.abs(later.q[0] - whole.q[2]).max() < 1e-9
    pair = hamel.simulate(robot, 0.0, start=([0.5], [1.0]))
    assert (pair.q[0, 0], pair.v[0, 0]) == (0.5, 1.0)


def test_controllers_and_events_of_scenes_act():
    motion = hamel.simulate(hamel.load(SCENES / "bouncing_ball.toml"), estimate=False)
    assert motion.events and all(0.0 <= at <= motion.t[-1] for at, _ in motion.events)
    tracked = hamel.simulate(hamel.load(SCENES / "panda7_tracking.toml"), 0.05, estimate=False)
    free = hamel.simulate(hamel.load(SCENES / "panda7_tracking.toml"), 0.0)
    assert tracked.t[-1] == 0.05 and free.t.tolist() == [0.0]


def test_inputs_are_functions_of_python():
    """A torque that takes gravity away and brakes: v falls as exp(-c t / I)."""
    robot = hamel.load(PENDULUM)
    inertia = robot.mass_matrix([0.0])[0, 0]

    def brake(time, q, v):
        return robot.bias_forces(q, np.zeros(1)) - 0.7 * v

    motion = hamel.simulate(robot, 1.0, start=([0.3], [2.0]), inputs=brake, tolerance=1e-10, samples=[0.5, 1.0])
    assert np.abs(motion.v[:, 0] - 2.0 * np.exp(-0.7 * motion.t / inertia)).max() < 1e-8
    assert motion.end_error < 1e-8


def test_what_inputs_raise_ends_the_motion():
    robot = hamel.load(PENDULUM)

    def fail(time, q, v):
        if time > 0.5:
            raise KeyError("gains")
        return [0.0]

    with pytest.raises(KeyError, match="gains"):
        hamel.simulate(robot, 1e9, inputs=fail, samples=[0.0])
    wrong = {
        r"the result of inputs has shape \(2,\): it must have shape \(..., 1\)": [0.0, 0.0],
        r"the result of inputs has shape \(1, 1\): it must have shape \(1,\)": [[0.0]],
        "the result of inputs is an array of object: it must be one of real numbers": None,
    }
    for message, result in wrong.items():
        with pytest.raises(hamel.ArgumentError, match=message):
            hamel.simulate(robot, 1.0, inputs=lambda time, q, v, result=result: result)
    with pytest.raises(hamel.Error, match="hinge"):
        hamel.simulate(robot, 1.0, inputs=lambda time, q, v: [np.nan])
    with pytest.raises(hamel.ArgumentError, match="inputs is 3: it must be a function"):
        hamel.simulate(robot, 1.0, inputs=3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"t_end": -1.0}, "t_end is -1 s: it lies before the initial time 0 s"),
        ({"t_end": float("nan")}, "nan|NaN"),
        ({"t_end": "soon"}, "t_end is 'soon': it must be a number"),
        ({"method": "euler"}, "method is `euler`: it must be one of rk4, cf4, .*, auto"),
        ({"method": 4}, "method is 4: it must be a str"),
        ({"method": "rk4", "tolerance": 1e-6}, "the method `rk4` does not estimate its error"),
        ({"dt": 0.1, "tolerance": 1e-6}, "dt is 0.1 and tolerance is 0.000001: a method takes one of them"),
        ({"accuracy": 1e-6, "tolerance": 1e-6}, "accuracy is 0.000001 and tolerance is 0.000001: for an accuracy the tolerance is searched for"),
        ({"accuracy": 1e-6, "dt": 0.1}, "accuracy is 0.000001 and dt is 0.1: for an accuracy the tolerance is searched for"),
        ({"accuracy": 1e-6, "method": "rk4"}, "accuracy is 0.000001 and method is `rk4`, which has no step control"),
        ({"tolerance": 0.0}, "tolerance is 0: it must be between 1e-16 and 0.1"),
        ({"dt": -1.0}, "dt is -1: it must be positive and finite"),
        ({"arithmetic": "floats"}, "arithmetic is `floats`: it must be `doubles`, `refined` or `auto`"),
        ({"form": "newton"}, "form is `newton`: it must be `lagrangian` or `hamiltonian`"),
        ({"sample_step": 0.0}, "the time between two samples is 0.0 s, it must be above 0"),
        ({"samples": [0.2, 0.1]}, "sample 1 is at 0.1 s: sample times ascend"),
        ({"samples": [[0.1]]}, r"samples has shape \(1, 1\): it must have shape \(n,\)"),
        ({"samples": [0.1], "sample_step": 0.1}, "samples and sample_step are both given"),
        ({"start": 3}, r"start is 3: it must be a State or a pair \(q, v\)"),
        ({"start": ([1.0, 2.0], [0.0])}, r"start: q has shape \(2,\): it must have shape \(1,\)"),
        ({"start": ([float("nan")], [0.0])}, "initial state: joint `hinge`"),
    ],
)
def test_options_are_refused(options, message):
    with pytest.raises(hamel.ArgumentError, match=message):
        hamel.simulate(hamel.load(PENDULUM), **{"t_end": 1.0, **options})


def test_what_is_no_robot_is_told():
    with pytest.raises(hamel.ArgumentError, match="robot is 'a': it must be a Robot"):
        hamel.simulate("a", 1.0)


def test_a_motion_that_does_not_go_on_tells_the_time():
    # Speeds near the end of the range of numbers, where the equations of an implicit step have no solution.
    robot = hamel.load(PENDULUM.replace("-9.81", "-1e300"))
    start = hamel.State(np.zeros(1), np.zeros(1), 3.0)
    with pytest.raises(hamel.IntegrationError, match="the step of .* s at 3 s fails: .* `hinge`") as caught:
        hamel.simulate(robot, 4.0, start=start, method="gauss2", dt=0.1, estimate=False)
    assert caught.value.time == 3.0


@pytest.fixture
def ctrl_c():
    """Ctrl-C raises, also where the shell that runs this in the background ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("ctrl_c")
def test_an_interrupt_is_heard_at_once():
    """Ctrl-C in the middle of a motion, of its estimate, and of a batch."""
    robot = hamel.load(PENDULUM)
    q = np.zeros((20_000_000, 1))
    # On many, the batch might be over by then.
    hamel.set_threads(2)
    calls = [
        lambda: hamel.simulate(robot, 1e6, dt=1e-4, samples=[0.0], estimate=False),
        lambda: hamel.simulate(robot, 1e5, accuracy=1e-6, samples=[0.0]),
        lambda: robot.forward_dynamics_derivatives(q, q, q),
    ]
    for call in calls:
        sent = []

        def send():
            sent.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)

        timer = threading.Timer(0.5, send)
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            call()
        heard = time.perf_counter() - sent[0]
        timer.join()
        # 0.1 s are promised; others work on the machine that runs this.
        assert heard < 0.5, heard


@pytest.mark.usefixtures("ctrl_c")
def test_an_interrupt_ends_a_moving_picture(tmp_path):
    motion = hamel.simulate(hamel.load(PENDULUM), 20.0, sample_step=0.04, estimate=False)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        # 500 pictures take seconds.
        motion.save(tmp_path / "motion.gif")
    timer.join()
    assert not list(tmp_path.iterdir())


def test_pandas_has_a_column_for_each_entry():
    pandas = pytest.importorskip("pandas")
    motion = hamel.simulate(hamel.load(PENDULUM), 0.1)
    table = motion.to_pandas()
    assert isinstance(table, pandas.DataFrame)
    names = ["t_s", "energy_J", "kinetic_energy_J", "potential_energy_J", "error", "hinge.q.q_rad", "hinge.v.q_rad_per_s"]
    assert list(table.columns) == names
    assert np.array_equal(table["hinge.q.q_rad"], motion.q[:, 0])


def test_pandas_is_not_needed():
    program = "import sys, hamel; assert 'pandas' not in sys.modules"
    subprocess.run([sys.executable, "-c", program], check=True)
