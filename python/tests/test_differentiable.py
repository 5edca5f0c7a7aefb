"""Equations of motion in PyTorch and JAX: their derivatives are those of differences. Each is tested where it is installed."""

from importlib import import_module

import hamel
import numpy as np
import pytest
from conftest import PANDA, SCENES, states

FUNCTIONS = ("forward_dynamics", "inverse_dynamics")

# Angles; rotation matrices of balls; a loop whose coordinates are coupled by relations; speeds that are fewer than degrees of freedom.
ROBOTS = [PANDA, SCENES / "double_ball_pendulum.toml", SCENES / "humanoid.toml", SCENES / "rolling_disk.toml"]


def of_torch(function, robot, arguments, weights):
    """The value of a function, and the gradients of its sum with weights."""
    torch = pytest.importorskip("torch")
    torch_of = import_module("hamel.torch")
    tensors = [torch.tensor(own, requires_grad=True) for own in arguments]
    value = getattr(torch_of, function)(robot, *tensors)
    (value * torch.tensor(weights)).sum().backward()
    return value.detach().numpy(), [own.grad.numpy() for own in tensors]


def of_jax(function, robot, arguments, weights):
    jax = pytest.importorskip("jax")
    jax_of = import_module("hamel.jax")
    jax.config.update("jax_enable_x64", True)

    def weighted(*arguments):
        value = getattr(jax_of, function)(robot, *arguments)
        return (value * weights).sum(), value

    slopes, value = jax.jit(jax.grad(weighted, argnums=(0, 1, 2), has_aux=True))(*arguments)
    return np.asarray(value), [np.asarray(own) for own in slopes]


def near(robot, count):
    """States close to where the file begins, where all joints are regular."""
    random = np.random.default_rng(7)
    start, sizes = robot.state(), robot.sizes
    steps = random.uniform(-0.05, 0.05, (count, sizes.freedoms, 1))
    q = start.configuration + (robot.configuration_by_local(start.configuration) @ steps)[..., 0]
    return robot.project(q), random.normal(size=(count, sizes.speeds)), random.normal(size=(count, sizes.freedoms))


@pytest.mark.parametrize("gradients", [of_torch, of_jax])
@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
@pytest.mark.parametrize("function", FUNCTIONS)
def test_gradients_are_those_of_differences(function, path, gradients):
    robot = hamel.load(path)
    q, v, tau = near(robot, 3)
    arguments = [q, v, tau if function == "forward_dynamics" else np.roll(v, 1)]
    evaluate = getattr(robot, function)
    random = np.random.default_rng(8)
    weights = random.normal(size=evaluate(*arguments).shape)
    value, found = gradients(function, robot, arguments, weights)
    assert np.array_equal(value, evaluate(*arguments))
    # On the manifold of q a direction is one of local coordinates.
    along = (robot.configuration_by_local(q) @ random.normal(size=(3, robot.sizes.freedoms, 1)))[..., 0]
    directions = [along, random.normal(size=arguments[1].shape), random.normal(size=arguments[2].shape)]
    for place, (gradient, direction) in enumerate(zip(found, directions)):
        # The truncation of central differences is about h², their rounding about 1e-16 / h times the values.
        h = 1e-5
        ends = []
        for side in (h, -h):
            moved = list(arguments)
            moved[place] = moved[place] + side * direction
            moved[0] = robot.project(moved[0])
            ends.append((evaluate(*moved) * weights).sum())
        wanted = (ends[0] - ends[1]) / (2 * h)
        size = max(1.0, abs(wanted), np.abs(evaluate(*arguments)).max())
        assert abs((gradient * direction).sum() - wanted) < 1e-6 * size, (place, wanted)


def test_torch_checks_its_gradients_over_batches(panda):
    torch = pytest.importorskip("torch")
    torch_of = import_module("hamel.torch")
    q, v, tau = (torch.tensor(own, requires_grad=True) for own in states(panda, 2))
    # Of each of several shapes the gradient is a sum over what it was broadcast to.
    for arguments in ((q, v[0], tau), (q[:, None], v, tau[0]), (q[0], v[0], tau[0])):
        for function in FUNCTIONS:
            torch.autograd.gradcheck(lambda *own, function=function: getattr(torch_of, function)(panda, *own), arguments)
    value = torch_of.forward_dynamics(panda, q.float(), v.float(), tau.float())
    assert value.dtype == torch.float32
    with torch.no_grad():
        assert not torch_of.forward_dynamics(panda, q, v, tau).requires_grad


def test_jax_maps_compiles_and_differentiates_both_ways(panda):
    jax = pytest.importorskip("jax")
    jax_of = import_module("hamel.jax")
    from jax.test_util import check_grads

    jax.config.update("jax_enable_x64", True)
    q, v, tau = states(panda, 4)
    plain = panda.forward_dynamics(q, v, tau)
    mapped = jax.jit(jax.vmap(lambda q, v, tau: jax_of.forward_dynamics(panda, q, v, tau)))
    assert np.array_equal(mapped(q, v, tau), plain)
    half = jax.vmap(lambda q: jax_of.inverse_dynamics(panda, q, v[0], v[1]))(q)
    assert np.array_equal(half, panda.inverse_dynamics(q, v[0], v[1]))
    for function in FUNCTIONS:
        check_grads(lambda *own, function=function: getattr(jax_of, function)(panda, *own), (q, v[0], tau[0]), order=1)
    jacobian = jax.jacfwd(lambda q: jax_of.forward_dynamics(panda, q, v[0], tau[0]))(q[0])
    exact = panda.forward_dynamics_derivatives(q[0], v[0], tau[0]).by_local
    assert np.abs(jacobian - exact).max() < 1e-12 * np.abs(exact).max()


def test_single_precision_is_projected_to_the_manifold():
    robot = hamel.load(SCENES / "double_ball_pendulum.toml")
    arguments = near(robot, 2)
    exact = robot.forward_dynamics(*arguments)
    torch = pytest.importorskip("torch")
    torch_of = import_module("hamel.torch")
    tensors = [torch.tensor(own, dtype=torch.float32, requires_grad=True) for own in arguments]
    value = torch_of.forward_dynamics(robot, *tensors)
    value.sum().backward()
    # Arguments were rounded to 24 bits.
    assert np.abs(value.detach().numpy() - exact).max() < 1e-4 * max(1.0, np.abs(exact).max())


def test_errors_are_those_of_robots(panda):
    torch = pytest.importorskip("torch")
    torch_of = import_module("hamel.torch")
    q = torch.zeros(7, dtype=torch.float64)
    with pytest.raises(hamel.ArgumentError, match=r"tau has shape \(6,\)"):
        torch_of.forward_dynamics(panda, q, q, q[:6])
