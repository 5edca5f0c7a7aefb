"""Motions."""

from __future__ import annotations

import html
from collections.abc import Callable
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _hamel
from ._errors import ArgumentError
from ._values import State

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False)
class Motion:
    """A motion: arrays with one row per sample; n samples, N entries of q, S speeds."""

    robot: _hamel.Robot
    """The robot that moved."""
    t: NDArray[np.float64]
    """Times, s, (n,)."""
    q: NDArray[np.float64]
    """Configurations, (n, N)."""
    v: NDArray[np.float64]
    """Speeds, (n, S)."""
    energy: NDArray[np.float64]
    """Kinetic and potential energy, J, (n,)."""
    kinetic_energy: NDArray[np.float64]
    """J, (n,)."""
    potential_energy: NDArray[np.float64]
    """Of gravity and springs, J, (n,); that of gravity is zero at the world's origin."""
    error: NDArray[np.float64] | None
    """Estimated error of each sample, (n,): attitudes in rad, positions and speeds as parts of max(1 SI unit, size). None without ``estimate``."""
    end_error: float | None
    """That of the last state."""
    doubt: str | None
    """Why the estimate may be wrong by more than a factor of ten, if so."""
    method: str
    """The method at the start."""
    events: list[tuple[float, str]]
    """Time in s and name of what happened on the way."""
    is_stopped: bool
    """Whether an event of the scene ended it early."""
    statistics: dict[str, int]
    """Steps, rejected steps and evaluations of the equations of motion."""
    columns: tuple[list[str], list[str]] = field(repr=False)
    """Names of the columns of q and of v."""
    has_inputs: bool
    """Whether efforts of ``inputs`` acted."""

    @property
    def end(self) -> State:
        """The last sample as a state."""
        if len(self.t) == 0:
            raise ArgumentError("the motion has no samples, so that it has no last one")
        return State(self.q[-1].copy(), self.v[-1].copy(), float(self.t[-1]))

    def to_pandas(self) -> pandas.DataFrame:
        """A ``pandas.DataFrame`` with a row for each sample; needs pandas."""
        import pandas

        table = {"t_s": self.t}
        table["energy_J"] = self.energy
        table["kinetic_energy_J"] = self.kinetic_energy
        table["potential_energy_J"] = self.potential_energy
        if self.error is not None:
            table["error"] = self.error
        for names, values in zip(self.columns, (self.q, self.v)):
            table.update(zip(names, values.T))
        return pandas.DataFrame(table)

    def to_html(self) -> str:
        """One page of HTML that needs nothing else: plays the motion in three dimensions, with the meshes of the robot, and plots energies, momentum, coordinates and speeds."""
        return _hamel.page(self.robot, self._shown())

    def save(self, path: str | PathLike[str], *, instants: int = 1) -> None:
        """Writes the motion as a page or a picture, by the ending of ``path``; a file of that name is replaced.

        Args:
            path: ``.html``, the page of ``to_html``; ``.svg`` or ``.png``, a still picture of 960 by 640 pixels; ``.gif``, a moving one of 640 by 426. SVG has no meshes.
                A GIF has at most 25 pictures a second, and plays for 2 to 20 s.
            instants: how many samples a still picture shows, from the first to the last, the earlier ones paler; 1 to 50.

        Raises:
            ArgumentError: another ending, a number of instants out of range, a motion without samples.
            OSError: a file that cannot be written.
        """
        file = Path(path)
        kind = file.suffix.lower().removeprefix(".")
        if kind not in ("gif", "html", "png", "svg"):
            raise ArgumentError(f"path is {str(path)!r}: it must end in .html, .svg, .png or .gif")
        if not hasattr(instants, "__index__") or not 1 <= instants <= 50:
            raise ArgumentError(f"instants is {instants!r}: it must be an integer from 1 to 50")
        if kind == "html":
            file.write_text(self.to_html(), encoding="utf-8")
        else:
            file.write_bytes(_hamel.picture(self.robot, self._shown(), kind, int(instants)))

    def _shown(self) -> dict[str, Any]:
        """What pages and pictures are made of."""
        error = "" if self.end_error is None else f" · estimated error at the end {self.end_error:.1e}"
        return {
            "t": np.asarray(self.t, dtype=float),
            "q": np.asarray(self.q, dtype=float),
            "v": np.asarray(self.v, dtype=float),
            "error": None if self.error is None else self.error.tolist(),
            "method": self.method + error + (", not reliable" if self.doubt else ""),
            "has_inputs": self.has_inputs,
        }

    def _repr_html_(self) -> str | None:
        if len(self.t) == 0:
            return None
        page = html.escape(self.to_html())
        return f'<iframe srcdoc="{page}" sandbox="allow-scripts" width="100%" height="640" style="border:0" title="motion"></iframe>'

    def __repr__(self) -> str:
        error = "" if self.end_error is None else f", error {self.end_error:.1e}"
        span = f"{self.t[0]:g} s to {self.t[-1]:g} s, " if len(self.t) else ""
        return f"<hamel.Motion {span}{len(self.t)} samples, {self.method}{error}>"


def _start(robot: _hamel.Robot, start: State | tuple[ArrayLike, ArrayLike] | None) -> tuple[list[float], list[float], float | None] | None:
    """q, v and time of a start as lists, its shapes checked."""
    if start is None:
        return None
    if isinstance(start, State):
        parts: tuple[Any, Any, Any] = (start.configuration, start.speeds, start.time)
    else:
        try:
            q, v = start
        except (TypeError, ValueError):
            raise ArgumentError(f"start is {start!r}: it must be a State or a pair (q, v)") from None
        parts = (q, v, 0.0)
    sizes = robot.sizes
    q = _vector("start: q", parts[0], sizes.configuration)
    v = _vector("start: v", parts[1], sizes.speeds)
    return q, v, _number("start: time", parts[2])


def _vector(name: str, value: Any, size: int | None = None) -> list[float]:
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{name} is no array of numbers: {error}") from None
    wanted = "(n,)" if size is None else f"({size},)"
    if array.ndim != 1 or size not in (None, array.shape[0]):
        raise ArgumentError(f"{name} has shape {array.shape}: it must have shape {wanted}")
    found: list[float] = array.tolist()
    return found


def _number(name: str, value: Any) -> float | None:
    if value is None:
        return None
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ArgumentError(f"{name} is {value!r}: it must be a number") from None


def _word(name: str, value: Any) -> str | None:
    if value is None or isinstance(value, str):
        return value
    raise ArgumentError(f"{name} is {value!r}: it must be a str")


def simulate(
    robot: _hamel.Robot,
    t_end: float | None = None,
    *,
    start: State | tuple[ArrayLike, ArrayLike] | None = None,
    method: str | None = None,
    tolerance: float | None = None,
    dt: float | None = None,
    accuracy: float | None = None,
    form: str | None = None,
    arithmetic: str | None = None,
    samples: ArrayLike | None = None,
    sample_step: float | None = None,
    inputs: Callable[[float, NDArray[np.float64], NDArray[np.float64]], ArrayLike] | None = None,
    estimate: bool = True,
) -> Motion:
    """Moves a robot, under the controller of its scene if there is one.

    What is not given is as the scene has it; a URDF has 1 s, samples each 0.01 s, and a method that is chosen from the first state.

    Args:
        robot: a ``Robot``.
        t_end: time at which to end, s; a time, not a duration. With ``samples`` alone it is the last of them.
        start: a ``State`` or a pair ``(q, v)`` at time 0, instead of the initial state of the file.
        method: name of a method, such as ``dop853`` or ``radau5``; ``auto`` chooses.
        tolerance: error allowed a step, for methods with step control.
        dt: step, s, for methods without; alone it asks for ``rk4``. Not with ``tolerance``. ``discrete_gradient`` takes either, and steps of 1e-3 s without both.
        accuracy: largest error that the last state shall have; the tolerance is searched for. Not with ``tolerance``, ``dt`` or a method of fixed steps.
        form: ``lagrangian`` or ``hamiltonian``.
        arithmetic: ``doubles``; ``refined``, accelerations by iterative refinement, for light bodies that carry heavy ones; ``auto``, refined where a motion in doubles
            shows that rounding decides its accuracy.
        samples: times at which the state is wanted, s, ascending.
        sample_step: time between samples, s; not with ``samples``.
        inputs: function of time in s, q and v that gives efforts tau, (K,), instead of the controller of the scene; N m and N. It is called for each evaluation of the
            equations of motion, of the estimate too; it may keep no memory, as times go back and forth.
        estimate: whether to estimate the error, which takes about as long again. With ``accuracy``, a motion without an estimate is refused where the accuracy is
            not reached; with one, ``end_error`` tells.

    Returns:
        A ``Motion``.

    Raises:
        ArgumentError: an option out of range, a start of the wrong shape or that the robot cannot take.
        IntegrationError: a motion that does not go on, with the time that it has reached.
        KeyboardInterrupt: Ctrl-C, heard between steps. What ``inputs`` raises ends the motion as well.
    """
    if not isinstance(robot, _hamel.Robot):
        raise ArgumentError(f"robot is {robot!r}: it must be a Robot, from hamel.load")
    if samples is not None and sample_step is not None:
        raise ArgumentError("samples and sample_step are both given: one of them tells the times")
    numbers = {"t_end": t_end, "tolerance": tolerance, "dt": dt, "accuracy": accuracy, "sample_step": sample_step}
    for name, value in numbers.items():
        if isinstance(value, float) and np.isnan(value):
            raise ArgumentError(f"{name} is {value!r}: it must be a number")
    request: dict[str, Any] = {name: _number(name, value) for name, value in numbers.items()}
    request["start"] = _start(robot, start)
    request["method"] = _word("method", method)
    request["form"] = _word("form", form)
    request["arithmetic"] = _word("arithmetic", arithmetic)
    request["samples"] = None if samples is None else _vector("samples", samples)
    if request["samples"] and t_end is None:
        request["t_end"] = request["samples"][-1]
    if inputs is not None and not callable(inputs):
        raise ArgumentError(f"inputs is {inputs!r}: it must be a function of time, q and v")
    request["inputs"] = inputs
    request["estimate"] = bool(estimate)
    found = _hamel.simulate(robot, request)
    energy = found["kinetic_energy"] + found["potential_energy"]
    return Motion(robot=robot, energy=energy, columns=robot._columns, has_inputs=inputs is not None, **found)
