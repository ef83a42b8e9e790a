"""A table: named columns with units, one row per input value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from linkwork.foundation.arrays import AnyArray
from linkwork.foundation.optional_packages import installed_with

__all__ = ["Column", "Table"]

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
    >>> table = lw.example("four-bar").sweep(start=0, stop=90, step=30).table()
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
