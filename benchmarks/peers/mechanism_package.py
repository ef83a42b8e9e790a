"""The package ``mechanism``: vectors and a loop function, solved by ``fsolve`` row after row."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray, Dyad, DyadLinkage
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.rapier import RapierDrive
from benchmarks.peers.work import Member, Work

__all__ = ["MechanismPackage"]


class MechanismPackage(Peer):
    """``Mechanism.iterate``, positions only."""

    name = "mechanism"
    distribution = "mechanism"
    module = "mechanism"
    most_members = 5

    def cannot(self, work: Work) -> str:
        return "" if work.dyads or work.rapiers else "cannot: not written for it"

    def prepare(self, work: Work) -> Prepared:
        built = [_mechanism(member, work.inputs) for member in work.members]

        def run() -> None:
            for mechanism, _, _ in built:
                mechanism.iterate()

        def read(_: None) -> ComplexArray:
            return np.array(
                [joint.x_positions + 1j * joint.y_positions + origin for _, joint, origin in built]
            )

        return Prepared(run=run, read=read)


def _mechanism(member: Member, inputs: Array) -> tuple[Any, Any, complex]:
    """The mechanism, its traced joint, and where its origin lies."""
    if member.dyads is not None:
        return _of_dyads(member.dyads, member.loops.start, inputs)
    if member.rapier is not None:
        return _of_rapier(member.rapier, member.loops.start, inputs)
    raise ValueError("no chain of dyads and no rapier drive")


def _of_dyads(linkage: DyadLinkage, start: Array, inputs: Array) -> tuple[Any, Any, complex]:
    return _Vectors(linkage, inputs).mechanism(start)


#: A vector, the number of its unknown angle (``INPUT`` the crank's, None fixed), and a turn added.
Step = tuple[Any, int | None, float]
INPUT = -1


class _Vectors:
    """The vectors of a crank and dyads, and how each point is reached from the crank's pivot."""

    def __init__(self, linkage: DyadLinkage, inputs: Array) -> None:
        self.package = import_module("mechanism")
        self.linkage = linkage
        self.inputs = inputs
        at = linkage.positions(inputs[:1])
        self.at = {name: complex(point.reshape(-1)[0]) for name, point in at.items()}
        self.joints = {name: self.package.Joint(name) for name in self.at}
        self.vectors: list[Any] = []
        self.ways: dict[str, list[Step]] = {linkage.pivot: []}
        self.angles: dict[tuple[str, str], int] = {}  # of bars by their ends
        self.closed: list[tuple[list[Step], list[Step]]] = []
        for name in linkage.ground:
            if name != linkage.pivot:
                away = self.at[name] - self.at[linkage.pivot]
                self._go(linkage.pivot, name, abs(away), None, theta=float(np.angle(away)))
        self._go(linkage.pivot, linkage.pin, linkage.radius, INPUT)
        for dyad in linkage.dyads:
            self._place(dyad)

    def _place(self, dyad: Dyad) -> None:
        if dyad.rigid:
            one, other, point = (self.at[n] for n in (dyad.first, dyad.second, dyad.point))
            turn = float(np.angle((point - one) / (other - one)))
            angle = self.angles[dyad.first, dyad.second]
            self._go(dyad.first, dyad.point, dyad.first_length, angle, turn)
            return
        ends = ((dyad.first, dyad.first_length), (dyad.second, dyad.second_length))
        for base, length in ends:
            angle = self.angles[base, dyad.point] = len(self.angles)
            self._go(base, dyad.point, length, angle)
            if base == dyad.first:
                there = self.ways[dyad.point]
        self.closed.append((there, self.ways[dyad.point]))

    def _go(
        self,
        base: str,
        point: str,
        length: float | Array,
        angle: int | None,
        turn: float = 0.0,
        **fixed: float,
    ) -> None:
        """Add a vector; from now on the point is reached by it."""
        ends = (self.joints[base], self.joints[point])
        vector = self.package.Vector(ends, r=float(length), **fixed)
        self.vectors.append(vector)
        self.ways[point] = [*self.ways[base], (vector, angle, turn)]

    def mechanism(self, start: Array) -> tuple[Any, Any, complex]:
        """The mechanism, its traced joint, and where its origin lies."""
        used = {id(step[0]) for pair in self.closed for way in pair for step in way}
        last = [way[-1] for way in self.ways.values() if way]
        outside = [step for step in last if id(step[0]) not in used]

        def loops(x: Array, i: float) -> Array:
            gaps = [_along(there, x, i) - _along(back, x, i) for there, back in self.closed]
            _along(outside, x, i)  # calling a vector sets it, also outside all loops
            return np.concatenate(gaps)

        linkage = self.linkage
        origin = self.joints[linkage.pivot]
        mechanism = self.package.Mechanism(
            vectors=self.vectors, origin=origin, loops=loops, pos=self.inputs, guess=(start,)
        )
        return mechanism, self.joints[linkage.traced], self.at[linkage.pivot]


def _along(way: list[Step], x: Array, i: float) -> Array:
    total = np.zeros(2)
    for vector, angle, turn in way:
        if angle is None:
            total += vector()
        else:
            total += vector((i if angle == INPUT else x[angle]) + turn)
    return total


def _of_rapier(drive: RapierDrive, start: Array, inputs: Array) -> tuple[Any, Any, complex]:
    package = import_module("mechanism")
    a0, a, b, c, c0, d, foot = map(package.Joint, ("A0", "A", "B", "C", "C0", "D", "foot"))
    drop = 1j * drive.slide
    vector = package.Vector
    crank = vector((a0, a), r=drive.crank)
    rod = vector((a, b), r=drive.rod)
    to_rod = vector((c, b), r=drive.to_rod)
    rocker = vector((c0, c), r=drive.rocker)
    to_slide = vector((c, d), r=drive.to_slide)
    frame = vector((a0, c0), r=abs(drive.pivot), theta=float(np.angle(drive.pivot)))
    down = vector((a0, foot), r=abs(drop), theta=float(np.angle(drop)))
    slide = vector((foot, d), theta=0.0)

    def loops(x: Array, i: float) -> Array:
        c_at = frame() + rocker(x[2])
        return np.concatenate(
            (
                crank(i) + rod(x[0]) - c_at - to_rod(x[1]),
                c_at + to_slide(x[1] + np.pi) - down() - slide(x[3]),
            )
        )

    mechanism = package.Mechanism(
        vectors=[crank, rod, to_rod, rocker, to_slide, frame, down, slide],
        origin=a0,
        loops=loops,
        pos=inputs,
        guess=(start,),
    )
    return mechanism, d, 0.0
