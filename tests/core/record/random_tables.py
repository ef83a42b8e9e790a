"""Random loop tables, and their equations written a second time with cosines and sines.

The second writing accepts complex numbers in place of real variables: real and imaginary rows
are separate sums, nothing takes a real part, so that complex steps pass through.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from linkwork.core.equations.model import FormulaRow
from linkwork.core.expression.grammar import parse_equation
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.table.loop_table import LoopTable
from linkwork.core.table.rows import LinearRows, PhasorRows

__all__ = ["Example", "random_example"]

Any = npt.NDArray[np.float64] | npt.NDArray[np.complex128]
#: Formulas of up to three variables with what they mean: value, then first derivative along d.
FORMULAS: list[tuple[str, int, Callable[..., Any], Callable[..., Any]]] = [
    (
        "x*sin(y) = z^2 - 1",
        3,
        lambda x, y, z: x * np.sin(y) - z * z + 1,
        lambda x, y, z, a, b, c: a * np.sin(y) + x * np.cos(y) * b - 2 * z * c,
    ),
    (
        "exp(x/3) = y*x + 2",
        2,
        lambda x, y: np.exp(x / 3) - y * x - 2,
        lambda x, y, a, b: np.exp(x / 3) * a / 3 - b * x - y * a,
    ),
    ("x^3 - 2*x + 2 = 0", 1, lambda x: x**3 - 2 * x + 2, lambda x, a: (3 * x**2 - 2) * a),
]


@dataclass(frozen=True)
class Term:
    """coefficient · (v[length] or 1) · exp(i Σ weight v) in one loop."""

    row: int
    coefficient: complex
    length: int | None
    phase: tuple[tuple[int, float], ...]


@dataclass(frozen=True)
class Example:
    """A table with what it was made from, and a batch of places ``v`` with directions ``d``."""

    table: LoopTable
    terms: tuple[Term, ...]
    lines: tuple[tuple[float, tuple[tuple[int, float], ...]], ...]
    formulas: tuple[tuple[int, tuple[int, ...]], ...]
    v: npt.NDArray[np.float64]
    d: npt.NDArray[np.float64]

    def residual(self, v: Any) -> Any:
        """F in cosines and sines, (B, m); ``v`` may be complex."""
        loops = self.table.loops.rows
        out = np.zeros((len(v), self.table.equations), dtype=complex)
        for term in self.terms:
            angle = sum((w * v[:, k] for k, w in term.phase), np.zeros(len(v)))
            size = 1.0 if term.length is None else v[:, term.length]
            a, b = term.coefficient.real, term.coefficient.imag
            out[:, term.row] += size * (a * np.cos(angle) - b * np.sin(angle))
            out[:, loops + term.row] += size * (a * np.sin(angle) + b * np.cos(angle))
        for k, (constant, weights) in enumerate(self.lines):
            out[:, 2 * loops + k] = constant + sum(w * v[:, j] for j, w in weights)
        for k, (which, used) in enumerate(self.formulas):
            value = FORMULAS[which][2](*(v[:, j] for j in used))
            out[:, 2 * loops + len(self.lines) + k] = value
        return out

    def slope(self, v: Any, d: Any) -> Any:
        """dF along d, differentiated by hand, (B, m); ``v`` may be complex."""
        loops = self.table.loops.rows
        out = np.zeros((len(v), self.table.equations), dtype=complex)
        for term in self.terms:
            angle = sum((w * v[:, k] for k, w in term.phase), np.zeros(len(v)))
            turn = sum((w * d[:, k] for k, w in term.phase), np.zeros(len(v)))
            size = 1.0 if term.length is None else v[:, term.length]
            grow = 0.0 if term.length is None else d[:, term.length]
            a, b = term.coefficient.real, term.coefficient.imag
            cosine, sine = np.cos(angle), np.sin(angle)
            out[:, term.row] += grow * (a * cosine - b * sine) - size * turn * (
                a * sine + b * cosine
            )
            out[:, loops + term.row] += grow * (a * sine + b * cosine) + size * turn * (
                a * cosine - b * sine
            )
        for k, (_, weights) in enumerate(self.lines):
            out[:, 2 * loops + k] = sum(w * d[:, j] for j, w in weights)
        for k, (which, used) in enumerate(self.formulas):
            value = FORMULAS[which][3](*(v[:, j] for j in used), *(d[:, j] for j in used))
            out[:, 2 * loops + len(self.lines) + k] = value
        return out


def random_example(seed: int) -> Example:
    """A table of one to four loops with every feature a table can have."""
    rng = np.random.default_rng(seed)
    loops = int(rng.integers(1, 5))
    angles, lengths = int(rng.integers(2, 7)), int(rng.integers(0, 4))
    # which variables are inputs is left to chance: an angle, a length, both or none
    turns = np.array([True] * angles + [False] * lengths)
    rng.shuffle(turns)
    count = len(turns)
    inputs = int(rng.integers(0, 3))
    turning, sliding = np.flatnonzero(turns), np.flatnonzero(~turns)
    terms = []
    for row in range(loops):
        for _ in range(int(rng.integers(2, 6))):
            chosen = rng.choice(turning, size=int(rng.integers(0, 3)), replace=True)
            phase = tuple((int(k), float(rng.choice([1, 1, -1, 2, 0.5]))) for k in chosen)
            slides = len(sliding) and rng.random() < 0.4
            terms.append(
                Term(
                    row=row,
                    coefficient=complex(*rng.normal(size=2)),
                    length=int(rng.choice(sliding)) if slides else None,
                    phase=phase,
                )
            )
    lines = []
    for _ in range(int(rng.integers(0, 3))):
        used = rng.choice(count, size=2, replace=False)
        lines.append((float(rng.normal()), tuple((int(k), float(rng.normal())) for k in used)))
    formulas = []
    for _ in range(int(rng.integers(0, 3))):
        which = int(rng.integers(len(FORMULAS)))
        if FORMULAS[which][1] <= count:
            used = rng.choice(count, size=FORMULAS[which][1], replace=False)
            formulas.append((which, tuple(int(k) for k in used)))
    batch = int(rng.integers(1, 4))
    return Example(
        table=_table(rng, count - inputs, turns, terms, lines, formulas),
        terms=tuple(terms),
        lines=tuple(lines),
        formulas=tuple(formulas),
        v=rng.uniform(-2.5, 2.5, (batch, count)),
        d=rng.normal(size=(batch, count)),
    )


def _table(
    rng: np.random.Generator,
    unknowns: int,
    turns: npt.NDArray[np.bool_],
    terms: list[Term],
    lines: list[tuple[float, tuple[tuple[int, float], ...]]],
    formulas: list[tuple[int, tuple[int, ...]]],
) -> LoopTable:
    loops = 1 + max(term.row for term in terms)
    phases = [(t, k, w) for t, term in enumerate(terms) for k, w in term.phase]
    entries = [(r, k, w) for r, (_, weights) in enumerate(lines) for k, w in weights]
    rows = 2 * loops + len(lines) + len(formulas)
    return LoopTable(
        unknowns=unknowns,
        loops=PhasorRows(
            rows=loops,
            variables=len(turns),
            row=np.array([term.row for term in terms], dtype=np.intp),
            coefficient=np.array([term.coefficient for term in terms]),
            length=np.array([-1 if t.length is None else t.length for t in terms], dtype=np.intp),
            phase_term=np.array([t for t, _, _ in phases], dtype=np.intp),
            phase_variable=np.array([k for _, k, _ in phases], dtype=np.intp),
            phase_weight=np.array([w for _, _, w in phases], dtype=float),
        ),
        linear=LinearRows(
            constant=np.array([constant for constant, _ in lines], dtype=float),
            row=np.array([r for r, _, _ in entries], dtype=np.intp),
            variable=np.array([k for _, k, _ in entries], dtype=np.intp),
            weight=np.array([w for _, _, w in entries], dtype=float),
        ),
        functions=tuple(_formula(which, used) for which, used in formulas),
        equation_scale=rng.uniform(0.5, 2.0, rows),
        variable_scale=rng.uniform(0.5, 2.0, len(turns)),
        is_angle=turns,
    )


def _formula(which: int, used: tuple[int, ...]) -> FormulaRow:
    left, right = parse_equation(FORMULAS[which][0])
    return FormulaRow(
        left=left,
        right=right,
        names=("x", "y", "z")[: len(used)],
        variables=used,
        constants=(),
        unit=AngleUnit.RADIAN,
    )
