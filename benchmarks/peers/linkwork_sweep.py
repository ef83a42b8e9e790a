"""Linkwork's general way: ``mechanism.sweep`` for one mechanism after the other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

import linkwork as lw
from benchmarks.peers.dyad_linkage import Array, ComplexArray
from benchmarks.peers.loop_system import LoopSystem
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.work import Work

if TYPE_CHECKING:
    from linkwork.families import Family

__all__ = ["LinkworkSweep", "mechanism_of"]


class LinkworkSweep(Peer):
    """Sweeps with or without proof."""

    distribution = "linkwork"
    module = "linkwork"
    most_members = 10

    def __init__(self, *, certify: bool) -> None:
        self.certify = certify
        self.name = "linkwork, certified" if certify else "linkwork"

    def prepare(self, work: Work) -> Prepared:
        mechanisms = [mechanism_of(member.loops, work) for member in work.members]

        def run() -> list[lw.Motion]:
            return [mechanism.sweep(certify=self.certify) for mechanism in mechanisms]

        return Prepared(run=run, read=self._read)

    def _read(self, motions: list[lw.Motion]) -> ComplexArray:
        proved = [motion.certified | (not self.certify) for motion in motions]
        return np.array(
            [
                np.where(ok, motion.trace("T"), np.nan)[motion.asked]
                for ok, motion in zip(proved, motions, strict=True)
            ]
        )


#: Which coefficients are dimensions: (kind, loop, number) -> name.
Named = Mapping[tuple[str, int, int], str]


def mechanism_of(
    system: LoopSystem, work: Work, named: Named | None = None, traced: list[str] | None = None
) -> lw.Mechanism:
    """The loop equations as a user would write them, angles in degrees.

    ``traced``: the coefficients of the compared point as written, if they are not numbers.
    """
    named = named or {}
    first, last = (float(np.degrees(u)) for u in work.inputs[[0, -1]])
    unknowns = [f"x{k}" for k in range(system.angles)]
    slides = [f"s{k}" for k in range(system.unknowns - system.angles)]
    factors = {
        "turning": [f"e^(i*{x})" for x in unknowns],
        "sliding": slides,
        "crank": ["e^(i*u)"],
        "fixed": [""],
    }
    loops, dimensions = {}, {}
    for j in range(len(system.crank)):
        terms: list[tuple[str, str]] = []
        for kind, written in factors.items():
            for k, (c, factor) in enumerate(zip(_row(system, kind, j), written, strict=True)):
                name = named.get((kind, j, k))
                if name is not None:
                    dimensions[name] = float(c.real)
                    terms.append((name, factor))
                elif c != 0.0:
                    terms.append((_number(c), factor))
        loops[f"loop {j + 1}"] = _written(terms) + " = 0"
    factors_of_point = [*factors["turning"], "e^(i*u)", ""]
    numbers = traced or [_number(complex(c)) for c in system.traced]
    point = [
        (number, factor)
        for c, number, factor in zip(system.traced, numbers, factors_of_point, strict=True)
        if c != 0.0
    ]
    start = [*np.degrees(system.start[: system.angles]), *system.start[system.angles :]]
    return lw.loops(
        name=work.name,
        length="mm",
        angle="deg",
        dimensions=dimensions,
        loops=loops,
        guess={"u": first, **dict(zip([*unknowns, *slides], map(float, start), strict=True))},
        inputs=lw.Input(variable="u", from_=first, to=last, step=(last - first) / (work.rows - 1)),
        points={"T": _written(point)},
    )


def family_of(work: Work) -> Family:
    """All members as designs of the first one: coefficients that differ, and where they start.

    Raises
    ------
    ValueError
        If a coefficient that differs is not real, or the traced point is none of the loops' own.
    """
    systems = [member.loops for member in work.members]
    named, columns = {}, {}
    for kind in ("turning", "crank", "fixed"):
        values = np.array([np.atleast_2d(getattr(system, kind).T).T for system in systems])
        for j, k in zip(*np.nonzero((values != values[0]).any(axis=0)), strict=True):
            if np.any(values[:, j, k].imag):
                raise ValueError(f"{kind} {j}, {k} differs and is not real")
            name = f"{kind}_{j}_{k}"
            named[kind, int(j), int(k)] = name
            columns[name] = values[:, j, k].real
    starts = np.degrees([system.start for system in systems])
    guesses = {f"x{k}": starts[:, k] for k in range(systems[0].angles)}
    traced = [_traced_by(columns, column) for column in np.array([s.traced for s in systems]).T]
    return mechanism_of(systems[0], work, named, traced).family({**columns, **guesses})


def _traced_by(columns: Mapping[str, Array], values: ComplexArray) -> str:
    """A coefficient of the compared point as a number, or as one of the loops' own."""
    if (values == values[0]).all():
        return _number(complex(values[0]))
    for name, column in columns.items():
        for sign in ("", "-"):
            if np.array_equal(values, -column if sign else column):
                return sign + name
    raise ValueError("a coefficient of the traced point differs and is in no loop")


def _row(system: LoopSystem, kind: str, j: int) -> list[complex]:
    return [complex(c) for c in np.atleast_1d(getattr(system, kind)[j])]


def _number(c: complex) -> str:
    return f"{c.real:.17g}" if c.imag == 0.0 else f"({c.real:.17g}{c.imag:+.17g}*i)"


def _written(terms: list[tuple[str, str]]) -> str:
    parts = [f"{number}*{factor}" if factor else number for number, factor in terms]
    return " + ".join(f"({part})" if part.startswith("-") else part for part in parts)
