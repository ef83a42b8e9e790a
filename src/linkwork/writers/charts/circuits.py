"""Chart of all circuits as closed curves of each quantity over the input."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from linkwork.circuits.results import Branch, Circuits
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import CircuitEnd
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind
from linkwork.writers.charts.chart import (
    Axis,
    Chart,
    Curve,
    Mark,
    Panel,
    Window,
    axis_label,
    finite_ends,
    origin,
    rounded,
    turn_axis,
)
from linkwork.writers.charts.columns import layered, usual_columns

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
        panels=tuple(_circuit_chart_panel(circuits, name, turn) for name in shown),
    )


def _circuit_chart_panel(circuits: Circuits, name: str, x_turn: float) -> Panel:
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
        marks += _circuit_chart_marks(motion, circuits.input, name, tone, window, folded)
    axis = Axis(label=axis_label(name, units.of(quantity.kind)), turn=turn)
    if turn:
        axis = turn_axis(axis, [curve.y for curve in curves], low, units.angle)
    elif any(circuit.end is CircuitEnd.RUNS_TO_INFINITY for circuit in circuits):
        axis = replace(axis, ends=finite_ends(curves))
    return Panel(axis=axis, curves=tuple(layered(curves)), marks=tuple(marks))


def _circuit_chart_marks(
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


# ----------------------------------------------------------------------
# Small multiples: one panel for every branch of every circuit.


_USUAL_COLUMNS, _MOST_COLUMNS = 3, 4
_STEPS = {1: 8, 2: 4, 3: 4}  # ticks per turn, by the number of columns


def branch_chart(circuits: Circuits, names: Sequence[str] = ()) -> Chart:
    """One panel for every branch, with all others behind it in grey.

    Parameters
    ----------
    names : sequence of str
        The quantities to show, one below the other; by default the first of those of
        :func:`circuit_chart`.

    Raises
    ------
    InputError
        If there is no circuit, or too many branches for several quantities.
    UnknownNameError
        If a quantity does not exist.
    """
    every = circuit_chart(circuits, names)
    shown = every.panels if names else every.panels[:1]
    branches = [branch for circuit in circuits for branch in circuit.branches]
    count = len(branches)
    if len(shown) > 1 and count > _MOST_COLUMNS:
        raise InputError(
            f'"{circuits.mechanism}" has {count} branches, too many for several '
            f"quantities: name one of {', '.join(names)}"
        )
    columns = count if len(shown) > 1 else _columns(count)
    panels = [
        _branch_chart_panel(panel, branch, k, titled=row == 0 or count > columns)
        for row, panel in enumerate(shown)
        for k, branch in enumerate(branches)
    ]
    return replace(
        every,
        caption=f"{count} branch{'' if count == 1 else 'es'} in {every.caption}",
        axis=_axis(every.axis, columns),
        panels=tuple(panels),
        columns=columns,
        legend=tuple(dict.fromkeys(mark.kind for panel in panels for mark in panel.marks)),
    )


def _columns(count: int) -> int:
    """The number of panels in a row."""
    if count == 4:
        return 2
    return max(1, min(count, _USUAL_COLUMNS if count <= _USUAL_COLUMNS**2 else _MOST_COLUMNS))


def _axis(axis: Axis, columns: int) -> Axis:
    return replace(axis, step=axis.turn / _STEPS.get(columns, 2)) if axis.turn else axis


def _branch_chart_panel(every: Panel, branch: Branch, k: int, *, titled: bool) -> Panel:
    """The panel with its k-th curve in front and the others in grey."""
    own = replace(every.curves[k], below=0)
    others = [replace(c, quiet=True) for n, c in enumerate(every.curves) if n != k]
    title = "\n".join(filter(None, (branch.name, branch.configuration))) if titled else ""
    marks = tuple(mark for mark in every.marks if _ends(own, mark.x, mark.y))
    return replace(every, curves=(*others, own), marks=marks, title=title)


def _ends(curve: Curve, x: float, y: float) -> bool:
    """Whether a point belongs to a curve."""
    points = np.stack([curve.x, curve.y], axis=1)
    size = np.maximum(np.nanmax(np.abs(points), axis=0), 1.0)
    return bool((np.abs(points - (x, y)) < 1e-9 * size).all(axis=1).any())


# ----------------------------------------------------------------------
# The chart of a front: what a better value of the first goal costs in the others.


_TEXTS = 24  # numbers of designs that are written
_UP_RIGHT = (0.7, 0.7)


def front_chart(title: str, goals: Mapping[str, Sequence[float]], numbers: Sequence[int]) -> Chart:
    """The misses of the first goal against those of each other one.

    Parameters
    ----------
    title : str
    goals : Mapping[str, sequence of number]
        The misses of every goal, in the order of the designs.
    numbers : sequence of int
        The numbers of the designs.
    """
    (name, first), *others = ((name, np.array(own)) for name, own in goals.items())
    panels = tuple(
        Panel(
            axis=Axis(label=f"miss of {other}"),
            curves=(_curve(first, own, stairs=len(others) == 1),),
            marks=tuple(_front_chart_marks(first, own, numbers)),
        )
        for other, own in others
    )
    count = len(numbers)
    return Chart(
        title=title,
        caption=f"front of {count} design{'' if count == 1 else 's'}: "
        "no other one is better in every goal",
        axis=Axis(label=f"miss of {name}"),
        panels=panels,
        legend=(),
    )


def _curve(x: Array, y: Array, *, stairs: bool) -> Curve:
    """Stairs through the designs, each of which is the best one until the next; or no line.

    Pieces of two points stay straight, and those of one point are dots.
    """
    if stairs:
        gap = np.full(len(x) - 1, np.nan)
        along = np.stack([x[:-1], x[1:], gap, x[1:], x[1:], gap], axis=1)
        across = np.stack([y[:-1], y[:-1], gap, y[:-1], y[1:], gap], axis=1)
    else:
        gap = np.full(len(x), np.nan)
        along, across = np.stack([x, gap], axis=1), np.stack([y, gap], axis=1)
    return Curve(x=along.ravel(), y=across.ravel(), tone=1, name="front", quiet=True)


def _front_chart_marks(x: Array, y: Array, numbers: Sequence[int]) -> list[Mark]:
    every = -(-len(numbers) // _TEXTS)
    return [
        Mark(
            x=float(x[k]),
            y=float(y[k]),
            tone=1,
            kind="station",
            text="" if k % every else str(number),
            away=_UP_RIGHT,
        )
        for k, number in enumerate(numbers)
    ]
