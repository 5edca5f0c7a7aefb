"""Many motions of one scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from numbers import Real
from operator import index
from os import PathLike
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _hamel
from ._errors import ArgumentError
from ._level import LEVELS, check_level


@overload
def sweep(
    scene: _hamel.Robot | str | PathLike[str],
    table: Any,
    workers: int | None = None,
    *,
    estimate: bool = True,
    floating_base: bool = False,
    level: str | None = None,
    equations: Literal["auto", "lanes", "tree"] = "auto",
    at: ArrayLike = (),
    engine: Literal["ray"] | None = None,
    output: None = None,
) -> dict[str, NDArray[Any]]: ...


@overload
def sweep(
    scene: _hamel.Robot | str | PathLike[str],
    table: Any,
    workers: int | None = None,
    *,
    estimate: bool = True,
    floating_base: bool = False,
    level: str | None = None,
    equations: Literal["auto", "lanes", "tree"] = "auto",
    at: ArrayLike = (),
    engine: Literal["ray"],
    output: str | PathLike[str],
) -> None: ...


def sweep(
    scene: _hamel.Robot | str | PathLike[str],
    table: Any,
    workers: int | None = None,
    *,
    estimate: bool = True,
    floating_base: bool = False,
    level: str | None = None,
    equations: Literal["auto", "lanes", "tree"] = "auto",
    at: ArrayLike = (),
    engine: Literal["ray"] | None = None,
    output: str | PathLike[str] | None = None,
) -> dict[str, NDArray[Any]] | None:
    """Moves a scene once for each row of a table, with the numbers of the row in place of those of its file.

    Args:
        scene: path of a scene in TOML or of a robot in URDF, MJCF or SDF, its text, or a ``Robot``.
        table: a dict of arrays, a data frame of pandas or polars, or a table of pyarrow. A column names a number of the scene file by the way to it, keys between dots:
            ``body.arm.mass``, ``body.arm.initial.speeds.1`` (places count from 1), ``controller.frequency``. Of a robot they are those of the scene that ``hamel import`` makes.
            With ``engine="ray"`` also a Parquet file, a list of such files, a folder of them (in the order of their names), as paths or addresses such as ``s3://…``, or a ``ray.data.Dataset``.
        workers: threads; all cores where it is None. With ``engine="ray"`` actors of one core each; as many as the cluster has cores where it is None. No bit depends on them.
        estimate: whether to estimate the errors of motions, which takes about as long again.
        floating_base: whether the root link of a URDF moves freely.
        level: instructions to compute by, on which last bits depend: ``x86-64-v3`` or ``x86-64``, which has no fused products; other processors have one level. Where it is None, that of this
            process, and with ``engine="ray"`` the lowest of the nodes.
        equations: ``"auto"`` moves many rows side by side, in a fraction of the time, where scene and rows allow it, as ``hamel sweep`` does; that takes ``estimate=False`` and steps of fixed size.
            ``"lanes"`` refuses a sweep of which no row can. ``"tree"`` moves rows one by one; results differ from those side by side by rounding.
        at: times of samples, s, ascending: coordinates and speeds of all joints at these times too, such as ``elbow.q.q_rad@0.5``. They are NaN in rows whose motion ends before.
        engine: ``"ray"`` moves rows on the cluster that Ray is connected to, or on one of this machine that it starts. None moves them in this process.
        output: with ``engine="ray"``, a folder that is empty or is not there, on storage that all nodes share. Results are written there as Parquet files, in no order, and ``sweep.json`` says what
            was swept at which level of instructions. None gathers the results here.

    Returns:
        A dict of arrays with an entry for each row: ``outcome`` (``ended``, ``event NAME``, ``failed: CAUSE``), ``t_s``, ``energy_J``, ``kinetic_energy_J``,
        ``potential_energy_J``, ``steps``, with ``estimate`` also ``error`` and ``error_is_reliable`` (1 or 0), and coordinates and speeds of all joints at the end, such as
        ``elbow.q.q_rad``. Numbers of a row that failed are NaN. The bits are those of ``hamel sweep`` with the same equations. With an ``output`` the files have these columns after ``row``, the place of the row in the table,
        from 1.

    Raises:
        FileError: a scene with mistakes as it is written; a table that cannot be read. What a row makes wrong is in its ``outcome``.
        ArgumentError: columns that name no number of the scene; times that are not in order, or after the end of the motion; ``equations="lanes"`` where no row can move so; columns that are no arrays of numbers, of one length; a level that a node does not have; an ``output`` that holds files.
        Error: Ray is not installed; nodes with another version of hamel, or that compute otherwise; a cluster that fails for good.
        KeyboardInterrupt: Ctrl-C; there are no results then.
    """
    workers = _count(workers)
    options = (bool(estimate), str(equations), _array("at", at).tolist())
    if level is not None and level not in LEVELS:
        raise ArgumentError(f"level is {level!r}: it must be one of {', '.join(LEVELS)}")
    if engine == "ray":
        from . import _ray

        request = _ray.Request(lambda: _hamel.scene_text(scene, bool(floating_base)), workers, options, level)
        return _ray.sweep(request, table, output)
    if engine is not None:
        raise ArgumentError(f"engine is {engine!r}: it must be None or 'ray'")
    if output is not None:
        raise ArgumentError("output is for engine='ray': without it results are returned")
    columns = numbers(table)
    check_level(level)
    swept = made(_hamel.scene_text(scene, bool(floating_base)), list(columns), options, len(next(iter(columns.values()))), partial(rows_at, columns))
    found = swept.rows(list(columns.values()), workers)
    found["outcome"] = np.array(found["outcome"], dtype=str)
    return found


Options = tuple[bool, str, list[float]]
"""Whether errors are estimated, by which equations rows move, and times of samples."""


def made(scene: tuple[str, str], columns: list[str], options: Options, rows: int, at: Callable[[list[int]], list[list[float]]]) -> _hamel.Sweep:
    """The sweep of a table of so many rows, of which ``at`` gives some by their places from 0."""
    estimate, equations, _ = options
    goes_by_tree = estimate or equations == "tree"
    return _hamel.Sweep(scene, columns, options, [] if goes_by_tree else at(_hamel.sample(rows)))


def rows_at(columns: Mapping[str, NDArray[np.float64]], places: list[int]) -> list[list[float]]:
    """Rows of a table in memory."""
    return [[float(values[place]) for values in columns.values()] for place in places]


# More threads than this no machine has.
_MOST_WORKERS = 65536


def _count(workers: Any) -> int | None:
    """The number of workers as Python's own; ``None`` stays."""
    if workers is None:
        return None
    try:
        count = None if isinstance(workers, (bool, np.bool_)) else index(workers)
    except TypeError:
        count = None
    if count is None or not 1 <= count <= _MOST_WORKERS:
        raise ArgumentError(f"workers is {workers!r}: it must be a whole number from 1 to {_MOST_WORKERS}")
    return count


def numbers(table: Any) -> dict[str, NDArray[np.float64]]:
    """The columns of a table in memory by name, as doubles.

    Raises:
        ArgumentError: what is no table; columns that are no arrays of numbers, of one length.
    """
    columns: dict[str, NDArray[np.float64]] = {}
    for key, values in _columns(table).items():
        name = str(key)
        if name in columns:
            raise ArgumentError(f"table has two columns `{name}`")
        columns[name] = _array(f"column `{name}`", values)
    if not columns:
        raise ArgumentError("table has no columns")
    lengths = {name: len(values) for name, values in columns.items()}
    if len(set(lengths.values())) > 1:
        raise ArgumentError(f"table has columns of different lengths: {lengths}")
    return columns


def _columns(table: Any) -> Mapping[Any, Any]:
    """The columns by name: of a mapping, or of what tells their names, as pyarrow, pandas and polars do."""
    if isinstance(table, Mapping):
        return table
    for names in ("column_names", "columns"):
        if hasattr(table, names):
            keys = list(getattr(table, names))
            twice = [name for place, name in enumerate(keys) if name in keys[:place]]
            if twice:
                raise ArgumentError(f"table has two columns `{twice[0]}`")
            return {name: table[name].to_numpy() for name in keys}
    raise ArgumentError(f"table is {table!r}: it must be a dict of arrays or a data frame")


def _array(what: str, values: Any) -> NDArray[np.float64]:
    # Conversion to doubles alone would read texts, dates and complex numbers, and what a mask hides.
    if np.ma.is_masked(values):
        raise ArgumentError(f"{what} has masked values: fill them, or leave the rows out")
    try:
        found = np.asarray(values)
        if found.dtype.kind not in "biufO":
            raise TypeError(f"its values are of type {found.dtype}")
        if found.dtype.kind == "O":
            found = np.array([_number(value) for value in found.flat]).reshape(found.shape)
        array = np.array(found, dtype=float)
    except (TypeError, ValueError, OverflowError) as error:
        raise ArgumentError(f"{what} is no array of numbers: {error}") from None
    if array.ndim != 1:
        raise ArgumentError(f"{what} has shape {array.shape}: it must have shape (n,)")
    return array


def _number(value: Any) -> float:
    """A number among Python objects; NaN where there is none."""
    if value is None:
        return np.nan
    if not isinstance(value, (Real, np.bool_)):
        raise TypeError(f"{value!r} is of type {type(value).__name__}")
    return float(value)
