"""Linkwork's general way: ``mechanism.sweep`` for one mechanism after the other."""

from __future__ import annotations

import numpy as np

import linkwork as lw
from benchmarks.peers.dyad_linkage import ComplexArray
from benchmarks.peers.loop_system import LoopSystem
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.work import Work

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


def mechanism_of(system: LoopSystem, work: Work) -> lw.Mechanism:
    """The loop equations as a user would write them, angles in degrees."""
    first, last = (float(np.degrees(u)) for u in work.inputs[[0, -1]])
    unknowns = [f"x{k}" for k in range(system.angles)]
    slides = [f"s{k}" for k in range(system.unknowns - system.angles)]
    loops = {}
    for j, (turning, sliding) in enumerate(zip(system.turning, system.sliding, strict=True)):
        terms = [(c, f"e^(i*{x})") for c, x in zip(turning, unknowns, strict=True)]
        terms += list(zip(sliding, slides, strict=True))
        terms += [(system.crank[j], "e^(i*u)"), (system.fixed[j], "")]
        loops[f"loop {j + 1}"] = _written(terms) + " = 0"
    traced = [(c, f"e^(i*{x})") for c, x in zip(system.traced, [*unknowns, "u"], strict=False)]
    start = [*np.degrees(system.start[: system.angles]), *system.start[system.angles :]]
    return lw.loops(
        name=work.name,
        length="mm",
        angle="deg",
        loops=loops,
        guess={"u": first, **dict(zip([*unknowns, *slides], map(float, start), strict=True))},
        inputs=lw.Input(
            variable="u", start=first, stop=last, step=(last - first) / (work.rows - 1)
        ),
        points={"T": _written([*traced, (system.traced[-1], "")])},
    )


def _written(terms: list[tuple[complex, str]]) -> str:
    parts = []
    for c, factor in terms:
        if c == 0.0:
            continue
        number = f"{c.real:.17g}" if c.imag == 0.0 else f"({c.real:.17g}{c.imag:+.17g}*i)"
        parts.append(f"{number}*{factor}" if factor else number)
    return " + ".join(f"({part})" if part.startswith("-") else part for part in parts)
