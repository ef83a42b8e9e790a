"""CasADi's ``fast_newton`` root finder, mapped over all rows inside CasADi."""

from __future__ import annotations

import atexit
import shutil
import tempfile
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.work import Member, Work

__all__ = ["CasadiNewton"]


class CasadiNewton(Peer):
    """In CasADi's own virtual machine, or as C code where a compiler is installed."""

    distribution = "casadi"
    module = "casadi"

    def __init__(self, *, compiled: bool) -> None:
        self.compiled = compiled
        self.name = "casadi fast_newton, C" if compiled else "casadi fast_newton"
        self.most_members = None if compiled else 200

    def missing(self) -> str:
        if self.compiled and shutil.which("gcc") is None:
            return super().missing() or "no C compiler (gcc)"
        return super().missing()

    def prepare(self, work: Work) -> Prepared:
        follow = _follow(work, self.compiled)
        starts = [member.loops.start for member in work.members]
        inputs = work.inputs.reshape(1, -1)
        numbers = _numbers(work)

        def run() -> list[Any]:
            return [follow(q, inputs, c) for q, c in zip(starts, numbers, strict=True)]

        def read(rows: list[Any]) -> ComplexArray:
            return np.array(
                [
                    member.loops.trace(np.array(q).T, work.inputs)
                    for member, q in zip(work.members, rows, strict=True)
                ]
            )

        return Prepared(run=run, read=read)


def _coefficients(member: Member) -> ComplexArray:
    system = member.loops
    table = (system.turning, system.sliding, system.crank[:, None], system.fixed[:, None])
    return np.hstack(table)


def _numbers(work: Work) -> list[Array]:
    """What differs within a family: real and imaginary parts of all coefficients, per member.

    A single mechanism has them as constants in its function, and none here.
    """
    if len(work.members) == 1:
        return [np.empty(0)]
    return [_coefficients(member).ravel().view(np.float64) for member in work.members]


def _follow(work: Work, compiled: bool) -> Any:
    """Solutions of all rows from a start, inputs and numbers, each row from the one before."""
    casadi = import_module("casadi")
    system = work.members[0].loops
    table = _coefficients(work.members[0])
    q, u = casadi.SX.sym("q", system.unknowns), casadi.SX.sym("u")
    count = len(_numbers(work)[0])
    c = casadi.SX.sym("c", count)
    n = system.angles
    phasors = [*((casadi.cos(q[k]), casadi.sin(q[k])) for k in range(n))]
    phasors += [(q[k], 0.0) for k in range(n, system.unknowns)]
    phasors += [(casadi.cos(u), casadi.sin(u)), (1.0, 0.0)]
    rows = []
    for j, line in enumerate(table):
        real = imaginary = casadi.SX(0.0)
        for k, (cosine, sine) in enumerate(phasors):
            if line[k] == 0.0:
                continue
            place = 2 * (j * table.shape[1] + k)
            a, b = (c[place], c[place + 1]) if count else (line[k].real, line[k].imag)
            if line[k].imag == 0.0:
                b = 0.0
            real += a * cosine - b * sine
            imaginary += a * sine + b * cosine
        rows += [real, imaginary]
    gap = casadi.Function("gap", [q, casadi.vertcat(u, c)], [casadi.vertcat(*rows)])
    find = casadi.rootfinder("find", "fast_newton", gap, {"abstol": 1e-12 * system.scale})
    start = casadi.MX.sym("start", system.unknowns)
    inputs = casadi.MX.sym("inputs", 1, work.rows)
    numbers = casadi.MX.sym("numbers", count)
    repeated = casadi.vertcat(inputs, casadi.repmat(numbers, 1, work.rows))
    found = find.mapaccum(work.rows)(start, repeated)
    return casadi.Function("follow", [start, inputs, numbers], [found], _options(compiled))


def _options(compiled: bool) -> dict[str, Any]:
    if not compiled:
        return {}
    folder = tempfile.mkdtemp(prefix="casadi-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    options = {"flags": ["-O3", "-march=native"], "directory": f"{folder}/"}
    return {"jit": True, "compiler": "shell", "jit_options": options}
