"""Straight guides of points in a mechanism given by loop equations."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import product

from linkwork.core.equations.model import LoopEquations, Term
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.skeleton import Rail

_MOST_LOOPS = 4  # up to so many loops are combined; of more, each is tried by itself
_LEAST = 1e-12  # relative to the largest term: smaller ones are the rounding of a difference

#: A sum of vectors: length variable and phase -> value.
_Sum = dict[tuple[object, ...], complex]


def rails_of(equations: LoopEquations, links: Mapping[str, tuple[str, ...]]) -> Iterator[Rail]:
    """The rails of a mechanism, each with the variable that measures a point's distance along it.

    A point runs along a rail if its place is a constant and a length times a constant vector; along
    a link, if it is a length away from one of its points in the link's direction: as formulas have
    it, or after loop equations are added to it or subtracted.
    """
    lengths = {v.symbol: v.name for v in equations.variables if v.kind == "length"}
    loops = [_sum(loop.terms) for loop in equations.loops]
    if not any(key[0] in lengths for loop in loops for key in loop):
        return
    places = {name: _sum(point.terms) for name, point in equations.points.items()}
    rails: dict[tuple[str, complex], list[str]] = {}
    on_links: list[Rail] = []
    for name, place in places.items():
        for way in _ways(place, loops):
            moving = [key for key in way if key[0] is not None or key[1]]
            if len(moving) == 1 and moving[0][0] in lengths and not moving[0][1]:
                vector = way[moving[0]]
                rails.setdefault((lengths[str(moving[0][0])], vector / abs(vector)), []).append(
                    name
                )
                break
        else:
            on_links += _on_links(name, places, links, lengths, loops)
    for (variable, along), points in rails.items():
        yield Rail(name=variable, points=tuple(points), along=along)
    yield from on_links


def _on_links(
    name: str,
    places: Mapping[str, _Sum],
    links: Mapping[str, tuple[str, ...]],
    lengths: Mapping[str, str],
    loops: list[_Sum],
) -> Iterator[Rail]:
    """Rails on links along which a point moves."""
    for link, points in links.items():
        if link == GROUND or name in points or len(points) < 2:
            continue
        foot, tip = points[:2]
        line = _add([(1, places[tip]), (-1, places[foot])])
        if len(line) != 1:
            continue
        ((length, turn),) = line
        if length is not None or not turn:
            continue
        for way in _ways(_add([(1, places[name]), (-1, places[foot])]), loops):
            if len(way) == 1:
                ((far, way_turn),) = way
                if far in lengths and turn == way_turn:
                    yield Rail(name=lengths[str(far)], points=(name,), on=link, line=(foot, tip))
                    break


def _sum(terms: Iterable[Term]) -> _Sum:
    return _add([(1, {(term.length, term.phase): term.value}) for term in terms])


def _add(parts: Iterable[tuple[int, _Sum]]) -> _Sum:
    """Add sums of vectors, each with its sign, and drop the terms that cancel."""
    total: _Sum = {}
    largest = 0.0
    for sign, part in parts:
        for key, value in part.items():
            total[key] = total.get(key, 0j) + sign * value
            largest = max(largest, math.hypot(value.real, value.imag))
    return {
        key: value
        for key, value in total.items()
        if math.hypot(value.real, value.imag) > _LEAST * largest
    }


def _ways(place: _Sum, loops: list[_Sum]) -> Iterator[_Sum]:
    """The place of a point with loop equations added or subtracted, its own formula first."""
    if len(loops) > _MOST_LOOPS:
        yield place
        for loop in loops:
            yield _add([(1, place), (1, loop)])
            yield _add([(1, place), (-1, loop)])
        return
    signs = product((0, 1, -1), repeat=len(loops))
    for chosen in sorted(signs, key=lambda one: sum(map(abs, one))):
        yield _add([(1, place), *zip(chosen, loops, strict=True)])
