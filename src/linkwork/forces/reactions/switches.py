"""Places where loads switch, and stops."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from linkwork.core.expression.derivatives import Jet
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import Binary, Node, names_in, switches_in
from linkwork.core.foundation.arrays import Array, BoolArray, FrozenDict
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.machine import LoadedBodies
from linkwork.core.motion.model import Model
from linkwork.core.results.quantities.definition import Solved
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.free_bodies import Act, FreeBodies
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry, load_formulas
from linkwork.forces.reactions.parts import line_of

# ----------------------------------------------------------------------
# Where loads switch: the comparisons, and the kinks of functions, in their formulas.


_RISING = ("<", ">=")  # comparisons whose margin is the right side minus the left one


def load_switches(description: Description) -> tuple[Binary, ...]:
    """The comparisons at which loads jump or have a kink, each once: ``F >= 0`` for ``abs(F)``."""
    known = description.numbers.known
    found = (
        each
        for _, formula in load_formulas(description)
        for each in switches_in(parse(formula, comparing=True))
        if any(name.name not in known for name in names_in(each))
    )
    return tuple(dict.fromkeys(found))


def switch_margins(switches: Sequence[Binary], applied: AppliedLoads) -> list[Array]:
    """Of all switches, (B,) each: positive where "<" or ">" is true, "<=" or ">=" is not.

    So 0 is on its right side. A load is smooth between two changes of their signs, and beyond
    these with the :func:`held_switches` of the signs before.
    """
    formula = applied.formula
    return [
        (formula(each.left) - formula(each.right)) * (-1.0 if each.operator in _RISING else 1.0)
        for each in switches
    ]


def held_switches(switches: Sequence[Binary], margins: Sequence[float]) -> Mapping[Node, float]:
    """The value of every switch that belongs to its margin, for :class:`AppliedLoads`."""
    values: dict[Node, float] = {}
    for each, margin in zip(switches, margins, strict=True):
        values[each] = float((margin > 0.0) == (each.operator in ("<", ">")))
    return FrozenDict(values)


# ----------------------------------------------------------------------
# Where loads switch along a motion: to rounding, however short the time between two switches.


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


# ----------------------------------------------------------------------
# Stops that push: as acts on the bodies, in the rows of a simulated motion.


def pushes_of(geometry: Geometry) -> Mapping[str, Array]:
    """What stops give in the direction of their quantities, by name, (B,) each."""
    found: Mapping[str, Array] = getattr(geometry.solved, "stop_forces", {})
    return found


def stop_values(geometry: Geometry) -> Iterator[tuple[str, Kind, str, Array]]:
    """Force, or moment, and impulse of every stop where loads move the mechanism: name, kind,
    about, (B,).
    """
    description, named = geometry.model.description, geometry.model.motion_quantities
    free = any(which.law is None for which in description.inputs)
    if geometry.model.untimed is None or not free or not isinstance(description, LoadedBodies):
        return
    shocks: Mapping[str, Array] = getattr(geometry.solved, "stop_impulses", {})
    none = np.zeros(geometry.shape)
    bounded = (named.find(stop.of) for stop in description.stops)
    for asked in {each.name: each for each in bounded}.values():
        angle = asked.own.kind is Kind.ANGLE
        push, shock = (Kind.MOMENT, Kind.TURN) if angle else (Kind.FORCE, Kind.IMPULSE)
        name, about = f"{asked.name}.stop", f"of its stop on {asked.name}"
        yield name, push, f"{push.value} {about}", pushes_of(geometry).get(asked.name, none)
        yield f"{name}.impulse", shock, f"impulse {about}", shocks.get(asked.name, none)


def _unit_acts(bodies: FreeBodies, name: str) -> list[Act] | None:
    """The acts of a unit in the direction of a quantity; ``None`` if it is of several bodies."""
    linkage, geometry = bodies.linkage, bodies.geometry
    none, one = np.zeros(1, dtype=complex), np.ones(1, dtype=complex)
    if name in linkage.links:
        return [Act(bodies.link(name), none, none, 1.0)]
    for slider in linkage.sliders:
        if slider.name == name:
            place, along = geometry.place(slider.points[0]).v, line_of(slider.line, geometry)
            pair = bodies.link(slider.link), bodies.link(slider.on)
            return [Act(pair[0], place, along), Act(pair[1], place, -along)]
    for cylinder in linkage.cylinders:
        if cylinder.name == name:
            along = line_of(cylinder.between, geometry)
            return [
                Act(bodies.at(point), geometry.place(point).v, side * along)
                for point, side in zip(cylinder.between, (-1.0, 1.0), strict=True)
            ]
    point, _, axis = name.rpartition(".")
    if point in linkage.points and axis in ("x", "y"):
        return [Act(bodies.at(point), geometry.place(point).v, one if axis == "x" else 1j * one)]
    return None


def stop_acts(bodies: FreeBodies) -> list[Act]:
    """The acts of all stops that push."""
    return [
        act.times(push)
        for name, push in pushes_of(bodies.geometry).items()
        for act in _unit_acts(bodies, name) or ()
    ]


def stop_efforts(bodies: FreeBodies) -> Array:
    """The efforts of the inputs less what stops give, (p, B)."""
    geometry = bodies.geometry
    total = np.zeros((len(geometry.driven.equations.inputs), geometry.rows))
    for act in stop_acts(bodies):
        body = act.on.body
        if body == GROUND:
            continue
        first = geometry.links[body][0] if body in geometry.links else body
        turning = geometry.turning(body) if body in geometry.links else 0.0
        moved = geometry.partial(first) + 1j * turning * (act.place - geometry.place(first).v)
        total -= (np.conj(act.force) * moved).real + act.moment * turning
    return total


def undetermined_stops(geometry: Geometry, bodies: FreeBodies | None) -> BoolArray:
    """Rows in which a stop pushes whose forces on the bodies are not determined, (B,)."""
    lost = np.zeros(geometry.rows, dtype=bool)
    for name, push in pushes_of(geometry).items():
        if bodies is None or _unit_acts(bodies, name) is None:
            lost |= push != 0.0
        else:
            lost |= np.isnan(push)
    return lost
