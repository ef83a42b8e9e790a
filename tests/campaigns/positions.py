"""Random closed positions for the referee of certificates: every feature a table can have."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import numpy.typing as npt

import linkwork as lw
from linkwork.core.table.loop_table import LoopTable
from linkwork.core.table.rows import LinearRows, PhasorRows

__all__ = ["Placed", "closed", "library_positions", "random_position"]

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Placed:
    """A table without function rows, and variables that close it up to rounding."""

    kind: str
    table: LoopTable
    v: Array


def random_position(seed: int) -> Placed:
    """A random table, closed by its constants; every third near a singular position."""
    rng = np.random.default_rng([7, seed])
    while True:
        table, v = _random_table(rng, plain=seed % 4 == 0)
        if seed % 5 == 4:  # a mechanism that has turned many times
            v = v + np.where(table.is_angle, 2 * np.pi * rng.integers(-40, 41, len(v)), 0.0)
        kind = "regular"
        if seed % 3 == 0:
            near = _near_singular(rng, table, v)
            if near is None:
                continue
            kind, v = "near singular", near
        table = closed(table, v)
        if kind == "regular" and not _condition(table, v) < 1e4:
            continue
        return Placed(kind=kind, table=table, v=v)


def _random_table(rng: np.random.Generator, plain: bool) -> tuple[LoopTable, Array]:
    """``plain``: links that turn, weight 1, no linear rows."""
    loops = int(rng.integers(1, 4))
    lines = 0 if plain else int(rng.integers(0, 3))
    n = 2 * loops + lines
    inputs = int(rng.integers(1, 3))
    turns = np.ones(n + inputs, dtype=bool)
    if not plain:
        turns[rng.permutation(n + inputs)[: rng.integers(0, 1 + (n + inputs) // 2)]] = False
    scale = float(10 ** rng.uniform(-1, 3))
    return _filled(rng, loops, lines, turns, scale, plain), _place(rng, turns, scale)


def _place(rng: np.random.Generator, turns: npt.NDArray[np.bool_], scale: float) -> Array:
    return np.where(
        turns, rng.uniform(-np.pi, np.pi, len(turns)), scale * rng.normal(size=len(turns))
    )


def _filled(
    rng: np.random.Generator,
    loops: int,
    lines: int,
    turns: npt.NDArray[np.bool_],
    scale: float,
    plain: bool,
) -> LoopTable:
    count = len(turns)
    n = 2 * loops + lines
    angles, lengths = np.flatnonzero(turns), np.flatnonzero(~turns)
    row: list[int] = []
    coefficient: list[complex] = []
    length: list[int] = []
    phases: list[tuple[int, int, float]] = []

    def term(r: int, c: complex, j: int, phase: list[tuple[int, float]]) -> None:
        phases.extend((len(row), k, w) for k, w in phase)
        row.append(r)
        coefficient.append(c)
        length.append(j)

    for r in range(loops):
        # some terms share a phase, so that their coefficients have to be added
        for _ in range(int(rng.integers(3, 3 + n))):
            phase: list[tuple[int, float]] = []
            if len(angles) and rng.random() < 0.85:
                chosen = rng.choice(angles, size=1 if plain or rng.random() < 0.8 else 2)
                weights = [1.0] if plain else [1, 1, 1, 1, -1, 2, 0.5, 3, 1 / 3]
                phase = [(int(k), float(rng.choice(weights))) for k in chosen]
            slides = len(lengths) and rng.random() < 0.4
            c = complex(*rng.normal(size=2))
            term(r, c if slides else scale * c, int(rng.choice(lengths)) if slides else -1, phase)
        term(r, 0j, -1, [])  # closes the loop later
    entries = []
    for r in range(lines):
        for k in rng.choice(count, size=int(rng.integers(2, 4)), replace=False):
            unit = 1.0 if turns[k] else scale
            entries.append((r, int(k), float(rng.choice([1, -1, 2, rng.normal()])) / unit))
    return LoopTable(
        unknowns=n,
        loops=PhasorRows(
            rows=loops,
            variables=count,
            row=np.array(row, dtype=np.intp),
            coefficient=np.array(coefficient, dtype=complex),
            length=np.array(length, dtype=np.intp),
            phase_term=np.array([t for t, _, _ in phases], dtype=np.intp),
            phase_variable=np.array([k for _, k, _ in phases], dtype=np.intp),
            phase_weight=np.array([w for _, _, w in phases], dtype=float),
        ),
        linear=LinearRows(
            constant=np.zeros(lines),
            row=np.array([r for r, _, _ in entries], dtype=np.intp),
            variable=np.array([k for _, k, _ in entries], dtype=np.intp),
            weight=np.array([w for _, _, w in entries], dtype=float),
        ),
        functions=(),
        equation_scale=np.array([scale] * (2 * loops) + [1.0] * lines),
        variable_scale=np.where(turns, 1.0, scale),
        is_angle=turns,
    )


def _jacobian(table: LoopTable, v: Array) -> Array:
    """By the unknowns, scaled."""
    n = table.unknowns
    j = table.jacobian(v[None, :])[0, :, :n]
    return np.asarray(j * table.variable_scale[:n] / table.equation_scale[:, None])


def _condition(table: LoopTable, v: Array) -> float:
    return float(np.linalg.cond(_jacobian(table, v)))


def closed(table: LoopTable, v: Array) -> LoopTable:
    """With the loops' constant terms, and those of the lines, such that v is a position."""
    residual = table.residual(v[None, :])[0]
    count = table.loops.rows
    coefficient = table.loops.coefficient.copy()
    last = np.array([np.flatnonzero(table.loops.row == r)[-1] for r in range(count)])
    coefficient[last] -= residual[:count] + 1j * residual[count : 2 * count]
    return replace(
        table,
        loops=replace(table.loops, coefficient=coefficient),
        linear=replace(table.linear, constant=table.linear.constant - residual[2 * count :]),
    )


def _near_singular(rng: np.random.Generator, table: LoopTable, v: Array) -> Array | None:
    """1e-2 to 1e-7 away from a place where det J = 0, if one is met on a random way."""
    other = _place(rng, table.is_angle, float(table.variable_scale.max()))
    way = other - v

    def sign(s: float) -> float:
        return float(np.linalg.slogdet(_jacobian(table, v + s * way))[0])

    places = np.linspace(0, 1, 30)
    signs = [sign(s) for s in places]
    change = [k for k in range(29) if signs[k] * signs[k + 1] < 0]
    if not change:
        return None
    low, high = places[change[0]], places[change[0] + 1]
    for _ in range(50):
        middle = (low + high) / 2
        if sign(middle) == signs[change[0]]:
            low = middle
        else:
            high = middle
    return np.asarray(v + (high + 10 ** rng.uniform(-7, -2)) * way)


@cache
def _library() -> tuple[tuple[str, LoopTable, Array], ...]:
    """Every block of every library mechanism with its variables over the whole cycle.

    Laws of cams and curves have a referee of their own.
    """
    found = []
    for name in lw.examples():
        mechanism = lw.example(name)
        if not mechanism.description.inputs:
            continue
        motion = mechanism.sweep(certify=False)
        solver = mechanism.model.compiled.solver
        if not all(block.system.has_curvature_bound for block in solver.blocks):
            continue
        v = np.concatenate([motion.q[motion.asked], mechanism.model.rows], axis=1)
        v = v[motion.found[motion.asked]]
        found += [
            (name, block.system, v[:, block.variables])
            for block in solver.blocks
            if isinstance(block.system, LoopTable) and not block.system.functions
        ]
    return tuple(found)


def library_positions(count: int, seed: int) -> list[Placed]:
    """Blocks of the library's mechanisms at random rows of their cycles."""
    rng = np.random.default_rng([8, seed])
    blocks = _library()
    found = []
    for k in range(count):
        name, table, v = blocks[k % len(blocks)]
        found.append(Placed(kind=name, table=table, v=v[rng.integers(len(v))]))
    return found
