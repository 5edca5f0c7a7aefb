"""Equations of motion as functions that PyTorch differentiates, by their analytic derivatives. Needs torch.

Tensors have the shapes of the arrays that methods of ``Robot`` take: the last dimension is one state, those before it are a batch and broadcast. Values are computed in doubles on the processor, and
have the type and the device of the tensors given. Gradients by q are those along the manifold of the joints, in the entries of q. There are first derivatives, no second ones.
"""

# Types are checked with the library and without it.
# mypy: disable-error-code="misc,no-any-return,no-untyped-call,untyped-decorator"

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from . import _hamel
from ._slopes import slopes


def forward_dynamics(robot: _hamel.Robot, q: torch.Tensor, v: torch.Tensor, tau: torch.Tensor) -> torch.Tensor:
    """Accelerations, (..., S), as ``Robot.forward_dynamics``."""
    return _Dynamics.apply("forward_dynamics", robot, q, v, tau)


def inverse_dynamics(robot: _hamel.Robot, q: torch.Tensor, v: torch.Tensor, a: torch.Tensor) -> torch.Tensor:
    """Efforts, (..., S), as ``Robot.inverse_dynamics``."""
    return _Dynamics.apply("inverse_dynamics", robot, q, v, a)


class _Dynamics(torch.autograd.Function):
    """A function of a robot; derivatives are computed where a gradient is wanted."""

    @staticmethod
    def forward(ctx: Any, function: str, robot: _hamel.Robot, *arguments: torch.Tensor) -> torch.Tensor:
        q, v, last = (own.detach().to("cpu", torch.float64).numpy() for own in arguments)
        if arguments[0].dtype != torch.float64:
            q = robot.project(q)
        ctx.shapes = [own.shape for own in arguments]
        if not any(ctx.needs_input_grad):
            return _tensor(getattr(robot, function)(q, v, last), arguments[0])
        found = slopes(robot, function, q, v, last)
        ctx.save_for_backward(*(_tensor(own, arguments[0]) for own in (found.by_q, found.by_v, found.by_last)))
        return _tensor(found.value, arguments[0])

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, gradient: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        row = gradient.unsqueeze(-2)
        all_states = ((row @ own).squeeze(-2) for own in ctx.saved_tensors)
        gradients = (own.sum_to_size(shape) for own, shape in zip(all_states, ctx.shapes))
        return None, None, *gradients


def _tensor(array: NDArray[np.float64], like: torch.Tensor) -> torch.Tensor:
    return torch.from_numpy(array).to(like.device, like.dtype)
