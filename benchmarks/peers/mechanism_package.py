"""The package ``mechanism``: vectors and a loop function, solved by ``fsolve`` row after row."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray, DyadLinkage
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.rapier import RapierDrive
from benchmarks.peers.work import Member, Work

__all__ = ["MechanismPackage"]

Loops = Callable[[Array, float], Array]


class MechanismPackage(Peer):
    """``Mechanism.iterate``, positions only."""

    name = "mechanism"
    distribution = "mechanism"
    module = "mechanism"
    most_members = 5

    def cannot(self, work: Work) -> str:
        if work.dyads:
            return "" if len(work.dyads[0].dyads) <= 9 else "cannot: joints too far from its origin"
        return "" if work.rapiers else "cannot: not written for it"

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
    package = import_module("mechanism")
    joints = {name: package.Joint(name) for name in (*linkage.ground, linkage.pin)}
    ground = {name: complex(np.reshape(p, -1)[0]) for name, p in linkage.ground.items()}
    at = linkage.positions(inputs[:1])
    origin = ground[linkage.pivot]
    crank = package.Vector((joints[linkage.pivot], joints[linkage.pin]), r=float(linkage.radius))
    vectors, frame = [crank], {}
    for name, place in ground.items():
        if name != linkage.pivot:
            away = place - origin
            frame[name] = package.Vector(
                (joints[linkage.pivot], joints[name]), r=abs(away), theta=float(np.angle(away))
            )
            vectors.append(frame[name])
    #: How each point is reached from the pivot: vectors with their unknown angle and a turn.
    ways: dict[str, list[tuple[Any, int | None, float]]] = {linkage.pivot: []}
    ways.update({name: [(vector, None, 0.0)] for name, vector in frame.items()})
    crank_step: tuple[Any, int | None, float] = (crank, -1, 0.0)
    ways[linkage.pin] = [crank_step]
    bars: dict[tuple[str, str], int] = {}
    closed: list[tuple[list[Any], list[Any]]] = []
    unknowns = 0
    for dyad in linkage.dyads:
        joints[dyad.point] = package.Joint(dyad.point)
        if dyad.rigid:
            one, other, point = (
                complex(at[n].reshape(-1)[0]) for n in (dyad.first, dyad.second, dyad.point)
            )
            turn = float(np.angle((point - one) / (other - one)))
            side = package.Vector(
                (joints[dyad.first], joints[dyad.point]), r=float(dyad.first_length)
            )
            vectors.append(side)
            angle = bars[dyad.first, dyad.second]
            ways[dyad.point] = [*ways[dyad.first], (side, angle, turn)]
            continue
        one_bar = package.Vector(
            (joints[dyad.first], joints[dyad.point]), r=float(dyad.first_length)
        )
        other_bar = package.Vector(
            (joints[dyad.second], joints[dyad.point]), r=float(dyad.second_length)
        )
        vectors += [one_bar, other_bar]
        bars[dyad.first, dyad.point], bars[dyad.second, dyad.point] = unknowns, unknowns + 1
        there = [*ways[dyad.first], (one_bar, unknowns, 0.0)]
        ways[dyad.point] = [*ways[dyad.second], (other_bar, unknowns + 1, 0.0)]
        closed.append((there, ways[dyad.point]))
        unknowns += 2
    loose = [(way[-1]) for point, way in ways.items() if way and _hangs(point, linkage)]

    def loops(x: Array, i: float) -> Array:
        def along(way: list[Any]) -> Array:
            total = np.zeros(2)
            for vector, angle, turn in way:
                if angle is None:
                    total += vector()
                else:
                    total += vector((i if angle < 0 else x[angle]) + turn)
            return total

        gaps = np.array([along(there) - along(back) for there, back in closed])
        for vector, angle, turn in loose:  # outside all loops, set all the same
            vector(x[angle] + turn)
        return gaps.ravel()

    mechanism = package.Mechanism(
        vectors=vectors, origin=joints[linkage.pivot], loops=loops, pos=inputs, guess=(start,)
    )
    return mechanism, joints[linkage.traced], origin


def _hangs(point: str, linkage: DyadLinkage) -> bool:
    """Whether a rigid point carries nothing further, so that no loop sets its vector."""
    rigid = any(dyad.point == point and dyad.rigid for dyad in linkage.dyads)
    return rigid and not any(point in (dyad.first, dyad.second) for dyad in linkage.dyads)


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
