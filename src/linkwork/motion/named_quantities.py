"""The quantities of the rows of a motion by name, in the units of its file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.expression.jets import Jet
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.foundation.frozen import ComputedDict
from linkwork.motion.model import Model
from linkwork.motion.quantity_values import QuantityValues
from linkwork.results.series import Series

__all__ = ["Named", "RowValues", "name_series"]


@dataclass(frozen=True, kw_only=True)
class Named:
    """All quantities of a batch of positions by name; each is computed when it is asked for."""

    inputs: dict[str, Array]
    unknowns: Mapping[str, Series]
    links: Mapping[str, Series]
    sliders: Mapping[str, Series]
    points: Mapping[str, tuple[Series, Series]]
    outputs: Mapping[str, Series]


class RowValues(QuantityValues):
    """Quantities of B rows; rows that were not found are NaN.

    Parameters
    ----------
    v, first, second : (B, N)
        Variables with their derivatives by the leading input, internal units.
    found : (B,)
    """

    def __init__(
        self, model: Model, v: Array, first: Array, second: Array, found: BoolArray
    ) -> None:
        lost = ~found
        angles = np.array([angle.constant for angle in model.equations.links.values()])
        numbers = np.array(list(model.equations.dimensions.values()), dtype=float)
        super().__init__(model, lost, np.where(lost, np.nan, 0.0), angles, numbers)
        self.columns = [np.where(lost[:, None], np.nan, part) for part in (v, first, second)]
        self.number = {x.symbol: k for k, x in enumerate(self.equations.variables)}

    def variable(self, symbol: str) -> Jet:
        """A variable by its symbol, internal units, (B,)."""
        k = self.number[symbol]
        return Jet(*(part[:, k] for part in self.columns))

    def place(self, point: str) -> Jet:
        """A point by its exact name, (B,)."""
        number, parts = self._places
        return Jet(*(part[:, number[point]] for part in parts))

    @cached_property
    def _places(self) -> tuple[dict[str, int], tuple[ComplexArray, ...]]:
        """All points at once, which takes little longer than one: numbers, (B, points) each."""
        table = self.model.compiled.points
        return {name: k for k, name in enumerate(table.names)}, table.jet(*self.columns)

    def series(self, name: str) -> Series:
        """A quantity of every row by its name.

        Raises
        ------
        UnknownNameError
            With the nearest names.
        """
        asked = self.model.quantities.find(name)
        jet = asked.jet(self)
        return Series(quantity=asked.own, value=jet.v, first=jet.d1, second=jet.d2)


def name_series(
    model: Model,
    v: Array,
    first: Array,
    second: Array,
    inputs: Array,
    found: BoolArray,
) -> Named:
    """Name the columns of a batch; rows that were not found become NaN.

    Parameters
    ----------
    v, first, second : (B, N)
        Variables with their derivatives by the leading input, internal units.
    inputs : (B, p)
        The input values asked for, file units (they may differ from ``v`` by whole turns).
    """
    values = RowValues(model, v, first, second, found)
    names = model.quantities.names
    columns = enumerate(model.equations.inputs)
    return Named(
        inputs={variable.name: inputs[:, k] for k, variable in columns},
        unknowns=ComputedDict(names.unknowns, values.series),
        links=ComputedDict(names.links, values.series),
        sliders=ComputedDict(names.sliders, values.series),
        points=ComputedDict(
            names.points, lambda name: (values.series(f"{name}.x"), values.series(f"{name}.y"))
        ),
        outputs=ComputedDict(names.outputs, values.series),
    )
