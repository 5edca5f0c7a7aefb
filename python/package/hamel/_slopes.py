"""Derivatives of the equations of motion by q, v and the third argument, for libraries that differentiate."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _hamel

_Array = NDArray[np.float64]


class Slopes(NamedTuple):
    """A value (..., S) and its derivatives by the three arguments."""

    value: _Array
    by_q: _Array
    by_v: _Array
    by_last: _Array


def slopes(robot: _hamel.Robot, function: str, q: _Array, v: _Array, last: _Array) -> Slopes:
    """The value of ``forward_dynamics`` or ``inverse_dynamics``, and its derivatives.

    Those by q are along the manifold of the joints: a change of q that leaves it, such as that of the length of a quaternion, changes nothing.
    """
    if function == "forward_dynamics":
        forward = robot.forward_dynamics_derivatives(q, v, last)
        value, by_local, by_v, by_last = forward.rates, forward.by_local, forward.by_speeds, forward.by_efforts
    else:
        inverse = robot.inverse_dynamics_derivatives(q, v, last)
        value, by_local, by_v, by_last = robot.inverse_dynamics(q, v, last), inverse.by_local, inverse.by_speeds, robot.mass_matrix(q)
        by_last = np.broadcast_to(by_last, by_v.shape).copy()
    return Slopes(value, by_local @ _to_local(robot, q), by_v, by_last)


def _to_local(robot: _hamel.Robot, q: _Array) -> _Array:
    """Changes of q to local coordinates, (..., K, N): the pseudoinverse of what local coordinates do to q."""
    basis = robot.configuration_by_local(q)
    transposed = np.swapaxes(basis, -1, -2)
    if robot.sizes.configuration == robot.sizes.freedoms and np.array_equal(basis, np.broadcast_to(np.eye(basis.shape[-1]), basis.shape)):
        # Angles and displacements.
        return basis
    return np.asarray(np.linalg.solve(transposed @ basis, transposed), np.float64)
