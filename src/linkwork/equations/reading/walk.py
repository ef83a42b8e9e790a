"""A loop as a walk along its vectors, with a pin wherever the direction changes.

A sum has no order, a loop has one. Both sides of an equation are paths between the same two points:
the walk follows the left side and returns along the right side. If all terms are on one side, their
written order is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from linkwork.equations.model import LoopEquation, Term

__all__ = ["FRAME", "Phase", "Run", "Walk", "phase_of", "walks"]

#: The variable angles of a direction with their weights, ordered by name.
Phase = tuple[tuple[str, float], ...]

#: The direction of fixed vectors.
FRAME: Phase = ()


def phase_of(term: Term) -> Phase:
    """The direction of a vector up to a constant angle."""
    return tuple(sorted(term.phase))


@dataclass(frozen=True)
class Run:
    """Consecutive vectors of the same direction."""

    phase: Phase
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Walk:
    """A closed walk: its runs in order, adjacent runs with different directions.

    The equation's first point is in the first run, after ``begun`` of its vectors.
    """

    runs: tuple[Run, ...]
    begun: int


def walks(loop: LoopEquation) -> list[Walk]:
    """The possible walks of a loop, beginning with the written one.

    Either both sides are two paths from one point, or all terms are on one side; repeated
    directions may have their vectors merged.
    """
    right = [term.negated() for term in loop.right]
    found: dict[Walk, None] = {}
    for terms in ([*loop.left, *reversed(right)], [*loop.left, *right]):
        walk = _walk(terms)
        found.setdefault(walk)
        phases = [run.phase for run in walk.runs]
        if len(set(phases)) < len(phases):
            found.setdefault(_walk(list(_together(terms))))
    return list(found)


def _together(terms: Sequence[Term]) -> Iterator[Term]:
    for phase in dict.fromkeys(map(phase_of, terms)):
        yield from (term for term in terms if phase_of(term) == phase)


def _walk(terms: Sequence[Term]) -> Walk:
    runs = [Run(phase, tuple(group)) for phase, group in groupby(terms, phase_of)]
    if len(runs) > 1 and runs[0].phase == runs[-1].phase:
        last = runs.pop()
        runs[0] = Run(last.phase, (*last.terms, *runs[0].terms))
        return Walk(tuple(runs), len(last.terms))
    return Walk(tuple(runs), 0)
