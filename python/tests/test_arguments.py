"""Arrays of any shape, order and kind of numbers; what is refused is told by name."""

import hamel
import numpy as np
import pytest
from conftest import SCENES, states


def test_leading_dimensions_broadcast(panda):
    q, v, tau = states(panda, 12)
    q, v, tau = q.reshape(3, 4, 7), v[:4], tau[0]
    found = panda.forward_dynamics(q, v, tau)
    assert found.shape == (3, 4, 7)
    full = (np.ascontiguousarray(part) for part in np.broadcast_arrays(q, v, tau))
    assert np.array_equal(found, panda.forward_dynamics(*full))
    apart = panda.forward_dynamics(q, v[:, None, None], tau)
    assert apart.shape == (4, 3, 4, 7)
    assert np.array_equal(apart[2, 1, 3], panda.forward_dynamics(q[1, 3], v[2], tau))


@pytest.mark.parametrize("count", [0, 1])
def test_batches_of_none_and_one(panda, count):
    q, v, tau = states(panda, count)
    assert panda.forward_dynamics(q, v, tau).shape == (count, 7)
    assert panda.mass_matrix(q).shape == (count, 7, 7)
    assert panda.pose(q, "panda_hand").shape == (count, 4, 4)
    assert panda.energy(q, v).shape == (count,)
    assert panda.forward_dynamics_derivatives(q, v, tau).by_local.shape == (count, 7, 7)
    assert panda.forward_dynamics_second_derivatives(q, v, tau, tau).shape == (count, 21, 21)
    assert panda.configuration(q).shape == (count, 7)


def test_results_of_one_state_have_no_batch(panda):
    q, v, tau = (part[0] for part in states(panda, 1))
    assert panda.forward_dynamics(q, v, tau).shape == (7,)
    assert panda.energy(q, v).shape == ()
    assert panda.jacobian(q, "panda_hand").shape == (6, 7)


def test_arrays_are_converted_and_neither_modified_nor_kept(panda):
    q, v, tau = states(panda, 6)
    expected = panda.forward_dynamics(q, v, tau)
    strided = np.zeros((12, 14))
    strided[::2, ::2] = q
    single = np.round(q, 2).astype(np.float32)
    swapped = q.astype(">f8")
    shifted = np.frombuffer(b"x" + q.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(q.shape)
    assert not shifted.flags.aligned
    fixed = q.copy()
    fixed.flags.writeable = False
    for given in (strided[::2, ::2], np.asfortranarray(q), q.tolist(), swapped, shifted, fixed):
        before = np.array(given)
        assert np.array_equal(panda.forward_dynamics(given, v, tau), expected)
        assert np.array_equal(before, given)
    assert np.array_equal(panda.mass_matrix(single), panda.mass_matrix(single.astype(float)))
    assert np.array_equal(panda.mass_matrix([0] * 7), panda.mass_matrix(np.zeros(7)))
    result = panda.forward_dynamics(q, v, tau)
    q[:] = v[:] = tau[:] = np.nan
    assert np.array_equal(result, expected)
    result[:] = 0.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((np.zeros(6), np.zeros(7), np.zeros(7)), "q has shape (6,): it must have shape (..., 7)"),
        ((np.zeros(7), np.zeros((2, 8)), np.zeros(7)), "v has shape (2, 8): it must have shape (..., 7)"),
        ((np.zeros(7), np.zeros(7), 1.0), "tau has shape (): it must have shape (..., 7)"),
        ((np.zeros(7), np.zeros(7), []), "tau has shape (0,): it must have shape (..., 7)"),
        (
            (np.zeros((2, 7)), np.zeros((3, 7)), np.zeros(7)),
            "shapes do not broadcast: q (2, 7), v (3, 7), tau (7,); dimensions before the last must be equal or 1",
        ),
        ((np.zeros(7, complex), np.zeros(7), np.zeros(7)), "q is an array of complex128: it must be one of real numbers"),
        ((["a"] * 7, np.zeros(7), np.zeros(7)), "q is an array of <U1: it must be one of real numbers"),
        ((None, np.zeros(7), np.zeros(7)), "q is an array of object: it must be one of real numbers"),
    ],
)
def test_wrong_arrays_are_told(panda, arguments, message):
    with pytest.raises(hamel.ArgumentError) as caught:
        panda.forward_dynamics(*arguments)
    assert str(caught.value) == message
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, hamel.Error)


def test_what_is_not_about_the_argument_is_passed_on(panda):
    class Interrupted:
        def __array__(self, *_, **__):
            raise KeyboardInterrupt

    class Large:
        def __array__(self, *_, **__):
            raise MemoryError

    for value, kind in ((Interrupted(), KeyboardInterrupt), (Large(), MemoryError)):
        with pytest.raises(kind):
            panda.mass_matrix(value)


def test_results_have_at_most_32_dimensions(panda):
    assert panda.mass_matrix(np.zeros((1,) * 30 + (7,))).ndim == 32
    with pytest.raises(hamel.ArgumentError, match="arguments have 31 dimensions before the last: they must have at most 30"):
        panda.mass_matrix(np.zeros((1,) * 31 + (7,)))


def test_configurations_that_are_none_are_refused():
    robot = hamel.load(SCENES / "ball_pendulum_swing_up.toml")
    q = robot.state().configuration
    with pytest.raises(hamel.ArgumentError, match="joint `pivot`: its configuration is off its manifold by"):
        robot.mass_matrix(1.001 * q)
    # What float32 cuts off, `project` puts back, to what is left of float32.
    cut = q.astype(np.float32)
    whole = robot.project(cut)
    assert np.abs(whole - q).max() < 1e-6
    assert np.isfinite(robot.mass_matrix(whole)).all()


def test_ragged_lists_are_told(panda):
    with pytest.raises(hamel.ArgumentError, match="^q is no array of numbers: "):
        panda.mass_matrix([[0.0] * 7, [0.0] * 6])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_the_first_state_with_a_number_that_is_none_is_told(panda, value):
    # Later ones are met first by other threads.
    q, v, tau = states(panda, 5000)
    v[[1234, 1235, 2000, 4000], 2] = value
    with pytest.raises(hamel.ArgumentError) as caught:
        panda.forward_dynamics(q.reshape(50, 100, 7), v.reshape(50, 100, 7), tau.reshape(50, 100, 7))
    assert caught.value.index == (12, 34)
    text = f"state (12, 34): joint `panda_joint3`: speeds entry `q` is {str(value).replace('nan', 'NaN')}, not a finite number"
    assert str(caught.value) == text


def test_every_function_takes_numbers_that_are_none(panda):
    bad = np.full(7, np.nan)
    three = [panda.forward_dynamics, panda.inverse_dynamics, panda.forward_dynamics_derivatives, panda.inverse_dynamics_derivatives]
    calls = [lambda own=own: own(bad, bad, bad) for own in three]
    four = [panda.forward_dynamics_second_derivatives, panda.inverse_dynamics_second_derivatives]
    calls += [lambda own=own: own(bad, bad, bad, bad) for own in four]
    calls += [lambda own=own: own(bad, bad) for own in (panda.bias_forces, panda.energy, panda.kinetic_energy)]
    one = [panda.mass_matrix, panda.potential_energy, panda.poses, panda.center_of_mass, panda.configuration, panda.positions]
    calls += [lambda own=own: own(bad) for own in one]
    calls += [lambda: panda.jacobian(bad, "panda_hand"), lambda: panda.pose(bad, "panda_hand")]
    for call in calls:
        with pytest.raises(hamel.Error):
            call()


def test_more_numbers_than_memory_holds(panda):
    many = np.zeros((2**20, 7))
    q, v = many[:, None, None], many[:, None]
    # 62 TB, and more bytes than a number tells.
    for tau in (np.zeros(7), many):
        with pytest.raises(MemoryError):
            panda.forward_dynamics(q, v, tau)


def test_numbers_of_threads(panda):
    q = states(panda, 2000)[0]
    expected = panda.mass_matrix(q)
    for count in (1, 10**9, 0, None):
        hamel.set_threads(count)
        assert np.array_equal(panda.mass_matrix(q), expected)
    with pytest.raises(hamel.ArgumentError, match="count is -1: it must be at least 0"):
        hamel.set_threads(-1)


def test_names_are_told_with_the_nearest(panda):
    with pytest.raises(hamel.ArgumentError, match="frame or body `panda_hnd`; did you mean `panda_hand`"):
        panda.pose(np.zeros(7), "panda_hnd")
    with pytest.raises(hamel.ArgumentError, match="joint or body `panda_jont4`; did you mean `panda_joint4`"):
        panda.joint("panda_jont4")
    with pytest.raises(hamel.ArgumentError, match="axes is `local`: it must be `world_aligned`, `body` or `world`"):
        panda.jacobian(np.zeros(7), "panda_hand", "local")


def test_positions_and_configurations():
    robot = hamel.load(SCENES / "plate_cart_arm.toml")
    random = np.random.default_rng(3)
    positions = random.uniform(-1.0, 1.0, (5, robot.sizes.freedoms))
    q = robot.configuration(positions)
    assert q.shape == (5, robot.sizes.configuration)
    # Rounding of angles of about 1 through exp and log.
    assert np.abs(robot.positions(q) - positions).max() < 1e-14
    with pytest.raises(hamel.ArgumentError, match="off its manifold"):
        robot.positions(2.0 * q)


def test_positions_by_name(panda):
    q = panda.configuration({"panda_joint4": -1.5, "panda_link2": [0.25]})
    assert q.tolist() == [0.0, 0.25, 0.0, -1.5, 0.0, 0.0, 0.0]
    for wrong in ([1.0, 2.0], "a", None):
        with pytest.raises(hamel.ArgumentError, match="positions: joint `panda_joint4` is at .*: it must be at 1 numbers"):
            panda.configuration({"panda_joint4": wrong})
    with pytest.raises(hamel.ArgumentError, match="did you mean `panda_joint4`"):
        panda.configuration({"panda_joint44": 0.0})
