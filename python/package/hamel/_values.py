"""What robots give: states, derivatives, and what is known of a joint."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Sizes(NamedTuple):
    """Sizes of the vectors of a robot."""

    configuration: int
    """Entries of q."""
    freedoms: int
    """Entries of tau, and of local coordinates phi."""
    speeds: int
    """Entries of v and of accelerations: less than freedoms where joints are nonholonomic."""


class Limits(NamedTuple):
    """Limits of a joint as its file says them, None where it says none; of a URDF they are not simulated."""

    lower: float | None
    """Least position, rad or m."""
    upper: float | None
    """Largest position, rad or m."""
    velocity: float | None
    """Largest velocity, rad/s or m/s."""
    effort: float | None
    """Largest effort, N m or N."""


class Parameter(NamedTuple):
    """A parameter of a joint type."""

    name: str
    unit: str
    """SI unit, such as ``m`` or ``m/rad``."""
    description: str
    lower: float | None
    """Least value; None where the spec says none."""
    upper: float | None
    """Greatest value. Without a range it may be any number but 0."""


class Claim(NamedTuple):
    """Something that is true of a joint type, and how that is known."""

    name: str
    """Stable name, such as ``pose_in_se3``."""
    statement: str
    proof: str
    """``normal_form``, ``certificate``, or ``checked`` for what the spec leaves unproved."""
    detail: str
    """The certificate, or the author's reason."""
    points: int
    """Points at which a claim that is not proved was evaluated; 0 for proofs."""


@dataclass(frozen=True)
class JointInfo:
    """A joint of a robot: its names, and where its entries lie."""

    name: str
    type: str
    """Type of the joint library, such as ``revolute``."""
    bodies: tuple[str, ...]
    """The bodies that it carries, one as a rule."""
    parent: str | None
    """The body that it stands on; None for the world."""
    configuration: slice
    """Its entries of q."""
    freedoms: slice
    """Its entries of tau, and of local coordinates phi."""
    speeds: slice
    """Its entries of v and of accelerations."""
    coordinates: tuple[str, ...]
    """Names of its entries of q."""
    freedom_names: tuple[str, ...]
    """Names of its entries of tau."""
    speed_names: tuple[str, ...]
    """Names of its entries of v."""
    units: tuple[str, ...]
    """Units of its entries of q; empty where nothing tells one."""
    speed_units: tuple[str, ...]
    """Units of its entries of v."""
    effort_units: tuple[str, ...]
    """Units of its entries of tau."""
    limits: Limits | None
    """What its file says of limits."""


@dataclass(frozen=True, eq=False)
class State:
    """A state of a robot: q, v and a time in s."""

    configuration: NDArray[np.float64]
    speeds: NDArray[np.float64]
    time: float = 0.0


class ForwardDerivatives(NamedTuple):
    """Accelerations and their derivatives; S speeds, K freedoms."""

    rates: NDArray[np.float64]
    """Accelerations, (..., S)."""
    by_local: NDArray[np.float64]
    """By local coordinates phi about q, (..., S, K)."""
    by_speeds: NDArray[np.float64]
    """By v, (..., S, S)."""
    by_efforts: NDArray[np.float64]
    """By tau, (..., S, K)."""


class InverseDerivatives(NamedTuple):
    """Derivatives of inverse dynamics; S speeds, K freedoms. That by accelerations is the mass matrix."""

    by_local: NDArray[np.float64]
    """By local coordinates phi about q, (..., S, K)."""
    by_speeds: NDArray[np.float64]
    """By v, (..., S, S)."""


class Regressor(NamedTuple):
    """Inverse dynamics as a linear function of the inertial parameters of a robot of B bodies and S speeds."""

    matrix: NDArray[np.float64]
    """By inertial parameters, (..., S, 10 B)."""
    rest: NDArray[np.float64]
    """What inertias have no part in, (..., S): what rotors take, less what springs, dampers and limits exert."""


class BaseParameters(NamedTuple):
    """The fewest combinations of inertial parameters on which efforts depend; n of them, of B bodies."""

    matrix: NDArray[np.float64]
    """Takes inertial parameters to base parameters, (n, 10 B)."""
    kept: NDArray[np.int64]
    """The parameters that stand for them, (n,): columns of a regressor, so that ``regressor.matrix[..., kept] @ (matrix @ parameters)`` is ``regressor.matrix @ parameters``."""
    names: tuple[str, ...]
    """Each as a sum, such as ``I_zz(upper) + 0.25 m(fore)``."""
    is_minimal: bool
    """Whether the regressor at random states has shown that they are as few as can be, and that nothing else acts."""
