"""A table: named columns with units, one row per input value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwork.foundation.arrays import AnyArray
from linkwork.foundation.errors import MissingPackageError
from linkwork.results.quantity import Rate

if TYPE_CHECKING:
    from linkwork.results.motion import Motion, Series

__all__ = ["Table", "table_of"]

Column = AnyArray

_SHOWN = 6  # columns that ``repr`` names


@dataclass(frozen=True, kw_only=True, repr=False)
class Table:
    """Columns by name, all of one length, with the unit of each ("" for none).

    Numbers are float arrays; ``status``, ``branch``, ``limit`` arrays of text; ``certified`` of
    bool.
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
        try:
            import pandas
        except ImportError:
            raise MissingPackageError(
                'data frames need pandas: pip install "linkwork[tables]"'
            ) from None
        frame = pandas.DataFrame(dict(self.columns)).set_index(self.index)
        frame.attrs["units"] = dict(self.units)
        return frame

    def to_xarray(self) -> Any:
        """An xarray Dataset over the input; every variable has ``attrs["units"]``."""
        try:
            import xarray
        except ImportError:
            raise MissingPackageError(
                'labelled arrays need xarray: pip install "linkwork[tables]"'
            ) from None
        axis = self.columns[self.index]
        variables = {
            name: (self.index, column, {"units": self.units[name]})
            for name, column in self.columns.items()
            if name != self.index
        }
        coordinates = {self.index: (self.index, axis, {"units": self.units[self.index]})}
        return xarray.Dataset(variables, coords=coordinates)


def table_of(motion: Motion, names: Sequence[str] = ()) -> Table:
    """Columns of a motion: inputs, unknowns, points, outputs, derivatives, rates, evidence.

    ``<name>.d1`` and ``.d2`` are derivatives by the (first) input with angles in radians;
    ``.velocity`` and ``.acceleration`` appear when the input has a speed.

    Parameters
    ----------
    names : sequence of str
        Only these quantities and rates, behind the inputs and before the status.

    Raises
    ------
    UnknownNameError
        With the nearest names.
    """
    units = motion.units
    columns: dict[str, Column] = {}
    unit_of: dict[str, str] = {}

    def add(name: str, values: Column, unit: str) -> None:
        columns[name], unit_of[name] = values, unit

    for name, values in motion.inputs.items():
        add(name, values, motion.input_units[name])
    if names:
        for quantity in map(motion.quantity, names):
            add(quantity.name, motion[quantity.name], quantity.unit)
        add("status", np.array([status.name for status in motion.status]), "")
        return Table(columns=columns, units=unit_of, index=next(iter(motion.inputs)))
    everything: dict[str, Series] = dict(motion.unknowns)
    everything |= {link: motion.links[link] for link in motion.riding}
    for x, y in motion.points.values():
        everything[x.quantity.name], everything[y.quantity.name] = x, y
    everything |= motion.outputs
    for name, series in everything.items():
        add(name, series.value, units.of(series.quantity.kind))
    asked = [rate for rate in Rate if not (rate.by_time and motion.speed is None)]
    for pair in (asked[:2], asked[2:]):
        for name, series in everything.items():
            kind = series.quantity.kind
            for rate in pair:
                values = rate.of(series.first, series.second, motion.speed)
                unit = rate.unit(kind, units, motion.derivative_unit)
                add(f"{name}.{rate.value}", values, unit)
    add("status", np.array([status.name for status in motion.status]), "")
    add("residual", motion.residual, "")
    add("iterations", motion.iterations, "")
    add("condition", motion.condition, "")
    add("certified", motion.certified, "")
    add("branch", np.array(motion.branch, dtype=str), "")
    add("limit", np.array(motion.limit, dtype=str), "")
    return Table(columns=columns, units=unit_of, index=next(iter(motion.inputs)))
