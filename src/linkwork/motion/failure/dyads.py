"""Dyads in closed form: the closure gap and the positions of one loop with two unknowns.

RRR   K + a e^{iα} + b e^{iβ} = 0      closes if |a - b| ≤ |K| ≤ a + b
RRP   K + a e^{iα} + s u = 0           closes if the line K + s u comes within a of the origin
RPR   K + (c + s d) e^{iα} = 0         closes if |K| is at least the distance of the line c + s d
PP    K + s u + t v = 0                always closes, once, unless the lines are parallel
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field, replace

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.elementwise import phase
from linkwork.kernels.loop_table import LoopTable
from linkwork.numerics.block_solver import Block

__all__ = ["Dyad", "dyad_of"]

_TOUCHING = 1e-14  # relative: a gap of rounding closes, once


@dataclass
class _Sums:
    """The terms of the loop, sorted by their angle and their length; keys are unknowns."""

    known: complex = 0j
    turning: dict[int, complex] = field(default_factory=dict)
    sliding: dict[int, complex] = field(default_factory=dict)
    both: dict[tuple[int, int], complex] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Dyad:
    """``gap``: the length that is missing, 0 if it closes. ``roots`` (K, 2): its positions;
    ``all_roots``: whether these are all. Otherwise it turns freely about a pin that meets another.
    """

    kind: str
    gap: float
    roots: Array
    all_roots: bool = True


def dyad_of(block: Block, v: Array) -> Dyad | None:
    """The block as a dyad, for the known variables among v (N,); ``None`` if it is no dyad."""
    table = block.system
    if not isinstance(table, LoopTable) or table.unknowns != 2 or table.loops.rows != 1:
        return None
    if table.functions or len(table.linear.constant):
        return None
    sums = _sums(table, v[block.variables])
    if sums is None:
        return None
    turns = [bool(turn) for turn in table.is_angle[:2]]
    if all(turns) and not sums.both and len(sums.turning) == 2:
        return _two_links(sums.known, sums.turning[0], sums.turning[1])
    if not any(turns):
        return _two_slides(sums.known, sums.sliding.get(0, 0j), sums.sliding.get(1, 0j))
    angle, length = (0, 1) if turns[0] else (1, 0)
    found = None
    if not sums.both:
        found = _on_a_line(sums.known, sums.turning.get(angle, 0j), sums.sliding.get(length, 0j))
    elif not sums.sliding:
        slide = sums.both[angle, length]
        found = _turning_line(sums.known, sums.turning.get(angle, 0j), slide)
    if found is None or angle == 0:
        return found
    return replace(found, roots=found.roots[:, ::-1])


def _sums(table: LoopTable, v: Array) -> _Sums | None:
    loops, sums = table.loops, _Sums()
    for t, coefficient in enumerate(loops.coefficient):
        value, angle = complex(coefficient), None
        for e in np.flatnonzero(loops.phase_term == t):
            variable, weight = int(loops.phase_variable[e]), float(loops.phase_weight[e])
            # known variables come behind the two unknowns: they become part of the coefficient
            if variable >= 2:
                value *= cmath.exp(1j * weight * float(v[variable]))
            elif weight == 1.0 and angle is None:
                angle = variable
            else:
                return None
        length = int(loops.length[t])
        if length >= 2:
            value *= float(v[length])
        if length < 2 and length >= 0:
            if angle is None:
                sums.sliding[length] = sums.sliding.get(length, 0j) + value
            else:
                sums.both[angle, length] = sums.both.get((angle, length), 0j) + value
        elif angle is not None:
            sums.turning[angle] = sums.turning.get(angle, 0j) + value
        else:
            sums.known += value
    return sums


def _dyad(kind: str, gap: float, size: float, roots: list[tuple[float, float]]) -> Dyad:
    if gap > _TOUCHING * size:
        return Dyad(kind=kind, gap=gap, roots=np.zeros((0, 2)))
    return Dyad(kind=kind, gap=0.0, roots=np.array(roots, dtype=float).reshape(-1, 2))


def _two_links(known: complex, first: complex, second: complex) -> Dyad:
    d, a, b = abs(known), abs(first), abs(second)
    gap = max(d - (a + b), abs(a - b) - d)  # eq. (54)
    size = max(d, a, b)
    if d == 0.0 or a == 0.0 or b == 0.0:  # no triangle: none, or a position for every angle
        return replace(_dyad("RRR", gap, size, []), all_roots=gap > _TOUCHING * size)
    # the first link makes the angle ±ε with the vector -K that both have to span
    cosine = (d * d + (a - b) * (a + b)) / (2.0 * d * a)  # eq. (54) without cancellation
    # only rounding can leave [-1, 1] where the gap is none; other roots are dropped by the gap
    swing = math.acos(max(-1.0, min(1.0, cosine)))
    roots = []
    for side in (1.0, -1.0) if swing not in (0.0, math.pi) else (1.0,):
        one = -known / d * cmath.exp(1j * side * swing) * a
        other = -known - one
        roots.append((phase(one / first), phase(other / second)))
    return _dyad("RRR", gap, size, roots)


def _on_a_line(known: complex, link: complex, along: complex) -> Dyad | None:
    u, a = abs(along), abs(link)
    if u == 0.0 or a == 0.0:
        return None
    beside = (known * along.conjugate()).imag / u
    middle = -(known * along.conjugate()).real / u
    half = math.sqrt(max(0.0, (a - abs(beside)) * (a + abs(beside))))  # eq. (55)
    roots = []
    for side in (1.0, -1.0) if half else (1.0,):
        s = (middle + side * half) / u
        roots.append((phase(-(known + s * along) / link), s))
    return _dyad("RRP", abs(beside) - a, max(a, abs(known)), roots)


def _turning_line(known: complex, arm: complex, along: complex) -> Dyad | None:
    u, d = abs(along), abs(known)
    if u == 0.0:
        return None
    beside = (arm * along.conjugate()).imag / u
    middle = -(arm * along.conjugate()).real / u
    half = math.sqrt(max(0.0, (d - abs(beside)) * (d + abs(beside))))  # eq. (55)
    roots = []
    for side in (1.0, -1.0) if half else (1.0,):
        s = (middle + side * half) / u
        reach = arm + s * along
        if reach != 0:
            roots.append((phase(-known / reach), s))
    found = _dyad("RPR", abs(beside) - d, max(d, abs(arm)), roots)
    return replace(found, all_roots=bool(roots) or found.gap > 0.0)


def _two_slides(known: complex, first: complex, second: complex) -> Dyad | None:
    area = (first.conjugate() * second).imag
    # parallel lines meet nowhere or everywhere
    if abs(area) <= _TOUCHING * abs(first) * abs(second):
        return None
    s = -(known * second.conjugate()).imag / (first * second.conjugate()).imag
    t = -(known * first.conjugate()).imag / (second * first.conjugate()).imag
    return _dyad("PP", 0.0, 1.0, [(s, t)])
