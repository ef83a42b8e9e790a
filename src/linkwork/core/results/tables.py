"""Short summaries of results as aligned text and as rows of a table."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

from linkwork.core.foundation.arrays import AnyArray, Array, read_only
from linkwork.core.foundation.errors import internal
from linkwork.core.foundation.loading import installed_with
from linkwork.core.results.quantity import Quantity


@dataclass(frozen=True)
class Summary:
    """A title line and rows of a name and a text; as text, in aligned columns."""

    head: str
    rows: tuple[tuple[str, str], ...]

    def __str__(self) -> str:
        width = max((len(name) for name, _ in self.rows), default=0)
        return "\n".join([self.head, *(f"  {name:<{width}}  {text}" for name, text in self.rows)])


def plain_fields(record: Any, *names: str) -> dict[str, Any]:
    """Some fields of a result as JSON-ready data; members of enumerations by their names."""
    return {name: _plain(getattr(record, name)) for name in names}


def _plain(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    return value.to_dict() if hasattr(value, "to_dict") else value


def driven_text(inputs: Mapping[str, float], units: Mapping[str, str]) -> str:
    """Input values with their units: ``crank = 60 deg``."""
    return ", ".join(f"{name} = {value:.10g} {units[name]}" for name, value in inputs.items())


# ----------------------------------------------------------------------
# A table: named columns with units, one row per input value.


Column = AnyArray

_SHOWN = 6  # columns that ``repr`` names


@dataclass(frozen=True, kw_only=True, repr=False)
class Table:
    """Named columns of equal length, with the unit of each column.

    Parameters
    ----------
    columns : Mapping[str, array (N,)]
        Numbers as float arrays; ``status``, ``branch``, ``limit`` as text; ``certified`` as bool.
    units : Mapping[str, str]
        The unit of every column; "" for none.
    index : str
        The column of the leading input.

    Examples
    --------
    >>> import linkwork as lw
    >>> table = lw.example("four-bar").sweep(from_=0, to=90, step=30).table()
    >>> len(table), table.units["rocker"], round(float(table["rocker"][2]), 3)
    (4, 'deg', 64.943)
    """

    columns: Mapping[str, Column]
    units: Mapping[str, str]
    index: str

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    def __getitem__(self, name: str) -> Column:
        return self.columns[name]

    def __repr__(self) -> str:
        named = [f"{name} [{unit}]" if unit else name for name, unit in self.units.items()]
        shown = ", ".join(named[:_SHOWN]) + (", …" if len(named) > _SHOWN else "")
        return f"<Table of {len(self)} rows over {self.index}, {len(named)} columns: {shown}>"

    def rows(self) -> Iterator[tuple[Any, ...]]:
        """The rows as tuples of plain Python values."""
        return zip(*(column.tolist() for column in self.columns.values()), strict=True)

    def to_pandas(self) -> Any:
        """A pandas DataFrame with the input as index; units in ``attrs["units"]``."""
        with installed_with("tables", "data frames need pandas"):
            import pandas
        frame = pandas.DataFrame(dict(self.columns)).set_index(self.index)
        frame.attrs["units"] = dict(self.units)
        return frame

    def to_xarray(self) -> Any:
        """An xarray Dataset over the input; every variable has ``attrs["units"]``."""
        with installed_with("tables", "labelled arrays need xarray"):
            import xarray
        axis = self.columns[self.index]
        variables = {
            name: (self.index, column, {"units": self.units[name]})
            for name, column in self.columns.items()
            if name != self.index
        }
        coordinates = {self.index: (self.index, axis, {"units": self.units[self.index]})}
        return xarray.Dataset(variables, coords=coordinates)


# ----------------------------------------------------------------------
# Tables as CSV: UTF-8, ``%.17g``, lower-case true and false, empty cells for missing numbers.
#
# Texts that a spreadsheet would calculate begin with an apostrophe.


#: What formulas of spreadsheets begin with.
_FORMULAS = ("=", "+", "-", "@", "\t", "\r")


def csv_lines(table: Table) -> Iterator[str]:
    """The lines of the table, header first, each with a newline."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")

    def line(cells: list[str]) -> str:
        buffer.seek(0)
        buffer.truncate()
        writer.writerow(cells)
        return buffer.getvalue()

    yield line(list(table.columns))
    for row in table.rows():
        yield line([_cell(value) for value in row])


def csv_text(table: Table) -> str:
    """The whole table as text."""
    return "".join(csv_lines(table))


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        # a zero has no sign in a table
        return "" if math.isnan(value) else f"{value + 0.0:.17g}"
    text = str(value)
    formula = isinstance(value, str) and text.startswith(_FORMULAS)
    return f"'{text}" if formula else text


# ----------------------------------------------------------------------
# One quantity over the rows of a motion.


@internal("quantity")
@dataclass(frozen=True, kw_only=True, eq=False)
class Series:
    """One quantity over the N rows of a motion.

    Parameters
    ----------
    quantity : Quantity
        Its name and kind.
    value : array (N,)
        Values in file units.
    first, second : array (N,)
        Derivatives with respect to the leading input; angles in radians.

    Examples
    --------
    >>> import linkwork as lw
    >>> motion = lw.example("four-bar").sweep(from_=0, to=90, step=30)
    >>> series = motion.unknowns["rocker"]
    >>> series.quantity.name, series.first.round(3)
    ('rocker', array([-0.667,  0.122,  0.457,  0.539]))
    """

    quantity: Quantity
    value: Array
    first: Array
    second: Array

    def __post_init__(self) -> None:
        for field in ("value", "first", "second"):
            object.__setattr__(self, field, read_only(getattr(self, field)))
