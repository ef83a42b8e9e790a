"""Charts as plain data: panels of curves over one axis, drawn by the writers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from linkwork.drawing.captions import printed_name
from linkwork.foundation.angles import AngleUnit
from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.foundation.errors import InputError
from linkwork.foundation.frozen import read_only
from linkwork.results.circuits import Circuits
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["MOST_PANELS", "Axis", "Chart", "Curve", "Mark", "Panel", "circuit_chart"]

#: Unknowns that are shown if nobody says which.
MOST_PANELS = 6

_ROUNDING = 1e-9  # of a turn: an angle this near to a whole one lies on it
_ORIGINS = (0.0, -0.5, -0.25, -0.75)  # of a turn: where the turn that a panel shows may begin
_STEPS = (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0)  # degrees between ticks, less than a turn shown
_RADIAN_STEPS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, np.pi / 4)
_MOST_STEPS = 5
_TAIL = 0.1  # of the input's range at either end of the values, where curves run to infinity
_NEAR = 0.004  # of the panel's sides: curves as near as this hide each other
_LOOKED_AT = 100  # points of a curve, to see whether another one hides it
_HIDDEN = 0.4  # share of a curve that another one hides, from which on it is drawn wider


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """A line through (x, y), both (K,); NaN breaks it. ``tone`` counts colours from 1.

    ``below`` counts the later curves that run over it: it shows on both sides of them only if it
    is drawn wider.
    """

    x: Array
    y: Array
    tone: int
    name: str
    below: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "x", read_only(self.x))
        object.__setattr__(self, "y", read_only(self.y))


@dataclass(frozen=True, kw_only=True)
class Mark:
    """A point of a curve: ``dead point`` or ``change point``."""

    x: float
    y: float
    tone: int
    kind: str


@dataclass(frozen=True, kw_only=True)
class Axis:
    """What an axis is called, what it shows, and the distance of its ticks.

    Without ``ends`` it shows all of its curves; with them, curves may leave it if it is no angle.
    Without ``step`` ticks stand at round numbers. ``turn`` is a full turn in the unit of an
    angle, 0 if it is none.
    """

    label: str
    turn: float = 0.0
    ends: tuple[float, float] | None = None
    step: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Panel:
    """One quantity over the common axis."""

    axis: Axis
    curves: tuple[Curve, ...]
    marks: tuple[Mark, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Panels one below the other over one axis."""

    title: str
    caption: str
    axis: Axis
    panels: tuple[Panel, ...]


def circuit_chart(circuits: Circuits, names: Sequence[str] = ()) -> Chart:
    """Every circuit as a closed curve of each quantity over the input, limits marked.

    An angle input is shown over one turn. An angle is shown over the turn that cuts its curves
    least, or over less where that shows them all.

    Parameters
    ----------
    names : sequence of str
        The quantities to show; the first :data:`MOST_PANELS` unknowns if left out.

    Raises
    ------
    InputError
        If there is no circuit.
    UnknownNameError
        For a quantity that does not exist.
    """
    if not len(circuits):
        raise InputError(f'"{circuits.mechanism}" has no circuit to draw: {circuits.message}')
    motions = [circuit.motion for circuit in circuits]
    units = motions[0].units
    turning = circuits.input_unit == units.angle.value
    turn = units.angle.turn if turning else 0.0
    count = len(circuits)
    asked = [motions[0].series(name).quantity.name for name in names]
    shown = tuple(dict.fromkeys(asked)) or tuple(motions[0].unknowns)[:MOST_PANELS]
    return Chart(
        title=circuits.mechanism,
        caption=f"{count} circuit{'' if count == 1 else 's'}",
        axis=Axis(
            label=_label(circuits.input, circuits.input_unit),
            turn=turn,
            ends=(0.0, turn) if turning else None,
            step=turn / 8,
        ),
        panels=tuple(_panel(circuits, name, turn) for name in shown),
    )


def _label(name: str, unit: str) -> str:
    return f"{printed_name(name)} [{unit}]" if unit else printed_name(name)


def _panel(circuits: Circuits, name: str, x_turn: float) -> Panel:
    """One quantity along all circuits; ``x_turn``: a full turn of the input, 0 for a length."""
    first = circuits[0].motion
    quantity = first.series(name).quantity
    units = first.units
    turn = units.angle.turn if quantity.kind is Kind.ANGLE else 0.0
    ways: list[tuple[Motion, int, str, list[tuple[Array, Array]]]] = []
    for tone, circuit in enumerate(circuits, start=1):
        motion = circuit.motion
        x, y = _rounded(motion[circuits.input], x_turn), _rounded(motion[name], turn)
        of = np.array(motion.branch)
        mine = [of == branch.name for branch in circuit.branches]
        ways.append((motion, tone, circuit.name, [(x[rows], y[rows]) for rows in mine]))
    low = _origin([y for *_, lines in ways for _, y in lines], turn)
    window = _Window(x_turn=x_turn, y_turn=turn, low=low)
    curves: list[Curve] = []
    marks: list[Mark] = []
    for motion, tone, circuit_name, lines in ways:
        folded = [window.folded(x, y) for x, y in lines]
        curves += [Curve(x=x, y=y, tone=tone, name=circuit_name) for x, y in folded]
        marks += _marks(motion, circuits.input, name, tone, window, folded)
    axis = Axis(label=_label(name, units.of(quantity.kind)), turn=turn)
    if turn:
        axis = _angle_axis(axis, [curve.y for curve in curves], low, units.angle)
    elif any(circuit.end is CircuitEnd.RUNS_TO_INFINITY for circuit in circuits):
        axis = replace(axis, ends=_finite_ends(curves))
    return Panel(axis=axis, curves=tuple(_layered(curves)), marks=tuple(marks))


def _rounded(values: Array, turn: float) -> Array:
    """Values (K,) with those on quarter turns exactly there: rounding must not fold a line."""
    if not turn:
        return values
    quarter = turn / 4
    whole = np.round(values / quarter) * quarter
    return np.where(np.abs(values - whole) < _ROUNDING * turn, whole, values)


def _origin(lines: Sequence[Array], turn: float) -> float:
    """Where the turn begins that cuts lines of angles least often; 0 unless another cuts less.

    Of turns that cut as often, the one along whose edges fewest positions lie.
    """
    if not turn:
        return 0.0
    return turn * min(
        _ORIGINS, key=lambda low: _cuts([np.round(line / turn - low, 9) for line in lines])
    )


def _cuts(lines: Sequence[Array]) -> tuple[int, int]:
    """How often lines of angles [turns] pass a whole turn, and how many positions lie on one."""
    ends = [(np.minimum(y[:-1], y[1:]), np.maximum(y[:-1], y[1:])) for y in lines]
    passed = sum(int(np.maximum(np.ceil(b) - np.floor(a) - 1, 0).sum()) for a, b in ends)
    return passed, sum(int((y == np.round(y)).sum()) for y in lines)


def _angle_axis(axis: Axis, lines: Sequence[Array], low: float, unit: AngleUnit) -> Axis:
    """The turn from ``low`` on, or less where all angles lie within half of it."""
    turn = unit.turn
    least, most = (float(f(np.concatenate(lines))) for f in (np.nanmin, np.nanmax))
    if most - least <= turn / 2:
        for step in _STEPS if unit is AngleUnit.DEGREE else _RADIAN_STEPS:
            # a tenth of a step is left free, so that no curve runs along an edge
            first, last = np.floor(least / step - 0.1), np.ceil(most / step + 0.1)
            if last - first <= _MOST_STEPS:
                return replace(axis, ends=(float(first * step), float(last * step)), step=step)
    return replace(axis, ends=(low, low + turn), step=turn / 4)


def _finite_ends(curves: Sequence[Curve]) -> tuple[float, float] | None:
    """What to show of curves that run to infinity: twice what most of the input's range takes."""
    y = np.concatenate([0.5 * (curve.y[1:] + curve.y[:-1]) for curve in curves])
    share = np.concatenate([np.abs(np.diff(curve.x)) for curve in curves])
    order = np.argsort(y)[: int(np.isfinite(y * share).sum())]
    passed = np.cumsum(share[order])
    if not passed.size or not passed[-1]:
        return None
    low, high = np.interp([_TAIL, 1 - _TAIL], passed / passed[-1], y[order])
    room = 0.5 * (high - low)
    return (float(low - room), float(high + room)) if room else None


@dataclass(frozen=True, kw_only=True)
class _Window:
    """The turn of either coordinate that is shown, 0 where it is no angle; y begins at ``low``."""

    x_turn: float
    y_turn: float
    low: float

    def folded(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Both coordinates inside the turn; the line goes on at the other side of the panel."""
        x_turn, y_turn = self.x_turn, self.y_turn
        y = _rounded(y - self.low, y_turn)
        cuts = [(x[0], y[0])] if len(x) else []
        for k in range(len(x) - 1):
            places = {1.0}
            for here, there, turn in ((x[k], x[k + 1], x_turn), (y[k], y[k + 1], y_turn)):
                if turn:
                    low, high = sorted((here / turn, there / turn))
                    edges = np.arange(np.floor(low) + 1.0, np.ceil(high))
                    places |= {float((e * turn - here) / (there - here)) for e in edges}
            cuts += [
                (x[k] + s * (x[k + 1] - x[k]), y[k] + s * (y[k + 1] - y[k])) for s in sorted(places)
            ]
        pieces: list[tuple[float, float]] = []
        last: tuple[float, float] | None = None
        for (x0, y0), (x1, y1) in pairwise(cuts):
            shift_x = x_turn * np.floor(0.5 * (x0 + x1) / x_turn) if x_turn else 0.0
            shift_y = y_turn * np.floor(0.5 * (y0 + y1) / y_turn) if y_turn else 0.0
            start = (float(x0 - shift_x), float(y0 - shift_y))
            if last is None or max(abs(start[0] - last[0]), abs(start[1] - last[1])) > 1e-9:
                pieces += [(np.nan, np.nan), start] if last is not None else [start]
            last = (float(x1 - shift_x), float(y1 - shift_y))
            pieces.append(last)
        line = np.array(pieces).reshape(-1, 2)
        return line[:, 0], line[:, 1] + self.low

    def places(self, x: float, y: float) -> list[tuple[float, float]]:
        """Where a point is shown: a whole turn at both edges."""
        return [
            (at_x, at_y + self.low)
            for at_x in _edges(x, self.x_turn)
            for at_y in _edges(y - self.low, self.y_turn)
        ]


def _edges(value: float, turn: float) -> tuple[float, ...]:
    """Where a value lies inside one turn: a whole turn at both of its edges."""
    if not turn:
        return (value,)
    folded = float(np.mod(_rounded(np.array(value), turn), turn))
    return (folded,) if folded else (0.0, turn)


def _marks(
    motion: Motion,
    driver: str,
    name: str,
    tone: int,
    window: _Window,
    lines: Iterable[tuple[Array, Array]],
) -> list[Mark]:
    """Dead points and change points on the curves of one quantity, at both edges if need be."""
    x, y = _rounded(motion[driver], window.x_turn), _rounded(motion[name], window.y_turn)
    ends = np.concatenate([np.stack(line, axis=1) for line in lines])
    reach = np.array([window.x_turn, window.y_turn])
    near = _ROUNDING * np.where(reach > 0.0, reach, np.maximum(1.0, np.nanmax(np.abs(ends), 0)))
    found: list[Mark] = []
    for k in (k for k, kind in enumerate(motion.limit) if kind):
        for place in window.places(float(x[k]), float(y[k])):
            on_curve = (np.abs(ends - place) < near).all(axis=1).any()
            # a dead point is the end of two branches: it is marked once
            marked = any((np.abs(np.subtract(place, (m.x, m.y))) < near).all() for m in found)
            if on_curve and not marked:
                found.append(Mark(x=place[0], y=place[1], tone=tone, kind=motion.limit[k]))
    return found


def _layered(curves: Sequence[Curve]) -> list[Curve]:
    """The curves, each with the number of circuits drawn later that hide much of it."""
    points = [np.stack([curve.x, curve.y], axis=1) for curve in curves]
    every = np.concatenate(points)
    size = np.nanmax(every, axis=0) - np.nanmin(every, axis=0)
    scaled = [line / np.where(size > 0.0, size, 1.0) for line in points]
    layered = []
    for k, curve in enumerate(curves):
        hiding = {
            other.tone
            for other, line in zip(curves, scaled, strict=True)
            if other.tone > curve.tone and _hidden_share(scaled[k], line) > _HIDDEN
        }
        layered.append(replace(curve, below=len(hiding)))
    return layered


def _hidden_share(line: Array, other: Array) -> float:
    """The share of the points of a line (K, 2) that lie on another one (M, 2)."""
    points = line[np.isfinite(line).all(axis=1)]
    points = points[:: max(1, len(points) // _LOOKED_AT)]
    start, step = other[:-1], np.diff(other, axis=0)
    squared = np.maximum((step**2).sum(axis=1), 1e-30)
    offset = points[:, None, :] - start
    share = np.clip((offset * step).sum(axis=2) / squared, 0.0, 1.0)
    away = np.linalg.norm(offset - share[:, :, None] * step, axis=2)
    return float((away < _NEAR).any(axis=1).mean()) if away.size else 0.0
