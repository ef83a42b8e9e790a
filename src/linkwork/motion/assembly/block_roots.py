"""The real solutions of a block over its unknown directions, for many closures at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.equations.directions import DirectionForm
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.foundation.completeness import Completeness
from linkwork.foundation.rounding import ALMOST_DOUBLE, ALMOST_REAL
from linkwork.numerics.homotopy.bilinear import BilinearSystem, ProvedRoots, prove_roots
from linkwork.numerics.homotopy.bilinear_family import structure_of
from linkwork.numerics.homotopy.isolated_roots import isolated_roots
from linkwork.numerics.homotopy.pencil_roots import roots_of_two_loops
from linkwork.numerics.homotopy.polynomial_system import Roots
from linkwork.numerics.homotopy.quadratic_roots import quadratic_roots
from linkwork.numerics.homotopy.solution_bound import SolutionBound, bound_by_products
from linkwork.results.configurations import PathCount

__all__ = ["FOLLOWS", "BlockRoots", "solve_block"]


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockRoots:
    """The real solutions of a block for one closure.

    ``x`` (R, 2M), with ``multiple`` (R,): those that are not regular; the ``grade`` of completeness
    and the counts of the ``paths``.
    """

    x: ComplexArray
    multiple: BoolArray
    grade: Completeness
    paths: PathCount


#: A block without loops: its only solution has no directions.
FOLLOWS = BlockRoots(
    x=np.zeros((1, 0), dtype=complex),
    multiple=np.zeros(1, dtype=bool),
    grade=Completeness.PROVED,
    paths=PathCount(unknowns=(), finite=1, real=1, expected=1),
)


def solve_block(form: DirectionForm, left: ComplexArray, off: Array) -> list[BlockRoots]:
    """The roots of a block for each of K closures (K, L, M + 1), known within ``off``."""
    if form.table.loops.rows > 1:
        return [_solve_loops(form.system(left[k]), off[k]) for k in range(len(left))]
    systems = form.system(left)
    found = quadratic_roots(systems)
    counts = [len(roots.x) for roots in found]
    of = np.repeat(np.arange(len(found)), counts)
    proofs = prove_roots(systems.take(of), np.concatenate([roots.x for roots in found]), off[of])
    bound = bound_by_products(systems.products)
    each = np.split(np.arange(len(of)), np.cumsum(counts)[:-1])
    return [_graded(roots, proofs.take(own), bound) for roots, own in zip(found, each, strict=True)]


def _solve_loops(system: BilinearSystem, off: Array) -> BlockRoots:
    """The roots of two or more loops."""
    family = structure_of(system)
    known = roots_of_two_loops(system) if system.loops == 2 else None
    roots = isolated_roots(system, family, known)
    bound = family.bound_of(system, off, len(roots.x))
    return _graded(roots, prove_roots(system, roots.x, off), bound)


def _graded(roots: Roots, proofs: ProvedRoots, bound: SolutionBound) -> BlockRoots:
    """The real ones of some roots, by their proofs."""
    m = roots.x.shape[1] // 2
    # roots that no proof decides are taken by a tolerance, and lower the grade of the list
    real = proofs.real | (~proofs.holds & (_mirror_gap(roots.x, m) < ALMOST_REAL))
    undecided = not (proofs.holds & (proofs.real | proofs.unreal)).all()
    unproved = real & ~proofs.holds
    doubles = roots.multiple[_mirror_gap(roots.multiple, m) < ALMOST_DOUBLE]
    if roots.continuum:
        grade = Completeness.CONTINUUM
    elif (
        not roots.sure
        or roots.failed
        or roots.paths != len(roots.x) + roots.at_infinity + roots.singular
    ):
        grade = Completeness.NOT_PROVED
    elif roots.singular or unproved.any():
        grade = Completeness.MULTIPLE
    elif len(roots.x) == bound.number and proofs.apart and not undecided:
        grade = Completeness.PROVED
    else:
        grade = Completeness.WITH_PROBABILITY_ONE
    x = np.concatenate([roots.x[real], doubles])
    return BlockRoots(
        x=x,
        multiple=np.concatenate([unproved[real], np.ones(len(doubles), dtype=bool)]),
        grade=grade,
        paths=_count(roots, int(real.sum()) + len(doubles), bound),
    )


def _count(roots: Roots, real: int, bound: SolutionBound) -> PathCount:
    return PathCount(
        unknowns=(),
        paths=roots.paths,
        finite=len(roots.x),
        real=real,
        at_infinity=roots.at_infinity,
        multiple=roots.singular,
        failed=roots.failed,
        expected=roots.expected,
        bound=bound.number,
        theorem=bound.theorem.value,
    )


def _mirror_gap(x: ComplexArray, m: int) -> Array:
    """How far solutions (R, 2M) are from their mirror images, relative to their size."""
    gap = np.abs(x[:, :m] - x[:, m:].conj()).max(axis=1, initial=0.0)
    relative: Array = gap / (1.0 + np.abs(x).max(axis=1, initial=0.0))
    return relative
