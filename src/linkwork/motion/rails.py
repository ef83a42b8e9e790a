"""Straight lines on ground that points of a mechanism given by loop equations run along."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product

from linkwork.equations.model import LoopEquations, Term
from linkwork.mechanism.skeleton import Rail

__all__ = ["rails_of"]

_MOST_LOOPS = 4  # that are combined: more are looked at one by one
_LEAST = 1e-12  # of the largest: rounding of terms that cancel

#: A sum of vectors: length variable and phase -> value.
_Sum = dict[tuple[object, ...], complex]


def rails_of(equations: LoopEquations) -> Iterator[Rail]:
    """Rails by the variable that tells how far a point is along them.

    A point runs along a rail if its place is a constant and a length times a constant vector: as
    its formula has it, or after loop equations are added to it or subtracted.
    """
    lengths = {v.symbol: v for v in equations.variables if v.kind == "length"}
    loops = [_sum(loop.terms) for loop in equations.loops]
    if not any(key[0] in lengths and not key[1] for loop in loops for key in loop):
        return
    rails: dict[tuple[str, complex], list[str]] = {}
    for name, point in equations.points.items():
        for place in _ways(_sum(point.terms), loops):
            moving = [key for key in place if key[0] is not None or key[1]]
            if len(moving) == 1 and moving[0][0] in lengths and not moving[0][1]:
                vector = place[moving[0]]
                along = vector / abs(vector)
                rails.setdefault((str(moving[0][0]), along), []).append(name)
                break
    for (symbol, along), points in rails.items():
        yield Rail(name=lengths[symbol].name, points=tuple(points), along=along)


def _sum(terms: Iterable[Term]) -> _Sum:
    return _added([(1, {(term.length, term.phase): term.value}) for term in terms])


def _added(parts: Iterable[tuple[int, _Sum]]) -> _Sum:
    """A sum of sums, without what cancels."""
    total: _Sum = {}
    largest = 0.0
    for sign, part in parts:
        for key, value in part.items():
            total[key] = total.get(key, 0j) + sign * value
            largest = max(largest, abs(value))
    return {key: value for key, value in total.items() if abs(value) > _LEAST * largest}


def _ways(place: _Sum, loops: list[_Sum]) -> Iterator[_Sum]:
    """The place of a point with loop equations added or subtracted, its own formula first."""
    yield place
    if len(loops) > _MOST_LOOPS:
        for loop in loops:
            yield _added([(1, place), (1, loop)])
            yield _added([(1, place), (-1, loop)])
        return
    signs = product((0, 1, -1), repeat=len(loops))
    for chosen in sorted(signs, key=lambda one: sum(map(abs, one))):
        yield _added([(1, place), *zip(chosen, loops, strict=True)])
