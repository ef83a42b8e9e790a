"""A loop as a walk along its vectors: where one direction ends and the next begins is a pin.

A sum has no order, a loop has one. Both sides of an equation lead from one point to another, so
that the walk goes along the left side and comes back along the right one; or everything was moved
to one side, and the order is that in which it stands there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from linkwork.equations.model import LoopEquation, Term

__all__ = ["FRAME", "Phase", "Run", "Walk", "phase_of", "walks"]

#: The variable angles of a direction, each with its weight, in the order of their names.
Phase = tuple[tuple[str, float], ...]

#: The direction of vectors that do not turn.
FRAME: Phase = ()


def phase_of(term: Term) -> Phase:
    """The direction of a vector but for a constant angle."""
    return tuple(sorted(term.phase))


@dataclass(frozen=True)
class Run:
    """Vectors of one direction that follow each other."""

    phase: Phase
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Walk:
    """A closed walk: its runs in order, no two neighbours of one direction.

    The equation's first point is in the first run, behind ``begun`` of its vectors.
    """

    runs: tuple[Run, ...]
    begun: int


def walks(loop: LoopEquation) -> list[Walk]:
    """The walks that a loop may be meant as, the one that it is written as first.

    With both sides as two ways from one point, or with all on one side; a direction that is met
    more than once may have its vectors brought together.
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
