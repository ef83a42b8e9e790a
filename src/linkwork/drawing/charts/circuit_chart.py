"""Chart of all circuits as closed curves of each quantity over the input."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from linkwork.drawing.charts.chart import Axis, Chart, Curve, Mark, Panel
from linkwork.drawing.charts.columns import usual_columns
from linkwork.drawing.charts.labels import axis_label
from linkwork.drawing.charts.overlap import layered
from linkwork.drawing.charts.scales import finite_ends
from linkwork.drawing.charts.turns import Window, origin, rounded, turn_axis
from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.foundation.errors import InputError
from linkwork.results.circuits import Circuits
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["MOST_PANELS", "circuit_chart"]

#: Maximum number of quantities shown by default.
MOST_PANELS = 6


def circuit_chart(circuits: Circuits, names: Sequence[str] = ()) -> Chart:
    """Every circuit as a closed curve of each quantity over the input, limits marked.

    An angle input is shown over one turn. Other angles are shown over the turn that
    cuts the fewest curves, or over less if that shows all.

    Parameters
    ----------
    names : sequence of str
        The quantities to show; by default the first :data:`MOST_PANELS` of :func:`usual_columns`.

    Raises
    ------
    InputError
        If there is no circuit, or nothing to show by default.
    UnknownNameError
        If a quantity does not exist.
    """
    if not len(circuits):
        raise InputError(f'"{circuits.mechanism}" has no circuit to draw: {circuits.message}')
    motions = [circuit.motion for circuit in circuits]
    units = motions[0].units
    turning = circuits.input_unit == units.angle.value
    turn = units.angle.turn if turning else 0.0
    count = len(circuits)
    asked = [motions[0].series(name).quantity.name for name in names]
    shown = tuple(dict.fromkeys(asked)) or usual_columns(motions[0])[:MOST_PANELS]
    return Chart(
        title=circuits.mechanism,
        caption=f"{count} circuit{'' if count == 1 else 's'}",
        axis=Axis(
            label=axis_label(circuits.input, circuits.input_unit),
            turn=turn,
            ends=(0.0, turn) if turning else None,
            step=turn / 8,
        ),
        panels=tuple(_panel(circuits, name, turn) for name in shown),
    )


def _panel(circuits: Circuits, name: str, x_turn: float) -> Panel:
    """One quantity along all circuits; ``x_turn``: a full turn of the input, 0 for a length."""
    first = circuits[0].motion
    quantity = first.series(name).quantity
    units = first.units
    turn = units.angle.turn if quantity.kind is Kind.ANGLE else 0.0
    ways: list[tuple[Motion, int, str, list[tuple[Array, Array]]]] = []
    for tone, circuit in enumerate(circuits, start=1):
        motion = circuit.motion
        x, y = rounded(motion[circuits.input], x_turn), rounded(motion[name], turn)
        of = np.array(motion.branch)
        mine = [of == branch.name for branch in circuit.branches]
        ways.append((motion, tone, circuit.name, [(x[rows], y[rows]) for rows in mine]))
    low = origin([y for *_, lines in ways for _, y in lines], turn)
    window = Window(x_turn=x_turn, y_turn=turn, low=low)
    curves: list[Curve] = []
    marks: list[Mark] = []
    for motion, tone, circuit_name, lines in ways:
        folded = [window.folded(x, y) for x, y in lines]
        curves += [Curve(x=x, y=y, tone=tone, name=circuit_name) for x, y in folded]
        marks += _marks(motion, circuits.input, name, tone, window, folded)
    axis = Axis(label=axis_label(name, units.of(quantity.kind)), turn=turn)
    if turn:
        axis = turn_axis(axis, [curve.y for curve in curves], low, units.angle)
    elif any(circuit.end is CircuitEnd.RUNS_TO_INFINITY for circuit in circuits):
        axis = replace(axis, ends=finite_ends(curves))
    return Panel(axis=axis, curves=tuple(layered(curves)), marks=tuple(marks))


def _marks(
    motion: Motion,
    driver: str,
    name: str,
    tone: int,
    window: Window,
    lines: Iterable[tuple[Array, Array]],
) -> list[Mark]:
    """Dead points and change points on the curves of one quantity, at both edges if necessary."""
    x, y = rounded(motion[driver], window.x_turn), rounded(motion[name], window.y_turn)
    ends = np.concatenate([np.stack(line, axis=1) for line in lines])
    near = window.tolerance(ends)
    found: list[Mark] = []
    for k in (k for k, kind in enumerate(motion.limit) if kind):
        for place in window.shown_on(ends, float(x[k]), float(y[k])):
            # a dead point ends two branches, but is marked once
            if not any((np.abs(np.subtract(place, (m.x, m.y))) < near).all() for m in found):
                found.append(Mark(x=place[0], y=place[1], tone=tone, kind=motion.limit[k]))
    return found
