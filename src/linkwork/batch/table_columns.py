"""Columns of a table of designs: in memory, or in a CSV file."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import as_names
from linkwork.foundation.plain_numbers import as_told

__all__ = ["numbers", "read_columns"]


def read_columns(table: object, columns: Sequence[str] | None) -> dict[str, Array]:
    """The columns of a table by name; by default all.

    Parameters
    ----------
    table : DataFrame, structured array, Mapping[str, (n,)], or path of a CSV file with a header

    Raises
    ------
    InputError
        If the table has no columns, a cell is not a number (names its line), or ``columns`` is not
        a list of names.
    UnknownNameError
        If a column does not exist.
    """
    columns = None if columns is None else as_names("the columns", columns)
    if isinstance(table, str | PathLike):
        return _read_csv(Path(table), columns)
    return {name: numbers(name, cells) for name, cells in _pick_columns(table, columns).items()}


def numbers(name: str, cells: object) -> Array:
    """Values of one name as an array of at most one axis."""
    array = np.asarray(cells)
    if array.dtype.kind not in "iuf" or array.ndim > 1:
        raise InputError(f'"{name}" needs a row of numbers, got {as_told(cells)}')
    return array.astype(np.float64)


def _pick_columns(table: Any, columns: Sequence[str] | None) -> dict[str, object]:
    """The columns of a table in memory."""
    if isinstance(table, np.ndarray) and table.dtype.names is not None:
        names = list(table.dtype.names)
    elif isinstance(table, Mapping):
        names = list(table)
    elif hasattr(table, "columns"):
        names = list(table.columns)
    else:
        raise InputError(
            "a table is a DataFrame, a structured array, a mapping of arrays or the path of a CSV "
            f"file, got {type(table).__name__}"
        )
    return {name: table[name] for name in _known(names, columns)}


def _known(names: Sequence[str], columns: Sequence[str] | None) -> Sequence[str]:
    for name in columns or ():
        if name not in names:
            raise UnknownNameError(
                f'the table has no column "{name}" {choices("columns", names, name)}'
            )
    return names if columns is None else columns


def _read_csv(path: Path, columns: Sequence[str] | None) -> dict[str, Array]:
    try:
        # a byte order mark written by spreadsheets is not part of the first name
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file)
            header = [name.strip() for name in next(reader, [])]
            wanted = [(name, header.index(name)) for name in _known(header, columns)]
            found: dict[str, list[float]] = {name: [] for name, _ in wanted}
            for cells in reader:
                if cells:
                    _read_row(path, reader.line_num, cells, header, wanted, found)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path} is not UTF-8 text: save it as CSV in UTF-8") from None
    except ValueError as error:  # no path, such as one with a NUL character
        raise InputError(f"{as_told(str(path))} cannot be read: {error}") from None
    return {name: np.array(values) for name, values in found.items()}


def _read_row(
    path: Path,
    line: int,
    cells: Sequence[str],
    header: Sequence[str],
    wanted: Sequence[tuple[str, int]],
    found: Mapping[str, list[float]],
) -> None:
    if len(cells) != len(header):
        raise InputError(f"{path} line {line} has {len(cells)} cells, the header {len(header)}")
    for name, column in wanted:
        try:
            found[name].append(float(cells[column]))
        except ValueError:
            raise InputError(
                f'{path} line {line}: "{name}" needs a number, got "{cells[column][:40]}"'
            ) from None
