"""Where loads switch along a motion: to rounding, however short the time between two switches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from linkwork.expression.jets import Jet
from linkwork.forces.applied import AppliedLoads
from linkwork.forces.geometry import Geometry
from linkwork.forces.switches import load_switches, switch_margins
from linkwork.foundation.arrays import Array
from linkwork.mechanism.loaded import LoadedBodies
from linkwork.motion.model import Model
from linkwork.results.quantities.definition import Solved

__all__ = ["beside_switches", "switch_places"]

_LOOKS = 4  # places of a step of the table where switches are looked for
_DIP = 2.0  # times the differences to its neighbours: a smaller least value may hide two zeros
_CUTS, _ROUNDS = 16, 16  # of a bracket at once, and how often: to rounding
_BESIDE = 2e-12  # of the table: a row there is no row of the table, and rounding keeps it there
_SAME_LENGTH = 1e-9  # of the longest link: a spring whose length varies less has no shortest one


def beside_switches(model: Model, at: Callable[[Array], Solved], t: Array) -> Array:
    """Places just before and just behind all switches, rising, (2K,); see :func:`switch_places`."""
    before, behind = switch_places(model, at, t)
    away = _BESIDE * max(float(np.ptp(t)), float(np.abs(t).max()))
    return np.sort(np.clip(np.concatenate([before - away, behind + away]), t[0], t[-1]))


def switch_places(model: Model, at: Callable[[Array], Solved], t: Array) -> tuple[Array, Array]:
    """Just before and just behind every switch of a load between rising places (B,), (K,) each.

    ``at``: positions at values of the leading input. Two changes of a margin between neighbouring
    places are found if its size has a dip there. Margins of springs through no length: the spring
    is shortest there.
    """
    before, behind = np.zeros(0), np.zeros(0)
    if not isinstance(model.description, LoadedBodies):
        return before, behind
    parts = getattr(model.description, "parts", ())
    spans = [p.between for p in parts if getattr(p, "pulls", False) and p.between is not None]
    margins = _Margins(model, at, spans)
    margins.spans = margins.varying(t)
    looks = np.concatenate([t[:-1] + k / _LOOKS * np.diff(t) for k in range(_LOOKS)] + [t[-1:]])
    for k in range(len(margins(t[:1]))):
        # outer functions have corners where inner ones, which come first, change their signs
        places = np.unique(np.concatenate([looks, before, behind]))
        low, high = _brackets(partial(margins.one, k), places)
        before, behind = np.append(before, low), np.append(behind, high)
    order = np.argsort(behind)
    return before[order], behind[order]


@dataclass(eq=False)
class _Margins:
    """Functions of places (B,) that change their signs where loads switch, (B,) each.

    ``spans``: the ends of those that have a shortest length on the way.
    """

    model: Model
    at: Callable[[Array], Solved]
    spans: list[tuple[str, str]]

    def __call__(self, places: Array) -> list[Array]:
        applied = AppliedLoads(Geometry(self.model, self.at(places)), self.model.speed or 0.0)
        found = switch_margins(load_switches(self.model.description), applied)
        lengths = (self._span(applied.geometry, ends) for ends in self.spans)
        return [*found, *((span.v.conj() * span.d1).real for span in lengths)]

    def one(self, k: int, places: Array) -> Array:
        """One of them at places of any shape."""
        return self(places.ravel())[k].reshape(places.shape)

    def varying(self, places: Array) -> list[tuple[str, str]]:
        """The springs whose lengths vary."""
        geometry = Geometry(self.model, self.at(places))
        least = _SAME_LENGTH * geometry.length
        return [ends for ends in self.spans if np.ptp(np.abs(self._span(geometry, ends).v)) > least]

    @staticmethod
    def _span(geometry: Geometry, ends: tuple[str, str]) -> Jet:
        return geometry.place(ends[1]) - geometry.place(ends[0])


def _brackets(function: Callable[[Array], Array], places: Array) -> tuple[Array, Array]:
    """Just before and just behind the changes of sign of a function."""
    values = function(places)
    low, high = _changes(places[None], values[None])
    size = np.abs(values)
    before, after = size[:-2] - size[1:-1], size[2:] - size[1:-1]
    over = values > 0.0
    dips = (before >= 0.0) & (after >= 0.0) & (before + after > 0.0)
    dips &= (over[:-2] == over[1:-1]) & (over[2:] == over[1:-1])
    inner = places[:-2][dips], places[2:][dips]
    for _ in range(_ROUNDS):
        if not len(inner[0]):
            break
        grid = np.linspace(*inner, _CUTS + 1, axis=1)
        own = function(grid)
        more = _changes(grid, own)
        low, high = np.append(low, more[0]), np.append(high, more[1])
        size = np.abs(own)
        least = np.clip(size.argmin(axis=1), 1, _CUTS - 1)[:, None]
        beside = np.take_along_axis(size, np.hstack([least - 1, least, least + 1]), axis=1)
        deep = beside[:, 1] <= _DIP * (beside[:, 0] + beside[:, 2] - 2.0 * beside[:, 1])
        deep &= ((own > 0.0) == (own[:, :1] > 0.0)).all(axis=1)
        ends = np.take_along_axis(grid, np.hstack([least - 1, least + 1]), axis=1)[deep]
        inner = ends[:, 0], ends[:, 1]
    for _ in range(_ROUNDS):
        if (high - low <= 4.0 * np.spacing(np.abs(high))).all():
            break
        grid = np.linspace(low, high, _CUTS + 1, axis=1)
        over = function(grid) > 0.0
        # a function that is zero to rounding may change its sign more than once: the first counts
        first = (over[:, 1:] != over[:, :-1]).argmax(axis=1)
        rows = np.arange(len(low))
        low, high = grid[rows, first], grid[rows, first + 1]
    return low, high


def _changes(grid: Array, values: Array) -> tuple[Array, Array]:
    """The neighbours on rows of a grid between which values change their signs."""
    over = values > 0.0
    row, k = np.nonzero(over[:, 1:] != over[:, :-1])
    return grid[row, k], grid[row, k + 1]
