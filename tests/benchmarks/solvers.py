"""Peers with a known fault, for tests of the runner."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.peers.dyad_linkage import ComplexArray
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.work import Work

__all__ = ["Absent", "Answering", "Raising"]


class Answering(Peer):
    """Gives what a function makes of the work."""

    distribution = "numpy"
    module = "numpy"

    def __init__(self, name: str, answer: Callable[[Work], ComplexArray]) -> None:
        self.name = name
        self.answer = answer
        self.runs = 0

    def prepare(self, work: Work) -> Prepared:
        def run() -> ComplexArray:
            self.runs += 1
            return self.answer(work)

        return Prepared(run=run, read=lambda positions: positions)


class Raising(Peer):
    name = "raising"
    distribution = "numpy"
    module = "numpy"

    def prepare(self, work: Work) -> Prepared:
        raise ArithmeticError("no such linkage")


class Absent(Peer):
    name = "absent"
    distribution = "no-such-solver"
    module = "no_such_solver"

    def prepare(self, work: Work) -> Prepared:
        raise AssertionError("is not there")


def crossed(work: Work) -> ComplexArray:
    """All dyads on the other side."""
    linkages = work.dyads
    return np.array(
        [
            linkage.positions(work.inputs, [dyad.point for dyad in linkage.dyads])[linkage.traced]
            for linkage in linkages
        ]
    )


def right(work: Work) -> ComplexArray:
    """The closed form."""
    return np.array([linkage.positions(work.inputs)[linkage.traced] for linkage in work.dyads])
