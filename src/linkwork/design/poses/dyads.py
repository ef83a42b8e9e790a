"""All dyads that carry a body through five poses, each proved or with the reason why not."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from linkwork.design.poses.conic_pair import common_points
from linkwork.design.poses.dyad_equations import COORDINATES, NormalPoses, quadric_gradients
from linkwork.design.poses.dyad_proof import DyadProofs, prove_dyads
from linkwork.foundation.arrays import (
    AnyArray,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
    StatusArray,
)
from linkwork.foundation.coded_enum import CodedEnum
from linkwork.foundation.rounding import RANK_TOLERANCE

__all__ = ["FIVE", "KINDS", "Dyads", "Refusal", "solve_five_poses", "solve_on_lines"]

FIVE = 5
_PART = 1000  # tasks solved together: their matrices fit into the cache
#: A pivot farther away than this many sizes of the task is a slider: rounding of the poses alone
#: moves it that far.
_FAR = 1e9
_VIEWS = 3


@cache
def _view(seed: int) -> Array:
    """A fixed rotation of the plane of conics: no two of the four points lie behind each other."""
    rotation: Array = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return rotation


#: The joints of a dyad from ground to body, revolute or prismatic, by their numbers. A pair of
#: guides, PP, carries a body through parallel poses only, whatever they are: it is no solution.
KINDS = ("RR", "PR", "RP")


class Refusal(CodedEnum):
    """Why a solution of the equations of dyads is no proved dyad; the value is a sentence."""

    NONE = "proved"
    COMPLEX = "the solution is complex"
    COINCIDENT = (
        "not proved: it nearly coincides with another solution; move a pose by a little to "
        "separate them"
    )
    NO_JOINT = "no joint: its equation does not depend on the body's point"
    FAMILY = (
        "not determined: these poses admit infinitely many dyads; use poses in more general "
        "positions"
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Dyads:
    """The solutions for N tasks, four each.

    Parameters
    ----------
    x : (N, 4, 8) complex
        Solutions in the coordinates of :mod:`~linkwork.design.poses.dyad_equations`, real where
        ``is_real``, for ``poses``.
    is_real : (N, 4)
        Whether the solution is a real dyad.
    refusal : (N, 4)
        Codes of :class:`Refusal`; ``NONE`` for proved real dyads.
    error : (N, 4)
        A bound of the error of every coordinate, for x of length 1; infinite where not proved.
    condition : (N, 4)
        The condition of the Jacobian.
    complete : (N,)
        Whether four different solutions are proved: then no other dyad exists.
    poses : NormalPoses
    """

    x: ComplexArray
    is_real: BoolArray
    refusal: StatusArray
    error: Array
    condition: Array
    complete: BoolArray
    poses: NormalPoses

    @property
    def kinds(self) -> StatusArray:
        """The kinds (N, 4): 0 RR, 1 PR, 2 RP, by the order of :data:`KINDS`."""
        size = np.abs(self.x[:, :, 1:7]).max(axis=2)
        flat = _FAR * np.abs(self.x[:, :, 0]) < size
        a, g = (np.abs(self.x[:, :, k : k + 2]).max(axis=2) for k in (1, 3))
        return np.where(flat, np.where(g >= a, 1, 2), 0).astype(np.int8)


def solve_five_poses(points: ComplexArray, angles: Array) -> Dyads:
    """All dyads of N tasks of five poses.

    Parameters
    ----------
    points : (N, 5) complex
        The places of the body's point [length].
    angles : (N, 5)
        The angles of the body [rad].

    Returns
    -------
    Dyads

    References
    ----------
    L. Burmester 1888; J. M. McCarthy, G. S. Soh: Geometric Design of Linkages, ch. 5. The linear
    form: Q. J. Ge, P. Zhao, A. Purwar, X. Li 2012, doi:10.1115/DETC2012-71190.

    Examples
    --------
    >>> points = np.array([[0, 2 + 1j, 3 + 3j, 2 + 5j, 1j]])
    >>> solve_five_poses(points, np.radians([[0, 20, 50, 80, 10]])).is_real.sum() % 2
    0
    """
    return _solve_in_parts(points, angles, np.zeros((len(points), 0, COORDINATES)))


def solve_on_lines(points: ComplexArray, angles: Array, lines: ComplexArray) -> Dyads:
    """All dyads through four poses whose fixed pivot is on a line; one line for each of N tasks.

    Parameters
    ----------
    points, angles : (N, 4)
        As for :func:`solve_five_poses`.
    lines : (N, 2) complex
        A point of each line, and its unit direction [length].

    Returns
    -------
    Dyads
        Among them the RP dyad through the four poses, whatever the line.
    """
    poses = NormalPoses.of(points, angles)
    at, along = (lines[:, 0] - poses.centre) / poses.size, lines[:, 1]
    zero = np.zeros(len(points))
    # Im(ū (G - a q)) = 0 for a pivot G/a on the line through q of direction u
    row = [-(along.conj() * at).imag, zero, zero, -along.imag, along.real, zero, zero, zero]
    return _solve_in_parts(points, angles, np.stack(row, axis=-1)[:, None])


def _solve_in_parts(points: ComplexArray, angles: Array, further: Array) -> Dyads:
    """Solve the equations of poses (N, K) and further linear rows (N, 5 - K, 8)."""
    parts = [
        _solve_part(points[part], angles[part], further[part])
        for part in (slice(k, k + _PART) for k in range(0, len(points), _PART))
    ]
    fields = ("x", "is_real", "refusal", "error", "condition", "complete")
    return Dyads(
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in fields},
        poses=NormalPoses.of(points, angles),
    )


def _solve_part(points: ComplexArray, angles: Array, further: Array) -> Dyads:
    poses = NormalPoses.of(points, angles)
    rows = np.concatenate([poses.rows(), further], axis=1)
    left, sizes, right = np.linalg.svd(rows)
    family = sizes[:, -1] < RANK_TOLERANCE * sizes[:, 0]
    null = right[:, FIVE:].transpose(0, 2, 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = right[:, :FIVE].transpose(0, 2, 1) / sizes[:, None] @ left.transpose(0, 2, 1)
    basis = _Basis(rows=rows, null=null, inverse=np.nan_to_num(inverse))
    proofs = _prove(basis, _view(0))
    for view in map(_view, range(1, _VIEWS)):
        again = np.flatnonzero(~proofs.complete & ~family)
        if not again.size:
            break
        long = poses.take(again).in_extended_precision(points[again], angles[again]).rows()
        precise = np.concatenate([long, further[again]], axis=1)
        proofs = proofs.with_better(again, _prove(basis.take(again), view, precise))
    refusal = np.where(proofs.is_real, Refusal.NONE.code, Refusal.COMPLEX.code)
    refusal[~proofs.proved] = Refusal.COINCIDENT.code
    flat = np.abs(proofs.x[..., :5]).max(axis=2) * _FAR < np.abs(proofs.x).max(axis=2)
    refusal[flat] = Refusal.NO_JOINT.code
    refusal[family] = Refusal.FAMILY.code
    return Dyads(
        x=proofs.x,
        is_real=proofs.is_real & ~flat & ~family[:, None],
        refusal=refusal.astype(np.int8),
        error=np.where(proofs.proved, proofs.error, np.inf),
        condition=proofs.condition,
        complete=proofs.complete & ~family,
        poses=poses,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Basis:
    """Linear rows (N, 5, 8), their null space (N, 8, 3) and pseudo-inverse (N, 8, 5)."""

    rows: Array
    null: Array
    inverse: Array

    def take(self, index: IndexArray) -> _Basis:
        return _Basis(
            rows=self.rows[index],
            null=self.null[index],
            inverse=self.inverse[index],
        )


def _prove(basis: _Basis, view: Array, precise: AnyArray | None = None) -> DyadProofs:
    """The four solutions, from conics seen in one of the views; ``precise``: rows, if extended."""
    null = basis.null @ view
    # the quadrics' second derivatives are those of their gradients
    identity = np.eye(COORDINATES)
    second = quadric_gradients(identity).transpose(1, 0, 2)  # (2, 8, 8)
    first, other = (0.5 * null.transpose(0, 2, 1) @ form @ null for form in second)
    y = common_points(first, other)
    return prove_dyads(basis.rows, null, basis.inverse, y, precise)
