"""Many motions of one scene."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _hamel
from ._errors import ArgumentError


def sweep(
    scene: _hamel.Robot | str | PathLike[str],
    table: Any,
    workers: int | None = None,
    *,
    estimate: bool = True,
    floating_base: bool = False,
) -> dict[str, NDArray[Any]]:
    """Moves a scene once for each row of a table, with the numbers of the row in place of those of its file.

    Args:
        scene: path of a scene in TOML or of a robot in URDF or MJCF, its text, or a ``Robot``.
        table: a dict of arrays, a data frame of pandas or polars, or a table of pyarrow. A column names a number of the scene file by the way to it, keys between dots:
            ``body.arm.mass``, ``body.arm.initial.speeds.1`` (places count from 1), ``controller.frequency``. Of a robot they are those of the scene that ``hamel import`` makes.
        workers: threads; all cores where it is None. No bit depends on them.
        estimate: whether to estimate the errors of motions, which takes about as long again.
        floating_base: whether the root link of a URDF moves freely.

    Returns:
        A dict of arrays with an entry for each row: ``outcome`` (``ended``, ``event NAME``, ``failed: CAUSE``), ``t_s``, ``energy_J``, ``kinetic_energy_J``,
        ``potential_energy_J``, ``steps``, with ``estimate`` also ``error`` and ``error_is_reliable`` (1 or 0), and coordinates and speeds of all joints at the end, such as
        ``elbow.q.q_rad``. Numbers of a row that failed are NaN. The bits are those of ``hamel sweep``.

    Raises:
        FileError: a scene with mistakes as it is written. What a row makes wrong is in its ``outcome``.
        ArgumentError: columns that name no number of the scene; columns that are no arrays of numbers, of one length.
        KeyboardInterrupt: Ctrl-C; there are no results then.
    """
    columns = {str(name): _column(str(name), values) for name, values in _columns(table).items()}
    if not columns:
        raise ArgumentError("table has no columns")
    lengths = {name: len(values) for name, values in columns.items()}
    if len(set(lengths.values())) > 1:
        raise ArgumentError(f"table has columns of different lengths: {lengths}")
    if workers is not None and (not isinstance(workers, int) or isinstance(workers, bool) or workers < 1):
        raise ArgumentError(f"workers is {workers!r}: it must be a whole number of at least 1")
    found = _hamel.sweep(scene, list(columns), list(columns.values()), (workers, bool(estimate), bool(floating_base)))
    found["outcome"] = np.array(found["outcome"], dtype=str)
    return found


def _columns(table: Any) -> Mapping[Any, Any]:
    """The columns by name: of a mapping, or of what tells their names, as pyarrow, pandas and polars do."""
    if isinstance(table, Mapping):
        return table
    for names in ("column_names", "columns"):
        if hasattr(table, names):
            return {name: table[name].to_numpy() for name in getattr(table, names)}
    raise ArgumentError(f"table is {table!r}: it must be a dict of arrays or a data frame")


def _column(name: str, values: Any) -> NDArray[np.float64]:
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"column `{name}` is no array of numbers: {error}") from None
    if array.ndim != 1:
        raise ArgumentError(f"column `{name}` has shape {array.shape}: it must have shape (n,)")
    return array
