"""The structure of equations without coefficients, which all designs of a family share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.equations.model import LawEquation, LoopEquations, Term
from linkwork.foundation.arrays import Array

__all__ = ["Coefficients", "Pattern"]

#: The variable length and the weighted angles of a term.
TermKey = tuple[str | None, tuple[tuple[str, float], ...]]


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """The numbers of one set of equations in the order of a :class:`Pattern`; floats or lanes."""

    loops: Sequence[complex]
    points: Sequence[complex]
    linear: Sequence[float]
    link_angles: Sequence[float]
    start: Sequence[float]
    numbers: Sequence[float]
    redundant: Sequence[float]
    length_scale: Sequence[float]


@dataclass(frozen=True, kw_only=True)
class Pattern:
    """The parts of equations other than coefficients.

    Parameters
    ----------
    rest : tuple
        Variables, linear rows without constants, parents of points, variables of link angles,
        named numbers, redundant lengths; compared for equality.
    loops, points : tuple of tuple of TermKey
        The terms of every row.
    laws : tuple of LawEquation
        Laws of cams and curves; their numbers cannot vary in a family and must be equal.
    """

    rest: tuple[object, ...]
    loops: tuple[tuple[TermKey, ...], ...]
    points: tuple[tuple[TermKey, ...], ...]
    laws: tuple[LawEquation, ...]

    @classmethod
    def of(cls, equations: LoopEquations) -> Pattern:
        """The pattern of a set of equations."""
        return cls(
            rest=(
                tuple((v.symbol, v.kind) for v in equations.variables),
                len(equations.inputs),
                tuple((e.terms, e.kind) for e in equations.linear),
                tuple((name, path.parent) for name, path in equations.points.items()),
                tuple((link, angle.variable) for link, angle in equations.links.items()),
                tuple(equations.dimensions),
                tuple(part.variable for part in equations.redundant),
                equations.real,
            ),
            loops=tuple(_keys(loop.terms) for loop in equations.loops),
            points=tuple(_keys(path.terms) for path in equations.points.values()),
            laws=equations.laws,
        )

    @classmethod
    def with_coefficients(cls, equations: LoopEquations) -> tuple[Pattern, Coefficients]:
        """The pattern of a set of equations, and their own coefficients."""
        own = cls.of(equations)
        found = own._ordered(equations, own)
        assert found is not None
        return own, found

    def coefficients(self, equations: LoopEquations) -> Coefficients | None:
        """The coefficients in the order of this pattern; ``None`` if they do not match it.

        A term missing in the equations, such as that of an offset of 0, has the coefficient 0.
        """
        return self._ordered(equations, Pattern.of(equations))

    def _ordered(self, equations: LoopEquations, own: Pattern) -> Coefficients | None:
        if own.rest != self.rest or not _same_laws(own.laws, self.laws):
            return None
        loops = _in_order([loop.terms for loop in equations.loops], own.loops, self.loops)
        paths = [path.terms for path in equations.points.values()]
        points = _in_order(paths, own.points, self.points)
        if loops is None or points is None:
            return None
        return Coefficients(
            loops=loops,
            points=points,
            linear=[equation.constant for equation in equations.linear],
            link_angles=[angle.constant for angle in equations.links.values()],
            start=list(equations.start),
            numbers=list(equations.dimensions.values()),
            redundant=[part.length for part in equations.redundant],
            length_scale=[equations.length_scale],
        )


def _keys(terms: Iterable[Term]) -> tuple[TermKey, ...]:
    return tuple((term.length, term.phase) for term in terms)


def _in_order(
    rows: Sequence[Sequence[Term]],
    keys: Sequence[Sequence[TermKey]],
    wanted: Sequence[Sequence[TermKey]],
) -> list[complex] | None:
    """The values of all terms by key; like terms of a row keep their order."""
    if len(rows) != len(wanted):
        return None
    values: list[complex] = []
    for terms, own, want in zip(rows, keys, wanted, strict=True):
        if own == want:
            values += [term.value for term in terms]
            continue
        left: dict[TermKey, list[complex]] = {}
        for key, term in zip(own, terms, strict=True):
            left.setdefault(key, []).append(term.value)
        values += [left[key].pop(0) if left.get(key) else 0j for key in want]
        if any(left.values()):
            return None
    return values


def _same_laws(laws: Sequence[LawEquation], others: Sequence[LawEquation]) -> bool:
    return len(laws) == len(others) and all(map(_same_law, laws, others))


def _law_numbers(equation: LawEquation) -> tuple[Array, Array, Array]:
    return equation.law.breaks, equation.law.powers, equation.law.sines


def _same_law(a: LawEquation, b: LawEquation) -> bool:
    return (
        (a.terms, a.inner, a.kind) == (b.terms, b.inner, b.kind)
        and bool(a.constant == b.constant)
        and bool(a.offset == b.offset)
        and all(map(np.array_equal, _law_numbers(a), _law_numbers(b)))
    )
