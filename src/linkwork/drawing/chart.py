"""Charts as plain data: panels of curves over one axis, drawn by the writers."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import read_only
from linkwork.results.circuits import Circuits
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["Chart", "Curve", "Mark", "Panel", "circuit_chart"]

_MOST_PANELS = 6
_ROUNDING = 1e-9  # of a turn: an angle this near to a whole one lies on it


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """A line through (x, y), both (K,); NaN breaks it. ``tone`` counts colours from 1."""

    x: Array
    y: Array
    tone: int
    name: str

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
class Panel:
    """One quantity over the common axis."""

    label: str
    curves: tuple[Curve, ...]
    marks: tuple[Mark, ...] = ()
    whole_turns: bool = False


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Panels one below the other over one axis; ``whole_turns`` if that is a full turn."""

    title: str
    label: str
    panels: tuple[Panel, ...]
    whole_turns: bool = False
    turn: float = 360.0


@dataclass(frozen=True, kw_only=True)
class Turns:
    """A full turn of either coordinate, 0 where it is no angle."""

    x: float
    y: float


def circuit_chart(circuits: Circuits, names: tuple[str, ...] = ()) -> Chart:
    """Every circuit as a closed curve of each unknown over the input, limits marked.

    Parameters
    ----------
    names : tuple of str
        The quantities to show; the first unknowns if left out.
    """
    motions = [circuit.motion for circuit in circuits]
    turn = motions[0].units.angle.turn if motions else 360.0
    shown = names or (tuple(motions[0].unknowns)[:_MOST_PANELS] if motions else ())
    turning = circuits.input_unit in ("deg", "rad")
    panels = []
    for name in shown:
        quantity = motions[0].series(name).quantity
        angle = quantity.kind is Kind.ANGLE
        unit = motions[0].units.of(quantity.kind)
        turns = Turns(x=turn if turning else 0.0, y=turn if angle else 0.0)
        curves: list[Curve] = []
        marks: list[Mark] = []
        for tone, circuit in enumerate(circuits, start=1):
            x = _rounded(circuit.motion[circuits.input], turns.x)
            y = _rounded(circuit.motion[name], turns.y)
            lines: list[Curve] = []
            for branch in circuit.branches:
                mine = np.array([b == branch.name for b in circuit.motion.branch])
                line = _folded(x[mine], y[mine], turns.x, turns.y)
                lines.append(Curve(x=line[0], y=line[1], tone=tone, name=circuit.name))
            curves += lines
            marks += _marks(circuit.motion, circuits.input, name, tone, turns, lines)
        label = f"{name} [{unit}]" if unit else name
        panels.append(
            Panel(label=label, curves=tuple(curves), marks=tuple(marks), whole_turns=angle)
        )
    unit = f" [{circuits.input_unit}]" if circuits.input_unit else ""
    count = len(circuits)
    return Chart(
        title=f"{circuits.mechanism}: {count} circuit{'' if count == 1 else 's'}",
        label=f"{circuits.input}{unit}",
        panels=tuple(panels),
        whole_turns=turning,
        turn=turn,
    )


def _rounded(values: Array, turn: float) -> Array:
    """Values (K,) with those on whole turns exactly there: rounding must not fold a line."""
    if not turn:
        return values
    whole = np.round(values / turn) * turn
    return np.where(np.abs(values - whole) < _ROUNDING * turn, whole, values)


def _folded(x: Array, y: Array, x_turn: float, y_turn: float) -> tuple[Array, Array]:
    """Both coordinates inside one turn; the line goes on at the other side of the panel."""
    cuts = [(0.0, x[0], y[0])] if len(x) else []
    for k in range(len(x) - 1):
        places = {1.0}
        for here, there, turn in ((x[k], x[k + 1], x_turn), (y[k], y[k + 1], y_turn)):
            if turn:
                low, high = sorted((here / turn, there / turn))
                edges = np.arange(np.floor(low) + 1.0, np.ceil(high))
                places |= {float((e * turn - here) / (there - here)) for e in edges}
        cuts += [
            (k + s, x[k] + s * (x[k + 1] - x[k]), y[k] + s * (y[k + 1] - y[k]))
            for s in sorted(places)
        ]
    pieces: list[tuple[float, float]] = []
    last: tuple[float, float] | None = None
    for (_, x0, y0), (_, x1, y1) in pairwise(cuts):
        shift_x = x_turn * np.floor(0.5 * (x0 + x1) / x_turn) if x_turn else 0.0
        shift_y = y_turn * np.floor(0.5 * (y0 + y1) / y_turn) if y_turn else 0.0
        start = (float(x0 - shift_x), float(y0 - shift_y))
        if last is None or max(abs(start[0] - last[0]), abs(start[1] - last[1])) > 1e-9:
            pieces += [(np.nan, np.nan), start] if last is not None else [start]
        last = (float(x1 - shift_x), float(y1 - shift_y))
        pieces.append(last)
    folded = np.array(pieces).reshape(-1, 2)
    return folded[:, 0], folded[:, 1]


def _marks(
    motion: Motion, driver: str, name: str, tone: int, turns: Turns, lines: list[Curve]
) -> list[Mark]:
    """Dead points and change points on the curves of one quantity, at both edges if need be."""
    x, y = _rounded(motion[driver], turns.x), _rounded(motion[name], turns.y)
    ends = np.concatenate([np.stack([line.x, line.y], axis=1) for line in lines])
    reach = np.array([turns.x, turns.y])
    near = _ROUNDING * np.where(reach > 0.0, reach, np.maximum(1.0, np.nanmax(np.abs(ends), 0)))
    return [
        Mark(x=at_x, y=at_y, tone=tone, kind=kind)
        for k, kind in enumerate(motion.limit)
        if kind
        for at_x in _edges(float(x[k]), turns.x)
        for at_y in _edges(float(y[k]), turns.y)
        if (np.abs(ends - [at_x, at_y]) < near).all(axis=1).any()
    ]


def _edges(value: float, turn: float) -> tuple[float, ...]:
    """Where a value lies inside one turn: a whole turn at both of its edges."""
    if not turn:
        return (value,)
    folded = float(np.mod(value, turn))
    return (folded,) if folded else (0.0, turn)
