"""Small multiples: one panel for every branch of every circuit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwork.drawing.charts.chart import Axis, Chart, Curve, Panel
from linkwork.drawing.charts.circuit_chart import circuit_chart
from linkwork.foundation.errors import InputError
from linkwork.results.circuits import Branch, Circuits

__all__ = ["branch_chart"]

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
        _panel(panel, branch, k, titled=row == 0 or count > columns)
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


def _panel(every: Panel, branch: Branch, k: int, *, titled: bool) -> Panel:
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
