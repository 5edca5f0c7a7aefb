"""Tables in Parquet files, in pieces. Of a file only what it says of itself is read here; numbers are read piece by piece, wherever they are needed."""

from __future__ import annotations

import importlib
import os
from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from ._errors import ArgumentError, FileError

_ENDINGS = (".parquet", ".pq")


class Group(NamedTuple):
    """A group of rows of a file."""

    path: str
    number: int
    """Among those of the file, from 0."""
    rows: int


class Table(NamedTuple):
    """A table in files."""

    columns: list[str]
    groups: list[Group]

    @property
    def rows(self) -> int:
        """How many there are."""
        return sum(group.rows for group in self.groups)

    def pieces(self, most: int) -> Iterator[dict[str, Any]]:
        """Parts of groups with at most so many rows; ``first`` is the place of the first of them in the table, from 1."""
        first = 1
        for path, number, rows in self.groups:
            for start in range(0, rows, most):
                count = min(most, rows - start)
                yield {"path": path, "group": number, "start": start, "count": count, "first": first}
                first += count


def opened(files: str | PathLike[str] | Sequence[str | PathLike[str]]) -> Table:
    """The table in a file, in files one after the other, or in a folder of them, by name.

    Raises:
        FileError: a file that cannot be read.
        ArgumentError: files with other columns than the first; columns that do not hold numbers.
    """
    paths = [files] if isinstance(files, (str, PathLike)) else list(files)
    columns: list[str] = []
    groups: list[Group] = []
    for path in (found for given in paths for found in _files(address(given))):
        footer = _footer(path)
        names = [str(name) for name in footer.schema.to_arrow_schema().names]
        if columns and set(names) != set(columns):
            raise ArgumentError(f"{path} has the columns {names}, and the files before it {columns}")
        columns = columns or names
        _check_columns(path, footer.schema.to_arrow_schema())
        groups += [Group(path, number, footer.row_group(number).num_rows) for number in range(footer.num_row_groups)]
    return Table(columns, groups)


def read(piece: dict[str, Any], columns: list[str]) -> Any:
    """The rows of a piece as a table of pyarrow."""
    system, path = _system(piece["path"])
    with system.open_input_file(path) as file:
        group = _parquet().ParquetFile(file).read_row_group(piece["group"], columns=columns)
    return group.slice(piece["start"], piece["count"])


def rows(table: Table, places: list[int]) -> Iterator[Any]:
    """Rows by their places from 0, which ascend, as tables of pyarrow. Each group that holds some of them is read once."""
    first = 0
    for path, number, count in table.groups:
        inside = [place - first for place in places if first <= place < first + count]
        if inside:
            yield read({"path": path, "group": number, "start": 0, "count": count}, table.columns).take(inside)
        first += count


def rows_in(folder: str) -> int:
    """Rows of all Parquet files in a folder."""
    return sum(_footer(path).num_rows for path in _files(folder))


def address(path: str | PathLike[str]) -> str:
    """An address such as ``s3://…`` as it is, a path as it is from the root."""
    text = os.fspath(path)
    return text if "://" in text else str(Path(text).expanduser().absolute())


def is_empty(folder: str) -> bool:
    """Whether nothing stands in a folder, or there is none."""
    system, path = _system(folder)
    return not system.get_file_info(_selector(path))


def write_text(folder: str, name: str, text: str) -> None:
    """Writes a file into a folder, which is made."""
    system, path = _system(folder)
    system.create_dir(path, recursive=True)
    with system.open_output_stream(f"{path}/{name}") as file:
        file.write(text.encode())


def _parquet() -> Any:
    return importlib.import_module("pyarrow.parquet")


def _system(where: str) -> tuple[Any, str]:
    """The file system of an address, and the path in it."""
    systems: Any = importlib.import_module("pyarrow.fs")
    system, path = systems.FileSystem.from_uri(where) if "://" in where else (systems.LocalFileSystem(), where)
    return system, str(path)


def _selector(path: str) -> Any:
    systems: Any = importlib.import_module("pyarrow.fs")
    return systems.FileSelector(path, allow_not_found=True, recursive=True)


def _files(where: str) -> list[str]:
    """A file itself; of a folder the Parquet files in it, by name."""
    system, path = _system(where)
    systems: Any = importlib.import_module("pyarrow.fs")
    kind = system.get_file_info(path).type
    if kind == systems.FileType.NotFound:
        raise FileError(f"cannot read {where}: it is not there", source=where)
    if kind != systems.FileType.Directory:
        return [where]
    inside = (info.path for info in system.get_file_info(_selector(path)) if info.type == systems.FileType.File)
    found = sorted(own for own in inside if own.endswith(_ENDINGS))
    if not found:
        raise FileError(f"cannot read {where}: it holds no files that end in .parquet or .pq", source=where)
    return [where[: len(where) - len(path)] + own for own in found] if "://" in where else found


def _footer(where: str) -> Any:
    """What a file says of itself."""
    system, path = _system(where)
    try:
        with system.open_input_file(path) as file:
            return _parquet().read_metadata(file)
    except (OSError, ValueError) as error:
        raise FileError(f"cannot read {where}: {error}", source=where) from None


def _check_columns(path: str, schema: Any) -> None:
    types: Any = importlib.import_module("pyarrow").types
    others = [f"column `{own.name}` holds {own.type}, and must hold numbers" for own in schema if not (types.is_floating(own.type) or types.is_integer(own.type))]
    if others:
        raise ArgumentError("\n".join([f"{path}:", *others] if len(others) > 1 else [f"{path}: {others[0]}"]))
