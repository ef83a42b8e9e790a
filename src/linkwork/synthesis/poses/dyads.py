"""The four common points of two conics, complex ones included, for many pairs at once."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cache
from itertools import combinations

import numpy as np

from linkwork.core.foundation.arrays import (
    ALMOST_REAL,
    EPSILON,
    EXTENDED_EPSILON,
    PROOF_SLACK,
    RANK_TOLERANCE,
    UNIT_ROUNDOFF,
    AnyArray,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
    StatusArray,
)
from linkwork.core.foundation.statuses import CodedEnum

_MOST_STEPS = 60  # of Weierstrass's iteration: double roots converge linearly
_CONIC_PAIR_POLISHES = 4  # Newton steps: quadratic from the four or more digits of a root
# a start that is no root of unity, and not symmetric to the real axis
_START = 0.7 + 0.5j


def common_points(first: Array, second: Array) -> ComplexArray:
    """The points where two conics meet.

    Parameters
    ----------
    first, second : (B, 3, 3)
        Symmetric matrices: a conic is yᵀ Q y = 0.

    Returns
    -------
    (B, 4, 3) complex
        Of length 1. Where points coincide, or conics share a line, several are the same, or no
        points at all: check them.
    """
    a1, b1, c1 = _in_last_but_one(first)
    a2, b2, c2 = _in_last_but_one(second)
    # eq. (142): the resultant of two quadratics in t, whose coefficients are polynomials in s
    ab, ac = a1 * b2 - a2 * b1, a1 * c2 - a2 * c1
    bc = _times(b1, c2) - _times(b2, c1)
    s = quartic_roots(_times(ac, ac) - _times(ab, bc))
    values = [_value(polynomial, s) for polynomial in (ab, ac)]
    with np.errstate(divide="ignore", invalid="ignore"):
        y = np.stack([s, -values[1] / values[0], np.ones_like(s)], axis=-1)
        y /= np.linalg.norm(y, axis=-1, keepdims=True)
    y = np.where(np.isfinite(y).all(axis=-1, keepdims=True), y, 0.6)
    for _ in range(_CONIC_PAIR_POLISHES):
        y = _improved(y, first[:, None], second[:, None])
    return y


def _in_last_but_one(conic: Array) -> tuple[Array, Array, Array]:
    """The coefficients of t², t, 1 for y = (s, t, 1), as polynomials in s: (B, 1), (B, 2), (B, 3),
    highest power first.
    """
    q = conic
    linear = np.stack([2.0 * q[:, 0, 1], 2.0 * q[:, 1, 2]], axis=-1)
    constant = np.stack([q[:, 0, 0], 2.0 * q[:, 0, 2], q[:, 2, 2]], axis=-1)
    return q[:, 1, 1][:, None], linear, constant


def _times(a: Array, b: Array) -> Array:
    """Products of polynomials (B, m), (B, n)."""
    product = np.zeros((len(a), a.shape[1] + b.shape[1] - 1))
    for k in range(a.shape[1]):
        product[:, k : k + b.shape[1]] += a[:, k, None] * b
    return product


def _value(polynomial: Array, s: ComplexArray) -> ComplexArray:
    total = np.zeros_like(s)
    for k in range(polynomial.shape[1]):
        total = total * s + polynomial[:, k, None]
    return total


def quartic_roots(coefficients: Array) -> ComplexArray:
    """The roots (B, 4) of polynomials (B, 5), highest power first: Weierstrass's iteration.

    A leading coefficient of zero gives roots that are not finite or far off.
    """
    with np.errstate(all="ignore"):
        monic = coefficients[:, 1:] / coefficients[:, :1]
        # roots are scaled to about 1: the largest is at most twice this
        size = np.max(np.abs(monic) ** (1.0 / np.arange(1, 5)), axis=1)[:, None]
        size = np.where(size > 0, size, 1.0)
        scaled = monic / size ** np.arange(1, 5)
        roots = np.broadcast_to(_START ** np.arange(4), (len(monic), 4)).copy()
        for _ in range(_MOST_STEPS):
            value = np.ones_like(roots)
            for k in range(4):
                value = value * roots + scaled[:, k, None]
            others = np.ones_like(roots)
            for k in range(1, 4):
                others = others * (roots - np.roll(roots, k, axis=1))
            step = np.where(others != 0, value / others, 0.0)
            roots = roots - step
            if not (np.abs(step) > 4.0 * EPSILON).any():
                break
        return roots * size


def _improved(y: ComplexArray, first: Array, second: Array) -> ComplexArray:
    """One Newton step (B, 4, 3) on both conics, across y."""
    p, q = (first @ y[..., None])[..., 0], (second @ y[..., None])[..., 0]
    f = np.sum(y * p, axis=-1), np.sum(y * q, axis=-1)
    # eq. (143): the change z with 2 p·z = -f0, 2 q·z = -f1, ȳ·z = 0, by Cramer's rule
    n = y.conj()
    pq = np.cross(p, q)
    with np.errstate(all="ignore"):
        numerator = f[0][..., None] * np.cross(q, n) + f[1][..., None] * np.cross(n, p)
        step = -0.5 * numerator / np.sum(pq * n, axis=-1)[..., None]
    moved = y + np.where(np.isfinite(step), step, 0.0)
    size = np.linalg.norm(moved, axis=-1, keepdims=True)
    return np.asarray(moved / size)


# ----------------------------------------------------------------------
# The condition that a dyad carries a body through poses, as linear rows and two quadrics.
#
# A body has the pose (d, θ): a point of it is at d, and it is turned by θ. A dyad joins it to
# ground: RR by a bar between a moving pivot m (in the body's frame) and a fixed pivot p, PR by a
# moving pivot on a fixed line, RP by a line of the body through a fixed pivot, PP by two guides.
# For all of them, eq. (141),
#
#     a |d|² + 2 Re(A e^{iθ} d̄) - 2 Re(Ḡ d) - 2 Re(B e^{iθ}) + C = 0,    a B = Ḡ A,
#
# linear in x = (a, Re A, Im A, Re G, Im G, Re B, Im B, C). With a ≠ 0: m = A/a, p = G/a; with
# a = A = 0: m = B/Ḡ on the line of normal G; with a = G = 0: p = conj(B/A), and a line of the body
# of normal A.


#: The number of coordinates of a dyad, up to a common factor.
COORDINATES = 8
#: Largest second derivative of either quadric in the maximum norm: three products, each twice.
CURVATURE = 6.0
# a|d|² and the other terms: at most five roundings and two of the sine and cosine, each of data
# that were themselves shifted and scaled in two
_ROUNDINGS = 12.0


@dataclass(frozen=True, kw_only=True, eq=False)
class NormalPoses:
    """Poses of N bodies, moved to their centre and divided by their size.

    Parameters
    ----------
    points, turns : (N, K) complex
        d and e^{iθ}; K poses.
    centre : (N,) complex
        The mean of the points of the poses [length].
    size : (N,)
        The largest distance of a point from it [length].
    """

    points: AnyArray
    turns: AnyArray
    centre: ComplexArray
    size: Array

    @classmethod
    def of(cls, points: ComplexArray, angles: Array) -> NormalPoses:
        """From points (N, K) [length] and angles (N, K) [rad]."""
        centre = points.mean(axis=1)
        shifted = points - centre[:, None]
        size = np.abs(shifted).max(axis=1)
        # bodies that only turn about their point have no size
        size = np.where(size > 0, size, 1.0)
        return cls(
            points=shifted / size[:, None], turns=np.exp(1j * angles), centre=centre, size=size
        )

    def in_extended_precision(self, points: ComplexArray, angles: Array) -> NormalPoses:
        """The same bodies with the same centre and size, where the processor has more digits."""
        shifted = points.astype(np.clongdouble) - self.centre[:, None]
        return replace(
            self,
            points=np.asarray(shifted / self.size[:, None]),
            turns=np.exp(1j * angles.astype(np.longdouble)),
        )

    def rows(self) -> Array:
        """The linear rows, (N, K, 8)."""
        d, e = self.points, self.turns
        turned = e * d.conj()
        # eq. (141)
        one = np.ones_like(d.real)
        parts = (
            d.real**2 + d.imag**2,
            2.0 * turned.real, -2.0 * turned.imag,
            -2.0 * d.real, -2.0 * d.imag,
            -2.0 * e.real, 2.0 * e.imag,
            one,
        )  # fmt: skip
        return np.stack(parts, axis=-1)

    @staticmethod
    def doubt(entries: Array) -> Array:
        """Bounds of the errors of entries of rows, from their sizes (…, 8), in unit roundoffs."""
        # points are at most 1 from the centre: no factor of an entry exceeds 2
        return np.asarray(_ROUNDINGS * np.maximum(entries, 2.0))


def quadrics(x: AnyArray) -> AnyArray:
    """Both quadrics, (…, 2), at x (…, 8), real or complex: a B - Ḡ A by real and imaginary part."""
    a, p, q, g, h, u, v, _ = np.moveaxis(x, -1, 0)
    return np.stack([a * u - (g * p + h * q), a * v - (g * q - h * p)], axis=-1)


def quadric_gradients(x: AnyArray) -> AnyArray:
    """Their derivatives, (…, 2, 8)."""
    a, p, q, g, h, u, v, _ = np.moveaxis(x, -1, 0)
    o = np.zeros_like(a)
    first = np.stack([u, -g, -h, -p, -q, a, o, o], axis=-1)
    second = np.stack([v, h, -g, -q, p, o, a, o], axis=-1)
    return np.stack([first, second], axis=-2)


# ----------------------------------------------------------------------
# Proof of the solutions of dyads' equations: Newton-Kantorovich in all eight coordinates.
#
# The system has five linear rows, both quadrics and the norm n·x = 1. Its second derivatives are
# constant. Four proved solutions that differ are all there are, since two conics meet in four
# points.


_ROWS = 5
_DYAD_PROOF_POLISHES = 2
# roundings of one complex row: a product has three, a sum of eight products eight more
_LOSS = 12.0
#: From the largest coordinate of an error to its length.
_LENGTH = COORDINATES**0.5
# errors longer than this would need the exact angle between lines
_LARGEST = 0.1


@dataclass(frozen=True, kw_only=True, eq=False)
class DyadProofs:
    """Solutions x (N, 4, 8) of length 1, whether they are real, are proved, and differ from all
    others; the errors of their coordinates and the conditions, (N, 4); ``complete`` (N,).
    """

    x: ComplexArray
    is_real: BoolArray
    proved: BoolArray
    error: Array
    condition: Array
    complete: BoolArray

    def with_better(self, index: IndexArray, other: DyadProofs) -> DyadProofs:
        """The dyads, with the solutions of another attempt where it proved more."""
        better = other.proved.sum(axis=1) > self.proved[index].sum(axis=1)
        changes = {}
        for name, known in vars(self).items():
            values = known.copy()
            values[index[better]] = getattr(other, name)[better]
            changes[name] = values
        return replace(self, **changes)


def prove_dyads(
    rows: Array, null: Array, inverse: Array, y: ComplexArray, precise: AnyArray | None = None
) -> DyadProofs:
    """Refine and prove solutions y (N, 4, 3) in the null space (N, 8, 3) of rows (N, 5, 8), whose
    pseudo-inverse is ``inverse`` (N, 8, 5).

    ``precise``: the rows in extended precision, in which residuals are then evaluated. The largest
    provable condition grows from about 1e7 to 1e9.
    """
    precise = rows if precise is None else precise
    unit = UNIT_ROUNDOFF if precise.dtype == np.float64 else EXTENDED_EPSILON / 2.0
    x = _turned_real(y @ null.transpose(0, 2, 1))
    is_real = (x.imag == 0).all(axis=2)
    x = x.astype(np.result_type(precise, x))
    for step in range(_DYAD_PROOF_POLISHES + 1):
        near = x.astype(np.complex128)
        n = near.conj()
        # (N, 4, 3, 8)
        gradients = np.concatenate([n[:, :, None], quadric_gradients(near)], axis=2)
        answer = _inverse(gradients, null, inverse)
        f = np.concatenate(
            [
                x @ precise.transpose(0, 2, 1),
                np.sum(n * x, axis=2, keepdims=True) - 1.0,
                quadrics(x),
            ],
            axis=2,
        )
        if step < _DYAD_PROOF_POLISHES:
            x = x - np.nan_to_num(_matrix_vector(answer, f.astype(np.complex128)))
            x = x / np.sqrt(np.sum(np.abs(x) ** 2, axis=2, keepdims=True))
    jacobian = np.concatenate(
        [np.broadcast_to(rows[:, None], (*x.shape[:2], *rows.shape[1:])), gradients], axis=2
    )
    holds, error = _kantorovich(answer, jacobian, f, near, unit)
    with np.errstate(all="ignore"):
        condition = _row_sums(answer) * _row_sums(jacobian)
    # x is rounded to double precision in the end
    x, error = near, error + (2.0 * UNIT_ROUNDOFF if unit < UNIT_ROUNDOFF else 0.0)
    length = _LENGTH * error
    differs = _distances(x, x.conj()) > 1.5 * 2.0 * length
    proved = holds & (is_real | differs) & (length < _LARGEST)
    for i, j in combinations(range(x.shape[1]), 2):
        apart = _distances(x[:, i], x[:, j]) > 1.5 * (length[:, i] + length[:, j])
        proved[:, i] &= apart
        proved[:, j] &= apart
    return DyadProofs(
        x=x,
        is_real=is_real,
        proved=proved,
        error=error,
        condition=condition,
        complete=proved.all(axis=1),
    )


def _turned_real(x: ComplexArray) -> ComplexArray:
    """Vectors (N, 4, 8) of length 1, turned until their largest coordinate is real; those that are
    almost real become real.
    """
    largest = np.take_along_axis(x, np.abs(x).argmax(axis=2)[..., None], axis=2)
    turned = x * (largest.conj() / np.abs(largest))
    almost = np.abs(turned.imag).max(axis=2, keepdims=True) < ALMOST_REAL
    turned = np.where(almost, turned.real, turned)
    return np.asarray(turned / np.linalg.norm(turned, axis=2, keepdims=True))


def _inverse(gradients: ComplexArray, null: Array, inverse: Array) -> ComplexArray:
    """An approximate inverse (N, 4, 8, 8) of the Jacobian, from that of the linear rows."""
    small = gradients @ null[:, None]  # (N, 4, 3, 3)
    a, b, c = np.moveaxis(small, -2, 0)
    columns = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)
    with np.errstate(all="ignore"):
        columns = columns / np.sum(a * columns[..., 0], axis=-1)[..., None, None]
    right = null[:, None] @ np.nan_to_num(columns)
    left = inverse[:, None] - right @ (gradients @ inverse[:, None])
    return np.concatenate([left, right], axis=-1)


def _kantorovich(
    answer: ComplexArray, jacobian: ComplexArray, f: AnyArray, x: ComplexArray, unit: float
) -> tuple[BoolArray, Array]:
    """Whether a solution exists near x (N, 4, 8), and within which distance of every coordinate."""
    size, entries = np.abs(answer), np.abs(jacobian)
    uncertain = _LOSS * entries
    uncertain[:, :, :_ROWS] += NormalPoses.doubt(entries[:, :, :_ROWS])
    of_f = unit * _matrix_vector(uncertain, np.abs(x))
    # singular Jacobians have answers without bounds, and no proof
    with np.errstate(all="ignore"):
        # eq. (25)
        y = np.abs(_matrix_vector(answer, f.astype(np.complex128)))
        y += _matrix_vector(size, of_f + 2.0 * _LOSS * UNIT_ROUNDOFF * np.abs(f).astype(float))
        z = np.abs(np.eye(COORDINATES) - answer @ jacobian)
        z += UNIT_ROUNDOFF * (size @ (uncertain + _LOSS * entries))
        y0 = y.max(axis=2) * PROOF_SLACK
        z0 = z.sum(axis=3).max(axis=2) * PROOF_SLACK
        omega = CURVATURE * size[..., _ROWS + 1 :].sum(axis=3).max(axis=2) * PROOF_SLACK
        rest = (1.0 - z0) ** 2 - 2.0 * omega * y0
        holds = (z0 < 1.0) & (rest > 0)
        radius = 2.0 * y0 / (1.0 - z0 + np.sqrt(np.maximum(rest, 0.0))) * PROOF_SLACK
    return holds, np.where(holds, radius, np.inf)


def _row_sums(matrices: ComplexArray) -> Array:
    return np.asarray(np.abs(matrices).sum(axis=-1).max(axis=-1))


def _distances(x: ComplexArray, other: ComplexArray) -> Array:
    """The sines (…) of the angles between complex lines of unit vectors (…, 8)."""
    along = np.sum(other.conj() * x, axis=-1, keepdims=True)
    return np.asarray(np.linalg.norm(x - along * other, axis=-1))


def _matrix_vector(matrices: AnyArray, vectors: AnyArray) -> AnyArray:
    """A x for matrices (…, n, m) and vectors (…, m), (…, n)."""
    return (matrices @ vectors[..., None])[..., 0]


# ----------------------------------------------------------------------
# All dyads that carry a body through five poses, each proved or with the reason why not.


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
class Dyads(DyadProofs):
    """The solutions for N tasks, four each, and why some are no proved dyads.

    Parameters
    ----------
    x : (N, 4, 8) complex
        Solutions in the coordinates of :mod:`~linkwork.synthesis.poses.dyads`, real where
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

    refusal: StatusArray
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
    arrays = [field.name for field in fields(Dyads) if field.name != "poses"]
    return Dyads(
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in arrays},
        poses=NormalPoses.of(points, angles),
    )


def _solve_part(points: ComplexArray, angles: Array, further: Array) -> Dyads:
    proofs, family = _proved(points, angles, further)
    refusal = np.where(proofs.is_real, Refusal.NONE.code, Refusal.COMPLEX.code)
    refusal[~proofs.proved] = Refusal.COINCIDENT.code
    flat = np.abs(proofs.x[..., :5]).max(axis=2) * _FAR < np.abs(proofs.x).max(axis=2)
    refusal[flat] = Refusal.NO_JOINT.code
    refusal[family] = Refusal.FAMILY.code
    known = replace(
        proofs,
        is_real=proofs.is_real & ~flat & ~family[:, None],
        error=np.where(proofs.proved, proofs.error, np.inf),
        complete=proofs.complete & ~family,
    )
    poses = NormalPoses.of(points, angles)
    return Dyads(**vars(known), refusal=refusal.astype(np.int8), poses=poses)


def _proved(
    points: ComplexArray, angles: Array, further: Array, view: int = 0
) -> tuple[DyadProofs, BoolArray]:
    """The four solutions, and which tasks have infinitely many.

    Tasks without four proofs are solved again with conics seen from elsewhere, in extended
    precision.
    """
    poses = NormalPoses.of(points, angles)
    rows = np.concatenate([poses.rows(), further], axis=1)
    left, sizes, right = np.linalg.svd(rows)
    family = sizes[:, -1] < RANK_TOLERANCE * sizes[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = right[:, :FIVE].transpose(0, 2, 1) / sizes[:, None] @ left.transpose(0, 2, 1)
    null = right[:, FIVE:].transpose(0, 2, 1) @ _view(view)
    # the quadrics' second derivatives are those of their gradients
    second = quadric_gradients(np.eye(COORDINATES)).transpose(1, 0, 2)  # (2, 8, 8)
    first, other = (0.5 * null.transpose(0, 2, 1) @ form @ null for form in second)
    precise: AnyArray | None = None
    if view:
        long = poses.in_extended_precision(points, angles).rows()
        precise = np.concatenate([long, further], axis=1)
    proofs = prove_dyads(rows, null, np.nan_to_num(inverse), common_points(first, other), precise)
    again = np.flatnonzero(~proofs.complete & ~family)
    if again.size and view + 1 < _VIEWS:
        other_view, _ = _proved(points[again], angles[again], further[again], view + 1)
        proofs = proofs.with_better(again, other_view)
    return proofs, family
