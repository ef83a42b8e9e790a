"""Referee: designs of a family against the same designs built by themselves."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.foundation.errors import LinkworkError
from linkwork.motion.model import Model

__all__ = ["agree", "disagreement"]

RELATIVE = 1e-14  # of the longest link; rounding of a few operations


def agree(designs: Designs) -> None:
    """Every design is as it is by itself."""
    found = {k: text for k in range(len(designs)) if (text := disagreement(designs, k))}
    assert not found


def disagreement(designs: Designs, k: int) -> str:
    """How the k-th design differs from the one built by itself; empty if it does not."""
    try:
        alone = designs.design(k)
    except LinkworkError as error:
        return "" if designs.message(k) == str(error) else f"no problem, alone: {error}"
    other = designs.message(k)
    if other:
        return "" if "another structure" in other and _differs(designs.base, alone) else other
    return _coefficients(designs, k, alone)


def _coefficients(designs: Designs, k: int, alone: Model) -> str:
    base, equations = designs.base, alone.equations
    size = equations.length_scale
    tolerance = RELATIVE * size
    pairs = {
        "length_scale": (designs.length_scale[k], size, tolerance),
        "linear": (designs.linear[k], alone.compiled.table.linear.constant, 4 * tolerance),
        "link_angles": (designs.link_angles[k], [a.constant for a in equations.links.values()], RELATIVE),
        "start": (designs.start[k], equations.start, np.maximum(RELATIVE, RELATIVE * np.abs(equations.start))),
        "numbers": (designs.numbers[k], list(equations.dimensions.values()), None),
        "redundant": (designs.redundant[k], [r.length for r in equations.redundant], tolerance),
    }  # fmt: skip
    for name, (ours, theirs, allowed) in pairs.items():
        theirs = np.asarray(theirs, dtype=float)
        allowed = RELATIVE * np.abs(theirs) if allowed is None else allowed
        if np.shape(ours) != theirs.shape or (np.abs(ours - theirs) > allowed).any():
            return f"{name}: {ours} alone {theirs}"
    for name, rows, own, values in (
        ("loops", base.compiled.table.loops, alone.compiled.table.loops, designs.loops[k]),
        ("points", base.compiled.points.rows, alone.compiled.points.rows, designs.points[k]),
    ):
        ours, theirs = _by_key(rows, values), _by_key(own, own.coefficient)
        for key in ours.keys() | theirs.keys():
            mine, its = _padded(ours[key], theirs[key])
            if np.abs(mine - its).max(initial=0.0) > tolerance:
                return f"{name} {key}: {mine} alone {its}"
    return ""


def _by_key(rows, values):
    """Coefficients by row, variable length and weighted angles; like ones are interchangeable."""
    phases = defaultdict(list)
    for term, variable, weight in zip(rows.phase_term, rows.phase_variable, rows.phase_weight, strict=True):  # fmt: skip
        phases[term].append((variable, weight))
    found = defaultdict(list)
    for term, value in enumerate(values):
        key = (rows.row[term], rows.length[term], tuple(phases[term]))
        found[key].append(complex(value))
    return found


def _padded(ours, theirs):
    count = max(len(ours), len(theirs))
    padded = [values + [0j] * (count - len(values)) for values in (ours, theirs)]
    # sorted by a projection that tells different vectors of a mechanism apart
    return [np.array(sorted(p, key=lambda z: z.real + 0.7310585 * z.imag)) for p in padded]


def _differs(base: Model, alone: Model) -> bool:
    """Whether two models differ in what a family must share."""
    one, two = base.compiled.table, alone.compiled.table
    if base.equations.labels != alone.equations.labels or one.variables != two.variables:
        return True
    keys = [set(_by_key(t.loops, t.loops.coefficient)) for t in (one, two)]
    lines = [(t.linear.row, t.linear.variable, t.linear.weight) for t in (one, two)]
    if keys[0] != keys[1] or any(not np.array_equal(a, b) for a, b in zip(*lines, strict=True)):
        return True
    laws = zip(base.equations.laws, alone.equations.laws, strict=True)
    return any(
        (a.constant, a.offset) != (b.constant, b.offset)
        or not np.array_equal(a.law.powers, b.law.powers)
        or not np.array_equal(a.law.breaks, b.law.breaks)
        for a, b in laws
    )
