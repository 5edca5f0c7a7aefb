"""Sweeps on a cluster. Ray Data reads the rows, hands them to actors that hold the scene, starts actors again that die, and writes the results; here stands what it does so with."""

from __future__ import annotations

import contextlib
import importlib
import json
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _hamel, _parquet
from ._errors import ArgumentError, Error
from ._level import LEVELS, lowest
from ._sweep import Options, made, numbers, rows_at

# Rows that an actor moves at once, which are done again where it dies: as many parts as this, of so many rows at least, and at most: one by one, and side by side, which takes seconds either way.
_PARTS, _LEAST = 64, 100
_MOST_BY_TREE, _MOST_IN_LANES = 5_000, 100_000

# Numbers of the results of a part at most: with many samples parts have fewer rows.
_MOST_NUMBERS = 10_000_000

# Parts that go into one file: to start what writes it takes longer than to write.
_FILE = 4

# What says in the output what was swept.
_MANIFEST = "sweep.json"

_INSTALL = "pip install 'ray[data]>=2.60'"


@dataclass(frozen=True)
class Request:
    """What is to be swept, except for the table."""

    scene: Callable[[], tuple[str, str]]
    """Its text, and what messages call it."""
    workers: int | None
    options: Options
    level: str | None


class Fixed(NamedTuple):
    """What all actors of a sweep have in common."""

    version: str
    """Of the package."""
    level: str
    """Of instructions."""
    sum: str
    """Of the bits of mathematical functions."""


class Rows(NamedTuple):
    """Rows of a table, numbered, as Ray Data has them."""

    columns: list[str]
    total: int
    """How many there are."""
    dataset: Callable[[int], Any]
    """Of tables of pyarrow with so many rows at most: ``row``, from 1, and the columns."""
    at: Callable[[list[int]], list[list[float]]]
    """Some of them, by their places from 0."""


def sweep(request: Request, table: Any, output: str | PathLike[str] | None) -> dict[str, NDArray[Any]] | None:
    """What ``hamel.sweep`` tells of ``engine="ray"``."""
    ray = _ray()
    folder = None if output is None else _parquet.address(output)
    if folder is not None and not _parquet.is_empty(folder):
        raise ArgumentError(f"output is {folder}, which holds files: name a folder of its own for the results")
    rows = _rows(ray, table)
    swept = made(request.scene(), rows.columns, request.options, rows.total, rows.at)
    fixed, environment = _fixed(ray, request.level)
    part = _part(rows.total, swept)
    results = rows.dataset(part).map_batches(
        Actor,
        batch_size=None,
        batch_format="pyarrow",
        fn_constructor_args=(swept, fixed),
        compute=_pool(ray, request.workers),
        num_cpus=1,
        **({"runtime_env": {"env_vars": environment}} if environment else {}),
    )
    with _errors(ray):
        if folder is None:
            return _gathered(results, rows.total, swept.results)
        _write(results, folder, _told(request, swept, fixed, rows), part, _nodes(ray))
    return None


class Actor:
    """Moves rows in a process of its own, which has one core."""

    def __init__(self, swept: _hamel.Sweep, fixed: Fixed) -> None:
        own = _own()
        if own != fixed:
            raise Error(f"an actor is {_shown(own)}, and the sweep {_shown(fixed)}: bits of results would depend on the node")
        self.swept = swept

    def __call__(self, rows: Any) -> Any:
        """The results of rows, which have their numbers."""
        found = self.swept.rows([_doubles(rows[name]) for name in self.swept.columns], 1)
        return _arrow().table({"row": rows["row"], **found})


def _ray() -> Any:
    """Ray, connected to a cluster."""
    try:
        ray = importlib.import_module("ray")
        importlib.import_module("ray.data")
    except ImportError as error:
        raise Error(f"engine is 'ray', and Ray is not installed ({error}): {_INSTALL}") from None
    if not ray.is_initialized():
        # A cluster that the environment names, or one of this machine.
        ray.init(ignore_reinit_error=True, logging_level="ERROR", log_to_driver=False)
    return ray


def _arrow() -> Any:
    return importlib.import_module("pyarrow")


@contextlib.contextmanager
def _errors(ray: Any) -> Iterator[None]:
    """What happens on the cluster, as exceptions of this package."""
    try:
        yield
    except ray.exceptions.RayError as error:
        cause = getattr(error, "cause", None) or error
        raise cause if isinstance(cause, Error) else Error(f"the sweep by Ray has failed: {cause}") from error


def _pool(ray: Any, workers: int | None) -> Any:
    """As many actors as there are to be, or as the cluster has room for."""
    if workers is not None:
        return ray.data.ActorPoolStrategy(size=workers)
    cores = int(ray.cluster_resources().get("CPU", 1))
    return ray.data.ActorPoolStrategy(min_size=1, max_size=max(1, cores))


def _nodes(ray: Any) -> int:
    """How many there are now."""
    return max(1, len([node for node in ray.nodes() if node["Alive"]]))


# The level of instructions


def _own() -> Fixed:
    """What this process has."""
    from . import __version__

    return Fixed(__version__, *_hamel.arithmetic())


def _shown(fixed: Fixed) -> str:
    return f"hamel {fixed.version} at {fixed.level} (sum {fixed.sum})"


def _fixed(ray: Any, level: str | None) -> tuple[Fixed, dict[str, str]]:
    """What all nodes have in common, and the environment in which their processes have it."""
    found = _of_nodes(ray, {})
    versions = {own.version for own in found.values()}
    if versions != {_own().version}:
        raise Error(f"nodes have other versions of hamel than this process, {_own().version}: {_listed(found)}")
    common = lowest({own.level for own in found.values()})
    if common is None:
        raise Error(f"nodes have processors of different kinds, which have no level of instructions in common: {_listed(found)}")
    if level is not None and level != common:
        if level != lowest({level, common}):
            raise ArgumentError(f"level is {level!r}, and not all nodes have it: {_listed(found)}")
        common = level
    environment: dict[str, str] = {}
    if {own.level for own in found.values()} != {common}:
        environment = LEVELS[common]
        found = _of_nodes(ray, environment)
    if len(set(found.values())) > 1:
        raise Error(f"nodes compute otherwise, by another C library or build of hamel: {_listed(found)}")
    return next(iter(found.values())), environment


def _of_nodes(ray: Any, environment: dict[str, str]) -> dict[str, Fixed]:
    """What a process of each node has that begins with this environment, by the node's address."""
    strategies: Any = importlib.import_module("ray.util.scheduling_strategies")
    started = {"runtime_env": {"env_vars": environment}} if environment else {}
    nodes = [node for node in ray.nodes() if node["Alive"] and node["Resources"].get("CPU", 0) >= 1]
    own = ray.remote(num_cpus=0)(_own)
    asked = []
    for node in nodes:
        there = strategies.NodeAffinitySchedulingStrategy(node["NodeID"], soft=False)
        asked.append(own.options(scheduling_strategy=there, **started).remote())
    with _errors(ray):
        found = ray.get(asked)
    return {f"{node['NodeManagerAddress']} ({node['NodeID'][:8]})": Fixed(*own) for node, own in zip(nodes, found, strict=True)}


def _listed(found: dict[str, Fixed]) -> str:
    return "; ".join(f"{node} has {_shown(own)}" for node, own in found.items())


# Tables


def _rows(ray: Any, table: Any) -> Rows:
    """The rows of whatever is a table, numbered."""
    if isinstance(table, ray.data.Dataset):
        return _rows_of_dataset(ray, table)
    if isinstance(table, (str, PathLike)) or (isinstance(table, Sequence) and all(isinstance(own, (str, PathLike)) for own in table)):
        return _rows_of_files(ray, _parquet.opened(table))
    return _rows_of_memory(ray, table)


def _rows_of_files(ray: Any, table: _parquet.Table) -> Rows:
    """Those of files: what is handed out is where they stand."""
    if not table.columns:
        raise ArgumentError("table has no columns")
    def read(pieces: Any) -> Any:
        [piece] = pieces.to_pylist()
        return _with_numbers(_parquet.read(piece, table.columns), piece["first"])

    def dataset(most: int) -> Any:
        places = [_arrow().Table.from_pylist([piece]) for piece in table.pieces(most)]
        # A reader for each node is enough: motions take far longer.
        readers = ray.data.TaskPoolStrategy(size=_nodes(ray))
        return ray.data.from_arrow(places).map_batches(read, batch_size=1, batch_format="pyarrow", num_cpus=0, compute=readers)

    def at(places: list[int]) -> list[list[float]]:
        return [_cells(rows, place, table.columns) for rows in _parquet.rows(table, places) for place in range(len(rows))]

    return Rows(table.columns, table.rows, dataset, at)


def _rows_of_memory(ray: Any, table: Any) -> Rows:
    columns = numbers(table)
    count = len(next(iter(columns.values())))

    def dataset(most: int) -> Any:
        whole = _arrow().table(columns)
        return ray.data.from_arrow([_with_numbers(whole.slice(start, most), start + 1) for start in range(0, count, most)])

    return Rows(list(columns), count, dataset, partial(rows_at, columns))


def _rows_of_dataset(ray: Any, table: Any) -> Rows:
    """Those of a dataset, in its order: it is held by the cluster, not here, until all of its blocks are counted."""
    options = table.context.execution_options
    before, options.preserve_order = options.preserve_order, True
    try:
        held = table.materialize()
    finally:
        options.preserve_order = before
    blocks = held.to_arrow_refs()
    count, number = ray.remote(num_cpus=0)(_count), ray.remote(num_cpus=0)(_with_numbers)
    counts = ray.get([count.remote(block) for block in blocks])
    # Places of the first rows of blocks, from 0, and how many rows there are.
    *firsts, total = np.cumsum([0, *counts]).tolist()

    def dataset(most: int) -> Any:
        numbered = [number.remote(block, first + 1) for block, first in zip(blocks, firsts, strict=True)]
        return ray.data.from_arrow_refs(numbered).repartition(target_num_rows_per_block=most)

    schema = held.schema()
    if schema is None:
        raise ArgumentError("table has no columns")
    columns = [str(name) for name in schema.names]

    def at(places: list[int]) -> list[list[float]]:
        inside = [bisect_right(firsts, place) - 1 for place in places]
        cells = ray.remote(num_cpus=0)(_cells)
        found: list[list[float]] = ray.get([cells.remote(blocks[block], place - firsts[block], columns) for block, place in zip(inside, places, strict=True)])
        return found

    return Rows(columns, total, dataset, at)


def _part(rows: int, swept: _hamel.Sweep) -> int:
    """Rows that are moved at once."""
    most = _MOST_IN_LANES if swept.why_tree is None else _MOST_BY_TREE
    most = min(most, max(_LEAST, _MOST_NUMBERS // len(swept.results)))
    return min(max(rows // _PARTS, _LEAST), most)


def _count(table: Any) -> int:
    return len(table)


def _with_numbers(table: Any, first: int) -> Any:
    """The rows of a table of pyarrow with their places in the whole table."""
    return table.append_column("row", _arrow().array(np.arange(first, first + len(table))))


def _cells(table: Any, place: int, columns: list[str]) -> list[float]:
    """A row of a table of pyarrow."""
    row = table.slice(place, 1)
    return [float(_doubles(row[name])[0]) for name in columns]


def _doubles(column: Any) -> NDArray[np.float64]:
    return np.array(column.to_numpy(), dtype=float)


# Results


def _gathered(results: Any, count: int, names: list[str]) -> dict[str, NDArray[Any]]:
    """Results in the order of the table."""
    outcomes = np.full(count, None, dtype=object)
    found = {name: np.full(count, np.nan) for name in names}
    batches = results.iter_batches(batch_size=None, batch_format="pyarrow") if count > 0 else ()
    for some in batches:
        places = some["row"].to_numpy() - 1
        outcomes[places] = some["outcome"].to_pylist()
        for name, values in found.items():
            values[places] = some[name].to_numpy()
    _check_count(count - sum(outcome is None for outcome in outcomes), count)
    return {"outcome": np.array(outcomes, dtype=str), **found}


def _write(results: Any, folder: str, told: dict[str, Any], part: int, nodes: int) -> None:
    """Results in parts as files, by one writer for each node, and what was swept: first, and again when all of them are there."""
    _parquet.write_text(folder, _MANIFEST, _json({**told, "is_complete": False}))
    if told["rows"] > 0:
        results.write_parquet(folder, ray_remote_args={"num_cpus": 0}, concurrency=nodes, min_rows_per_file=_FILE * part)
    _check_count(_parquet.rows_in(folder), told["rows"])
    _parquet.write_text(folder, _MANIFEST, _json({**told, "is_complete": True}))


def _check_count(found: int, expected: int) -> None:
    if found != expected:
        raise Error(f"the sweep by Ray has {found} results, and the table {expected} rows")


def _told(request: Request, swept: _hamel.Sweep, fixed: Fixed, rows: Rows) -> dict[str, Any]:
    """What decides on the results."""
    estimate, equations, times = request.options
    return {
        "version": fixed.version,
        "engine": "ray",
        "equations": equations,
        # Why no row moved side by side; none where rows did that could.
        "why_tree": swept.why_tree,
        "level": fixed.level,
        "sum_of_functions": fixed.sum,
        "error_estimate": estimate,
        "samples": times,
        "rows": rows.total,
        "columns": rows.columns,
        "scene": {"name": swept.source, "text": swept.text},
    }


def _json(told: dict[str, Any]) -> str:
    return json.dumps(told, indent=2, ensure_ascii=False) + "\n"
