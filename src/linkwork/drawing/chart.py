"""Charts as plain data: panels of curves over one axis, drawn by the writers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import read_only
from linkwork.results.circuits import Circuit, Circuits
from linkwork.results.motion import Limit, LimitKind
from linkwork.results.quantity import Kind

__all__ = ["Chart", "Curve", "Mark", "Panel", "circuit_chart"]

_MOST_PANELS = 6


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
        curves, marks = [], []
        for tone, circuit in enumerate(circuits, start=1):
            x, y = circuit.motion[circuits.input], circuit.motion[name]
            for branch in circuit.branches:
                mine = np.array([b == branch.name for b in circuit.motion.branch])
                line = _folded(x[mine], y[mine], turn if turning else 0.0, turn if angle else 0.0)
                curves.append(Curve(x=line[0], y=line[1], tone=tone, name=circuit.name))
            marks += list(_marks(circuit, circuits.input, name, tone, turning, angle, turn))
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


def _folded(x: Array, y: Array, x_turn: float, y_turn: float) -> tuple[Array, Array]:
    """Both coordinates inside one turn, the line broken where it leaves one side."""
    x = np.mod(x, x_turn) if x_turn else x
    y = np.mod(y, y_turn) if y_turn else y
    jump = np.zeros(max(len(x) - 1, 0), dtype=bool)
    if x_turn:
        jump |= np.abs(np.diff(x)) > 0.5 * x_turn
    if y_turn:
        jump |= np.abs(np.diff(y)) > 0.5 * y_turn
    places = np.flatnonzero(jump) + 1
    return np.insert(x, places, np.nan), np.insert(y, places, np.nan)


def _marks(
    circuit: Circuit, driver: str, name: str, tone: int, turning: bool, angle: bool, turn: float
) -> list[Mark]:
    """Dead points and change points on the curve of one quantity."""
    found = []
    x, y = circuit.motion[driver], circuit.motion[name]
    limits: list[Limit] = [*circuit.dead_points, *circuit.change_points]
    for limit in limits:
        gap = x - limit.input
        if turning:
            gap = gap - turn * np.round(gap / turn)
        places = np.flatnonzero(np.abs(gap) < 1e-6)
        if not len(places):
            continue
        for place in places:
            value = float(y[place])
            found.append(
                Mark(
                    x=float(np.mod(x[place], turn)) if turning else float(x[place]),
                    y=float(np.mod(value, turn)) if angle else value,
                    tone=tone,
                    kind=LimitKind(limit.kind).word,
                )
            )
    return found
