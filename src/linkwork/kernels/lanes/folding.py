"""Dead points of many designs at once."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray
from linkwork.kernels.lanes.compiling import compiled
from linkwork.kernels.lanes.fold_programs import fold_programs
from linkwork.kernels.lanes.machine import LANES, run
from linkwork.kernels.loop_table import LoopTable

__all__ = ["Folds", "LastNodes", "dead_points"]

_PLACES = 30  # that the secant method may try
_STEPS = 8  # of Newton-Raphson at each
_CLOSE = 1e-7  # a move of λ after which the place is found: t is off by its square and less
_TOLERANCE = 1e-8
_STRAIGHT = 1e-4  # weighted d²t/dλ² below which it is no ordinary dead point


@dataclass(frozen=True, kw_only=True, eq=False)
class LastNodes:
    """Where D designs could go no further: ``t`` (D,), unknowns ``w`` (n, D), their rates by t
    ``s``, the same at the node before (``q``, ``p``), how far the true position may be, ``x``.
    """

    t: Array
    w: Array
    s: Array
    q: Array
    p: Array
    x: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Folds:
    """``t`` (D,): of the dead point. ``found`` (D,): whether it is one, and proved to be joined to
    the node if that was asked.
    """

    t: Array
    found: BoolArray


def dead_points(
    table: LoopTable,
    zeros: Set[str],
    coefficients: Mapping[str, Array],
    nodes: LastNodes,
    way: int,
    certified: bool,
) -> Folds:
    """The dead point right ahead of every node, downwards (way 0) or upwards (1).

    Parameters
    ----------
    table : LoopTable
        Without function rows, with a single input.
    coefficients : Mapping[str, (D,)]
        By register.
    """
    n, count = nodes.w.shape
    scale = np.stack([coefficients.get(f"scale{k}", np.ones(count)) for k in range(n)])
    with np.errstate(invalid="ignore"):
        leads = np.argmax(np.abs(nodes.s) / scale, axis=0)
    found = Folds(t=np.full(count, np.nan), found=np.zeros(count, dtype=bool))
    for lead in np.unique(leads):
        mine = np.flatnonzero(leads == lead)
        _led_by(table, int(lead), zeros, coefficients, nodes, mine, certified, found)
    found.found[:] &= (found.t >= nodes.t) if way else (found.t <= nodes.t)
    return found


def _led_by(
    table: LoopTable,
    lead: int,
    zeros: Set[str],
    coefficients: Mapping[str, Array],
    nodes: LastNodes,
    mine: np.ndarray,
    certified: bool,
    found: Folds,
) -> None:
    programs = fold_programs(table, lead, zeros, certified)
    n, named = table.unknowns, programs.registers.named
    slope, slope0 = 1.0 / nodes.s[lead, mine], 1.0 / nodes.p[lead, mine]
    data: dict[str, Array] = {name: values[mine] for name, values in coefficients.items()}
    data |= {f"v{k}": nodes.w[k, mine] for k in range(n)}
    data |= {f"w{k}": nodes.w[k, mine] for k in range(n)}
    data |= {f"x{k}": nodes.x[k, mine] for k in range(n)} | {f"x{n}": np.zeros(len(mine))}
    data |= {f"r{k}": nodes.s[k, mine] * slope for k in range(n)}
    data |= {f"v{n}": nodes.t[mine], f"w{n}": nodes.t[mine], f"r{n}": slope}
    data |= {"lead0": nodes.q[lead, mine], "slope0": slope0}
    names = [name for name in data if name in named]
    places = np.array([named[name] for name in names], dtype=np.intp)
    given = np.stack([data[name] for name in names])
    space = programs.registers.filled(max(programs.height, programs.registers.count), LANES)
    space[named["tolerance"]], space[named["close"]] = _TOLERANCE, _CLOSE
    wanted = programs.registers.all_of(
        [f"v{n}", "step", "move", "bend", "live", "seeking", "good" if certified else "live"]
    )
    out = np.empty((len(wanted), len(mine)))
    prove = programs.prove.code if programs.prove is not None else np.empty((0, 5), np.uint32)
    _search(programs.iterate.code, programs.move.code, prove, space, wanted, places, given, out)
    t, step, move, bend, live, seeking, good = out
    size = coefficients.get(f"scale{lead}", np.ones(len(nodes.t)))[mine]
    regular = np.abs(bend) * size**2 >= _STRAIGHT
    with np.errstate(invalid="ignore"):
        fine = (live == 0.0) & (seeking == 0.0) & (step <= _TOLERANCE) & (move <= _CLOSE)
        fine &= regular
        if certified:
            fine &= good > 0.5
    found.t[mine], found.found[mine] = np.where(fine, t, np.nan), fine


@compiled
def _solve(iterate, w, live, seeking):  # type: ignore[no-untyped-def]
    w[live, :] = 1.0
    for _ in range(_STEPS):
        run(iterate, w)
        open_ = 0.0
        for i in range(LANES):
            open_ += w[live, i]
        if open_ == 0.0:
            break


@compiled
def _search(iterate, move, prove, w, wanted, places, given, out):  # type: ignore[no-untyped-def]
    """LANES designs at a time: secant steps along the curve, a last solution, the proof."""
    count = given.shape[1]
    live, seeking = wanted[4], wanted[5]
    for base in range(0, count, LANES):
        for lane in range(LANES):
            member = min(base + lane, count - 1)
            for j in range(len(places)):
                w[places[j], lane] = given[j, member]
            w[seeking, lane] = 1.0
        for _ in range(_PLACES):
            run(move, w)
            _solve(iterate, w, live, seeking)
            open_ = 0.0
            for i in range(LANES):
                open_ += w[seeking, i]
            if open_ == 0.0:
                break
        if len(prove):
            run(prove, w)
        for lane in range(min(LANES, count - base)):
            for j in range(len(wanted)):
                out[j, base + lane] = w[wanted[j], lane]
