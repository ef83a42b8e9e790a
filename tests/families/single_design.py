"""Referee: designs of a family against the same designs built by themselves."""

from __future__ import annotations

import re
from collections import defaultdict
from functools import partial

import numpy as np

from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import LinkworkError
from linkwork.core.motion.model import Model
from linkwork.core.table.rows import PhasorRows
from linkwork.families.building import Designs

__all__ = ["agree", "disagreement"]

RELATIVE = 1e-14  # of the longest link or of a radian: rounding of a few operations


def agree(designs: Designs, relative: float = RELATIVE) -> None:
    """Every design is as it is by itself."""
    told = ((k, disagreement(designs, k, relative)) for k in range(len(designs)))
    assert not [(k, text) for k, text in told if text]


def disagreement(designs: Designs, k: int, relative: float = RELATIVE) -> str:
    """How the k-th design differs from the one built by itself; empty if it does not."""
    kind = designs.problems[designs.problem[k]]
    if kind:
        arrays = (designs.loops, designs.linear, designs.points, designs.start, designs.link_angles)
        if not all(np.isnan(array[k]).all() for array in arrays):
            return f"has coefficients, and the problem {kind}"
    try:
        alone = designs.design(k)
    except LinkworkError as error:
        if "another structure" in kind:  # laws of its own, of which only the message tells more
            return "" if designs.message(k) == str(error) else f"{kind!r}, alone: {error}"
        same = re.fullmatch(re.escape(kind).replace("…", ".*"), str(error), re.DOTALL)
        return "" if same and designs.message(k) == str(error) else f"{kind!r}, alone: {error}"
    if kind:
        other = "another structure" in kind and _other_structure(designs.base, alone)
        return "" if other and designs.message(k) == kind else kind
    return _other_numbers(designs, k, alone, relative)


def _other_numbers(designs: Designs, k: int, alone: Model, relative: float) -> str:
    base, equations = designs.base, alone.equations
    angles = [angle.constant for angle in equations.links.values()]
    lengths = [part.length for part in equations.redundant]
    size, known = equations.length_scale, list(equations.dimensions.values())
    for name, ours, theirs, scale in (
        ("length_scale", designs.length_scale[k], size, size),
        ("linear", designs.linear[k], alone.compiled.table.linear.constant, max(size, 4.0)),
        ("link_angles", designs.link_angles[k], angles, 1.0),
        ("start", designs.start[k], equations.start, np.maximum(np.abs(equations.start), 1.0)),
        ("numbers", designs.numbers[k], known, np.abs(known)),
        ("redundant", designs.redundant[k], lengths, size),
    ):
        gap = np.abs(ours - np.asarray(theirs, dtype=float))
        if not (gap <= relative * np.asarray(scale)).all():
            return f"{name}: {ours} alone {theirs}"
    if _other_laws(base, alone):
        return "other laws, and no problem"
    table, own = base.compiled, alone.compiled
    for name, rows, values, other in (
        ("loops", table.table.loops, designs.loops[k], own.table.loops),
        ("points", table.points.rows, designs.points[k], own.points.rows),
    ):
        mine, its = _by_key(rows, values), _by_key(other, other.coefficient)
        for key in mine.keys() | its.keys():
            gap = _gap(mine[key], its[key])
            if not gap <= relative * size:
                return f"{name} {key}: {mine[key]} alone {its[key]}"
    return ""


def _by_key(rows: PhasorRows, values: ComplexArray) -> dict[tuple[object, ...], list[complex]]:
    """Coefficients by row, variable length and weighted angles; like ones are interchangeable."""
    phases: defaultdict[int, list[tuple[int, float]]] = defaultdict(list)
    entries = zip(rows.phase_term, rows.phase_variable, rows.phase_weight, strict=True)
    for term, variable, weight in entries:
        phases[term].append((variable, weight))
    found: defaultdict[tuple[object, ...], list[complex]] = defaultdict(list)
    for term, value in enumerate(values):
        key = (rows.row[term], rows.length[term], tuple(phases[term]))
        found[key].append(complex(value))
    return found


def _apart(one: complex, other: complex) -> float:
    return abs(other - one)


def _gap(ours: list[complex], theirs: list[complex]) -> float:
    """The largest difference of like coefficients; one that is not there is 0."""
    count = max(len(ours), len(theirs))
    mine = ours + [0j] * (count - len(ours))
    left = theirs + [0j] * (count - len(theirs))
    worst = 0.0
    for value in mine:
        nearest = min(left, key=partial(_apart, value))
        left.remove(nearest)
        worst = max(worst, abs(nearest - value))
    return worst


def _other_structure(base: Model, alone: Model) -> bool:
    """Whether two models differ in what a family must share."""
    one, two = base.compiled.table, alone.compiled.table
    names = [[(v.symbol, v.kind) for v in model.equations.variables] for model in (base, alone)]
    if base.equations.labels != alone.equations.labels or names[0] != names[1]:
        return True
    keys = [
        {key: len(terms) for key, terms in _by_key(t.loops, t.loops.coefficient).items()}
        for t in (one, two)
    ]
    lines = [(t.linear.row, t.linear.variable, t.linear.weight) for t in (one, two)]
    if keys[0] != keys[1] or any(not np.array_equal(a, b) for a, b in zip(*lines, strict=True)):
        return True
    return _other_laws(base, alone)


def _other_laws(base: Model, alone: Model) -> bool:
    laws = zip(base.equations.laws, alone.equations.laws, strict=True)
    return any(
        (a.constant, a.offset) != (b.constant, b.offset)
        or not np.array_equal(a.law.powers, b.law.powers)
        or not np.array_equal(a.law.breaks, b.law.breaks)
        for a, b in laws
    )
