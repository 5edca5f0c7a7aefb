"""Equations of motion as functions that JAX differentiates, by their analytic derivatives, and compiles among others. Needs jax.

Arrays have the shapes that methods of ``Robot`` take: the last dimension is one state, those before it are a batch and broadcast. Values are computed in doubles by a call of the processor from
within what JAX compiles; with ``jax.config.update("jax_enable_x64", True)`` they are doubles, else rounded to single precision. Derivatives by q are those along the manifold of the joints, in the
entries of q. There are first derivatives, forwards and backwards, no second ones.
"""

# Types are checked with the library and without it.
# mypy: disable-error-code="misc,no-any-return,no-untyped-call,untyped-decorator"

from __future__ import annotations

from functools import lru_cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from . import _hamel
from ._errors import ArgumentError
from ._slopes import slopes


def forward_dynamics(robot: _hamel.Robot, q: jax.typing.ArrayLike, v: jax.typing.ArrayLike, tau: jax.typing.ArrayLike) -> jax.Array:
    """Accelerations, (..., S), as ``Robot.forward_dynamics``."""
    return _function("forward_dynamics", robot)(q, v, tau)


def inverse_dynamics(robot: _hamel.Robot, q: jax.typing.ArrayLike, v: jax.typing.ArrayLike, a: jax.typing.ArrayLike) -> jax.Array:
    """Efforts, (..., S), as ``Robot.inverse_dynamics``."""
    return _function("inverse_dynamics", robot)(q, v, a)


@lru_cache(maxsize=64)
def _function(function: str, robot: _hamel.Robot) -> Any:
    """A function of one robot, with the rule by which it is differentiated."""
    def doubles(*arguments: Any) -> tuple[NDArray[np.float64], ...]:
        q, v, last = (np.asarray(own, np.float64) for own in arguments)
        # Fewer digits are not enough for matrices that are rotations.
        is_exact = np.asarray(arguments[0]).dtype == np.float64
        return q if is_exact else robot.project(q), v, last

    def value(q: Any, v: Any, last: Any) -> NDArray[Any]:
        found = getattr(robot, function)(*doubles(q, v, last))
        return np.asarray(found, np.asarray(q).dtype)

    def derivatives(q: Any, v: Any, last: Any) -> tuple[NDArray[Any], ...]:
        found = slopes(robot, function, *doubles(q, v, last))
        return tuple(np.asarray(own, np.asarray(q).dtype) for own in found)

    @jax.custom_jvp
    def evaluate(q: Any, v: Any, last: Any) -> Any:
        return jax.pure_callback(value, shape((q, v, last), ()), q, v, last, vmap_method="broadcast_all")

    @evaluate.defjvp
    def differentiate(arguments: Any, tangents: Any) -> Any:
        widths = ((), *((own.shape[-1],) for own in arguments))
        shapes = tuple(shape(arguments, width) for width in widths)
        found, *parts = jax.pure_callback(derivatives, shapes, *arguments, vmap_method="broadcast_all")
        return found, sum(jnp.einsum("...ij,...j->...i", part, tangent) for part, tangent in zip(parts, tangents))

    def shape(arguments: Any, width: tuple[int, ...]) -> jax.ShapeDtypeStruct:
        batch = jnp.broadcast_shapes(*(own.shape[:-1] for own in arguments))
        return jax.ShapeDtypeStruct((*batch, robot.sizes.speeds, *width), jnp.result_type(arguments[0]))

    sizes = robot.sizes
    rooms = {"q": sizes.configuration, "v": sizes.speeds}
    rooms |= {"tau": sizes.freedoms} if function == "forward_dynamics" else {"a": sizes.speeds}

    def call(*arguments: jax.typing.ArrayLike) -> jax.Array:
        real = [jnp.asarray(own, jnp.result_type(float)) for own in arguments]
        for (name, room), own in zip(rooms.items(), real):
            # What is raised while the function runs, JAX puts into an error of its own.
            if own.ndim == 0 or own.shape[-1] != room:
                raise ArgumentError(f"{name} has shape {own.shape}: it must have shape (..., {room})")
        return evaluate(*real)

    return call
