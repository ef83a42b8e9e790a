"""Charts of all circuits as closed curves over the input, and of a front of designs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from linkwork.circuits.results import Circuits
from linkwork.core.drawing.pose import printed_name
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import CircuitEnd
from linkwork.core.results.quantity import Kind
from linkwork.writers.charts.axes import ChartAxes, round_ticks
from linkwork.writers.charts.chart import Chart, Panel
from linkwork.writers.charts.columns import usual_columns, with_unit
from linkwork.writers.charts.lines import (
    Window,
    bounded_ends,
    covering,
    level_ends,
    repeated,
)

#: Maximum number of quantities shown by default.
MOST_PANELS = 6
_USUAL_COLUMNS, _MOST_COLUMNS = 3, 4


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
    shown = _quantities(circuits, names)
    count = len(circuits)
    return Chart(
        title=circuits.mechanism,
        caption=f"{count} circuit{'' if count == 1 else 's'}",
        panels=tuple(_panel(circuits, name) for name in shown),
    )


def branch_chart(circuits: Circuits, names: Sequence[str] = ()) -> Chart:
    """One panel for every branch, with all other branches behind it in grey.

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
    shown = _quantities(circuits, names)[: None if names else 1]
    branches = [branch for circuit in circuits for branch in circuit.branches]
    count = len(branches)
    if len(shown) > 1 and count > _MOST_COLUMNS:
        raise InputError(
            f'"{circuits.mechanism}" has {count} branches, too many for several '
            f"quantities: name one of {', '.join(names)}"
        )
    columns = count if len(shown) > 1 else _columns(count)
    titles = ["\n".join(filter(None, (b.name, b.configuration))) for b in branches]
    return replace(
        every,
        caption=f"{count} branch{'' if count == 1 else 'es'} in {every.caption}",
        panels=tuple(
            _panel(circuits, name, k, "" if row and count == columns else title)
            for row, name in enumerate(shown)
            for k, title in enumerate(titles)
        ),
        columns=columns,
    )


def _quantities(circuits: Circuits, names: Sequence[str]) -> tuple[str, ...]:
    """The quantities to show, without duplicates."""
    if not len(circuits):
        raise InputError(f'"{circuits.mechanism}" has no circuit to draw: {circuits.message}')
    motion = circuits[0].motion
    named = dict.fromkeys(motion.series(name).quantity.name for name in names)
    return tuple(named) or usual_columns(motion)[:MOST_PANELS]


def _columns(count: int) -> int:
    """The number of panels in a row."""
    if count == 4:
        return 2
    return max(1, min(count, _USUAL_COLUMNS if count <= _USUAL_COLUMNS**2 else _MOST_COLUMNS))


def _panel(circuits: Circuits, name: str, front: int | None = None, title: str = "") -> Panel:
    """One quantity along all circuits, with branch number ``front`` on top."""
    motion = circuits[0].motion
    quantity = motion.series(name).quantity
    label = with_unit(printed_name(name), motion.units.of(quantity.kind))
    return Panel(label=label, draw=partial(_draw, circuits, name, label, front, title))


def _draw(
    circuits: Circuits, name: str, label: str, front: int | None, title: str, axes: ChartAxes
) -> None:
    ax, motion = axes.ax, circuits[0].motion
    unit = motion.units.angle
    turning = circuits.input_unit == unit.value
    turn = unit.turn if motion.series(name).quantity.kind is Kind.ANGLE else 0.0
    tones: list[int] = []
    lines: list[tuple[Array, Array]] = []
    limits: list[Array] = []
    for tone, circuit in enumerate(circuits, start=1):
        for branch in circuit.branches:
            rows = np.array(circuit.motion.branch) == branch.name
            tones.append(tone)
            lines.append((circuit.motion[circuits.input][rows], circuit.motion[name][rows]))
            limits.append(np.array(circuit.motion.limit)[rows])
    across = Window(turn=unit.turn if turning else 0.0, whole=True)
    along = Window.around([y for _, y in lines], turn)
    shown = [repeated(x, y, across, along) for x, y in lines]
    below = covering(shown, tones) if front is None else [0] * len(lines)
    for k, (tone, line) in enumerate(zip(tones, shown, strict=True)):
        behind = front not in (None, k)
        of = circuits[tone - 1].name
        axes.curve(*line, of, tone, legend=front is None, below=below[k], quiet=behind)
        for kind in dict.fromkeys(filter(None, () if behind else limits[k].tolist())):
            axes.marks(*repeated(*lines[k], across, along, limits[k] == kind), kind, tone)
    axes.labels(with_unit(printed_name(circuits.input), circuits.input_unit), label, title)
    values = np.concatenate([y for _, y in shown])
    ends = along.ends if along.whole else level_ends(values, turn or 1.0)
    if not turn and any(c.end is CircuitEnd.RUNS_TO_INFINITY for c in circuits):
        ends = bounded_ends(shown)
    if ends is not None:
        ax.set_ylim(*ends)
    if turn:
        round_ticks(ax.yaxis, unit)
    if turning:
        axes.show_input(0.0, unit.turn)
        round_ticks(ax.xaxis, unit)


# ----------------------------------------------------------------------
# The chart of a front: how the other goals get worse as the first gets better.


_TEXTS = 24  # numbers of designs that are written
_UP_RIGHT = 0.7 + 0.7j


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
    count = len(numbers)
    first, *others = goals
    return Chart(
        title=title,
        caption=f"front of {count} design{'' if count == 1 else 's'}: "
        "no other one is better in every goal",
        panels=tuple(
            Panel(label=f"miss of {other}", draw=partial(_draw_front, goals, first, other, numbers))
            for other in others
        ),
    )


def _draw_front(
    goals: Mapping[str, Sequence[float]],
    first: str,
    other: str,
    numbers: Sequence[int],
    axes: ChartAxes,
) -> None:
    """Dots; of two goals with stairs through the designs, each the best one until the next."""
    places = np.array(goals[first]) + 1j * np.array(goals[other])
    if len(goals) == 2:
        colour = axes.theme.rule
        axes.ax.step(places.real, places.imag, where="post", color=colour, linewidth=1.0)
    axes.stations(places, 1)
    every = -(-len(numbers) // _TEXTS)
    for place, number in list(zip(places.tolist(), numbers, strict=True))[::every]:
        axes.station_text(str(number), place, _UP_RIGHT)
    axes.labels(f"miss of {first}", f"miss of {other}")
