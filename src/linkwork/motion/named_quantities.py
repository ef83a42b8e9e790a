"""Turning solved arrays into named quantities in file units."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from linkwork.equations.compiling import coordinate_name, evaluate_outputs
from linkwork.expression.jets import Jet
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.names import canonical
from linkwork.motion.model import Model
from linkwork.results.motion import Series
from linkwork.results.quantity import Kind, Quantity

__all__ = ["Named", "name_series"]


@dataclass(frozen=True, kw_only=True)
class Named:
    """All quantities of a batch of positions by name."""

    inputs: dict[str, Array]
    unknowns: dict[str, Series]
    links: dict[str, Series]
    sliders: dict[str, Series]
    points: dict[str, tuple[Series, Series]]
    outputs: dict[str, Series]


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
        The input values asked for, in file units (they may differ from ``v`` by whole turns).
    """
    lost = ~found
    columns = [np.where(lost[:, None], np.nan, part) for part in (v, first, second)]
    equations = model.equations
    number = {variable.symbol: k for k, variable in enumerate(equations.variables)}
    jets = {
        symbol: Jet(columns[0][:, k], columns[1][:, k], columns[2][:, k])
        for symbol, k in number.items()
    }
    kinds = {variable.symbol: Kind(variable.kind) for variable in equations.variables}
    links = _links(model, jets, np.where(lost, np.nan, 0.0))
    points = _points(model, columns)
    series = partial(_series, model)
    released = {part.variable for part in equations.redundant}
    return Named(
        inputs={variable.name: inputs[:, k] for k, variable in enumerate(equations.inputs)},
        unknowns={
            variable.name: series(variable.name, jets[variable.symbol], kinds[variable.symbol])
            for variable in equations.unknowns
            if variable.name not in released
        },
        links={link: series(link, jet, Kind.ANGLE) for link, jet in links.items()},
        sliders={
            name: series(name, jets[canonical(symbol)], Kind.LENGTH)
            for name, symbol in equations.sliders.items()
        },
        points={
            point: (
                series(f"{point}.x", jet_x, Kind.LENGTH),
                series(f"{point}.y", jet_y, Kind.LENGTH),
            )
            for point, (jet_x, jet_y) in points.items()
        },
        outputs=_outputs(model, jets, kinds, links, points, len(v)),
    )


def _series(model: Model, name: str, jet: Jet, kind: Kind) -> Series:
    return Series(
        quantity=Quantity(name=name, kind=kind),
        value=jet.v / model.units.scale(kind),
        first=jet.d1,
        second=jet.d2,
    )


def _links(model: Model, jets: dict[str, Jet], blank: Array) -> dict[str, Jet]:
    """The angles of links; ``blank`` (B,) is 0, or NaN where there is no position."""
    found = {}
    for link, angle in model.equations.links.items():
        constant = Jet(blank + angle.constant, blank, blank)
        turning = None if angle.variable is None else jets[canonical(angle.variable)]
        found[link] = constant if turning is None else turning + constant
    return found


def _points(model: Model, columns: list[Array]) -> dict[str, tuple[Jet, Jet]]:
    table = model.compiled.points
    if not table.names:
        return {}
    parts = table.jet(*columns)
    number = {name: k for k, name in enumerate(table.names)}
    order = getattr(model.description, "points", {})
    return {
        point: (
            Jet(*(part[:, number[point]].real for part in parts)),
            Jet(*(part[:, number[point]].imag for part in parts)),
        )
        for point in order
    }


def _outputs(
    model: Model,
    jets: dict[str, Jet],
    kinds: dict[str, Kind],
    links: dict[str, Jet],
    points: dict[str, tuple[Jet, Jet]],
    count: int,
) -> dict[str, Series]:
    """Formulas see file units; derivatives of angles come back in radians."""
    if not model.equations.outputs:
        return {}

    def in_file_unit(jet: Jet, kind: Kind) -> Jet:
        scale = 1.0 / model.units.scale(kind)
        return Jet(jet.v * scale, jet.d1 * scale, jet.d2 * scale)

    names = {symbol: in_file_unit(jet, kinds[symbol]) for symbol, jet in jets.items()}
    names |= {canonical(link): in_file_unit(jet, Kind.ANGLE) for link, jet in links.items()}
    for point, (x, y) in points.items():
        names |= {coordinate_name(point, "x"): x, coordinate_name(point, "y"): y}
    found = {}
    for name, jet in evaluate_outputs(model.equations, names, count).items():
        kind = Kind(model.equations.outputs[name].kind)
        scale = model.units.scale(kind)
        found[name] = Series(
            quantity=Quantity(name=name, kind=kind),
            value=jet.v,
            first=jet.d1 * scale,
            second=jet.d2 * scale,
        )
    return found
