"""Quadratic equations with whole coefficients, as sums of products of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import normal_numbers
from linkwork.circuits.homotopy.path_tracking import Equations
from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray

ComplexPlace = tuple[int, int]  # the places in v of a real and an imaginary part


@dataclass(frozen=True, kw_only=True, eq=False)
class ProductSums:
    """Sums of products k v_i v_j.

    Parameters
    ----------
    unknowns : int
        n, the first numbers of v; there are as many equations.
    size : int
        How many numbers v has; the last but one is 1.
    row, factor, one, other : (T,)
        The equation of every product, k, i and j.
    """

    unknowns: int
    size: int
    row: IndexArray
    factor: IndexArray
    one: IndexArray
    other: IndexArray

    def exact_residual(self, v: Sequence[int]) -> list[int]:
        """F of whole numbers v, without rounding, in the square of their unit."""
        residual = [0] * self.unknowns
        for row, factor, i, j in self._terms:
            residual[row] += factor * v[i] * v[j]
        return residual

    @cached_property
    def _terms(self) -> list[tuple[int, int, int, int]]:
        """The equation of every product, k, i and j, as plain numbers."""
        columns = (x.tolist() for x in (self.row, self.factor, self.one, self.other))
        return list(zip(*columns, strict=True))

    def jacobian(self, v: Array) -> Array:
        """∂F/∂v by the unknowns (B, n, n) at v (B, V)."""
        return self._slopes(v, 1)

    def jacobian_size(self, v: Array) -> Array:
        """The same with all terms positive, for |v| (B, V)."""
        return self._slopes(v, -1)

    def _slopes(self, v: Array, negative: int) -> Array:
        """``negative``: -1 turns negative factors."""
        wide = np.zeros((self.unknowns, self.size, len(v)))
        for row, factor, i, j in self._terms:
            coefficient = factor if factor > 0 else negative * factor
            wide[row, i] += coefficient * v[:, j]
            wide[row, j] += coefficient * v[:, i]
        return np.ascontiguousarray(wide[:, : self.unknowns].transpose(2, 0, 1))

    def curvature(self, weights: Array) -> Array:
        """Bounds of D²F along directions of the largest norm 1 in weights (B, n), (B, n)."""
        both = (self.one < self.unknowns) & (self.other < self.unknowns)
        curvature = np.zeros((self.unknowns, len(weights)))
        for row, factor, i, j in zip(
            self.row[both], np.abs(self.factor[both]), self.one[both], self.other[both], strict=True
        ):
            curvature[row] += 2.0 * factor * weights[:, i] * weights[:, j]
        return curvature.T


@dataclass
class ProductWriter:
    """Collects products; complex numbers are pairs of places in v."""

    rows: list[tuple[int, int, int, int]] = field(default_factory=list)
    count: int = 0

    def equation(self, *terms: tuple[int, int, int]) -> None:
        self.rows += [(self.count, *term) for term in terms]
        self.count += 1

    def equal_lengths(self, one: ComplexPlace, other: ComplexPlace) -> None:
        """|A|² = |x|²."""
        self.equation(*[(1, k, k) for k in one], *[(-1, k, k) for k in other])

    def equal_products(
        self, a: ComplexPlace, b: ComplexPlace, c: ComplexPlace, d: ComplexPlace
    ) -> None:
        """a b = c d."""
        self.equation((1, a[0], b[0]), (-1, a[1], b[1]), (-1, c[0], d[0]), (1, c[1], d[1]))
        self.equation((1, a[0], b[1]), (1, a[1], b[0]), (-1, c[0], d[1]), (-1, c[1], d[0]))

    def sums(self, unknowns: int, size: int) -> ProductSums:
        """The equations of ``unknowns`` numbers, the first of ``size``."""
        row, factor, one, other = np.array(self.rows, dtype=np.intp).T
        return ProductSums(
            unknowns=unknowns, size=size, row=row, factor=factor, one=one, other=other
        )


# ----------------------------------------------------------------------
# Roberts' cognates of a four-bar, in isotropic coordinates: three linkages with one coupler curve.
#
# A linkage is x, x̄, a, ā, y, ȳ, b, b̄: moving pivots A, B and fixed pivots A0, B0 from the traced
# point, see above. The third fixed pivot makes a triangle with
# A0 and B0 that is similar to the coupler's (E. A. Dijksman, Motion Geometry of Mechanisms, 1976).


def third_pivot(linkage: ComplexArray) -> ComplexArray:
    """c and c̄ of linkages (B, 8), (B, 2)."""
    x, a, y, b = (linkage[:, k : k + 2] for k in (0, 2, 4, 6))
    with np.errstate(all="ignore"):
        pivot: ComplexArray = a + x / (x - y) * (b - a)  # eq. (113)
    return pivot


def exchange_legs(linkage: ComplexArray) -> ComplexArray:
    """The same linkages (B, 8) with A and A0 named B and B0."""
    return np.concatenate([linkage[:, 4:], linkage[:, :4]], axis=1)


def cognates(linkage: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Both cognates of linkages (B, 8): with the fixed pivots A0, C0, and with B0, C0."""
    pivot, pair = third_pivot(linkage), []
    for leg in (linkage, exchange_legs(linkage)):
        x, a, y = (leg[:, k : k + 2] for k in (0, 2, 4))
        with np.errstate(all="ignore"):
            # parallelogram A0 A P A', and a coupler similar to A B P
            moved, beside = a - x, (a - x) * y / (y - x)
        pair.append(np.concatenate([moved, a, beside, pivot], axis=1))
    return pair[0], pair[1]


# ----------------------------------------------------------------------
# Four-bars through precision positions, as polynomial equations in isotropic coordinates.
#
# The first position is the reference. From its point P0 the moving pivots A and B and the fixed
# pivots A0 and B0 are the complex numbers x, y, a, b; x̄, ȳ, ā, b̄ are unknowns of their own, which
# are conjugates at real solutions. A position at the distance δ from P0 in which the coupler has
# turned by e = 1 + γ keeps the length of both bars, with ē = 1/e:
#
#     p γ + q γ̄ + r = 0,   p = (ā - δ̄) x,   q = (a - δ) x̄,   r = δ(ā - x̄) + δ̄(a - x) - δδ̄,
#
# and u γ + v γ̄ + w = 0 alike with y and b. A pose gives e, hence two equations. A point does not:
# with D = pv - qu, G = qw - vr and H = ru - pw the equation of e alone is
#
#     G H + (G + H) D = 0
#
# (Wampler, Morgan, Sommese 1992, J. Mech. Des. 114, 153, in isotropic form). A given distance of
# two pivots, or of one and the traced point, is (x - a)(x̄ - ā) = L², with L² as a parameter.


#: Conditions that a four-bar can meet, not counting the first position.
CONDITIONS = 8
#: Where the pivots are in x, x̄, a, ā, y, ȳ, b, b̄; the traced point is at 0.
PLACES = {"A": 0, "A0": 2, "B": 4, "B0": 6}
_SYMMETRIC = {("A", "B"), ("A0", "B0")}  # lengths that stay if the legs exchange their names
_TURN = 0.7  # rad, of random complex rotations
_TRIES = 60  # steps of Newton's method towards random positions of a random linkage,
_CLOSED = 1e-10  # and how many conditions they may leave open
_NOTHING = 1e-9  # of the largest number of a solution: zero
_FAR = 10.0  # random positions further away make a bad start


@dataclass(frozen=True)
class PrecisionProblem:
    """All four-bars through some poses and points, or with some fixed pivots and lengths given.

    Parameters
    ----------
    poses, points : int
        Given after the first position.
    pivots : int
        Fixed pivots that are given: A0, or A0 and B0.
    lengths : tuple of (str, str)
        The ends of given lengths: A, A0, B, B0 or the traced point P.

    Notes
    -----
    Unknowns are x, x̄, a, ā, y, ȳ, b, b̄ without those that are given; parameters are e, δ, δ̄ of
    every pose, δ, δ̄ of every point, a, ā, b, b̄ of pivots, and the squares of lengths.
    """

    poses: int
    points: int
    pivots: int = 0
    lengths: tuple[tuple[str, str], ...] = ()

    @property
    def unknowns(self) -> int:
        """n."""
        return CONDITIONS - 2 * self.pivots

    @property
    def freedoms(self) -> int:
        """Conditions that are missing until a finite number of four-bars is left."""
        conditions = 2 * self.poses + self.points + 2 * self.pivots + len(self.lengths)
        return CONDITIONS - conditions

    @property
    def parameters(self) -> int:
        """P."""
        return 3 * self.poses + 2 * self.points + 2 * self.pivots + len(self.lengths)

    @property
    def fixed(self) -> tuple[int, ...]:
        """Indices of the given ones among x, x̄, a, ā, y, ȳ, b, b̄."""
        return (2, 3, 6, 7)[: 2 * self.pivots]

    @property
    def free(self) -> tuple[int, ...]:
        """Indices of the unknown ones among x, x̄, a, ā, y, ȳ, b, b̄."""
        return tuple(k for k in range(CONDITIONS) if k not in self.fixed)

    @property
    def last(self) -> slice:
        """The parameters of the last point."""
        first = 3 * self.poses + 2 * self.points
        return slice(first - 2, first)

    @property
    def name(self) -> str:
        """The name of its start set."""
        lengths = "".join(f"-{one}{other}" for one, other in self.lengths)
        return f"{self.poses + 1}-{self.points}-{self.pivots}{lengths}"

    def equations(self, z: Sequence[Any], c: Sequence[Any], rate: Sequence[Any]) -> Equations:
        """The equations, with operators alone."""
        first = 3 * self.poses + 2 * self.points
        end = first + 2 * self.pivots
        places, numbers = (*self.free, *self.fixed), (*z, *c[first:end])
        linkage = [number for _, number in sorted(zip(places, numbers, strict=True), key=_place)]
        rows = list[_Row]()
        for k in range(0, 3 * self.poses, 3):
            rows += _pose_rows(linkage, c[k : k + 3], rate[k : k + 3])
        for k, ends in enumerate(self.lengths, start=end):
            rows.append(_length_row(linkage, ends, c[k], rate[k]))
        # points are last, as the trace test wants it
        for k in range(3 * self.poses, first, 2):
            rows.append(_point_row(linkage, c[k : k + 2], rate[k : k + 2]))
        changes = [
            sum((slopes[k] * r for k, r in zip(self.fixed, rate[first:end], strict=True)), change)
            for _, slopes, change in rows
        ]
        slopes = [[row[k] for k in self.free] for _, row, _ in rows]
        return [value for value, _, _ in rows], slopes, changes

    def proper(self, x: ComplexArray, c: ComplexArray) -> BoolArray:
        """Which solutions (B, n) are linkages: where both bars turn at one point anything goes."""
        linkage = self.linkages(x, c)
        legs = linkage.reshape(len(x), 2, 2, 2)  # leg, pivot, number or its conjugate
        far = np.abs(legs).max(axis=(1, 2, 3), initial=1.0)[:, None]
        moving = np.abs(legs[:, :, 0]).max(axis=1)  # x = y = 0, or x̄ = ȳ = 0
        apart = np.abs(legs[:, 0] - legs[:, 1]).max(axis=1)  # x = y and a = b, or conjugates
        good: BoolArray = ((moving > _NOTHING * far) & (apart > _NOTHING * far)).all(axis=1)
        return good

    def is_real(self, c: ComplexArray) -> bool:
        """Whether parameters (P,) are those of real positions."""
        first, width = 3 * self.poses, 2 * (self.points + self.pivots)
        turns, moved = c[:first].reshape(-1, 3), c[first : first + width].reshape(-1, 2)
        pairs = np.concatenate([turns[:, 1:], moved])
        turned = np.abs(turns[:, 0])
        conjugate = (pairs[:, 0] == pairs[:, 1].conj()).all() and (c[first + width :].imag == 0.0)
        return bool(conjugate.all() and np.allclose(turned, 1.0))

    def mirrored(self, x: ComplexArray) -> ComplexArray:
        """The mirror images (B, n): x̄ in place of x, and so on."""
        swapped = np.arange(self.unknowns) ^ 1
        return x[:, swapped].conj()

    def fingerprint(self, x: ComplexArray, c: ComplexArray) -> ComplexArray:
        """Numbers (B, K) that are equal for solutions of one linkage, or of one triple of cognates.

        Both pairs of a moving and a fixed pivot may be named A and A0. Cognates go through the same
        points, not through the same poses, and have other lengths.
        """
        no_cognates = self.poses or self.lengths
        if self.pivots == 2 or (self.pivots and no_cognates) or set(self.lengths) - _SYMMETRIC:
            return x
        linkage = self.linkages(x, c)
        ground, a, other, b = (linkage[:, k : k + 2] for k in (0, 2, 4, 6))
        if no_cognates:
            return np.concatenate([ground + other, a + b, ground * a + other * b], axis=1)
        third = third_pivot(linkage)
        if self.pivots:
            return np.concatenate([b + third, b * third, ground * (a - ground)], axis=1)
        return np.concatenate([a + b + third, a * b * third], axis=1)

    def random_parameters(self, rng: np.random.Generator) -> ComplexArray:
        """Random complex parameters (P,)."""
        return self._parameters(
            _random_turns(rng, self.poses),
            normal_numbers(rng, 2, self.poses + self.points),
            normal_numbers(rng, 2 * self.pivots),
            normal_numbers(rng, len(self.lengths)),
        )

    def random_member(self, rng: np.random.Generator) -> tuple[ComplexArray, ComplexArray]:
        """Random parameters (P,) and one of their solutions (n,): positions of a random linkage."""
        count = self.poses + self.points
        while True:
            linkage = normal_numbers(rng, CONDITIONS)
            turns = _random_turns(rng, count)
            moved = _positions_of(linkage, turns, normal_numbers(rng, 2, count))
            if np.abs(moved).max(initial=0.0) < _FAR:  # also false for numbers that are none
                break
        ends = linkage.tolist()
        squares: ComplexArray = np.array(
            [_length_row(ends, pair, 0.0, 0.0)[0] for pair in self.lengths], dtype=np.complex128
        )
        return (
            self._parameters(turns[: self.poses], moved, linkage[list(self.fixed)], squares),
            linkage[list(self.free)],
        )

    def linkages(self, x: ComplexArray, c: ComplexArray) -> ComplexArray:
        """Solutions (B, n) at the parameters c (P,) with their given pivots, (B, 8)."""
        whole = np.empty((len(x), CONDITIONS), dtype=complex)
        whole[:, list(self.free)] = x
        first = 3 * self.poses + 2 * self.points
        whole[:, list(self.fixed)] = c[first : first + 2 * self.pivots]
        return whole

    def _parameters(
        self, turns: ComplexArray, moved: ComplexArray, pivots: ComplexArray, squares: ComplexArray
    ) -> ComplexArray:
        poses = np.column_stack([turns, *moved[:, : self.poses]])
        points = moved[:, self.poses :].T
        return np.concatenate([poses.ravel(), points.ravel(), pivots, squares])


def _place(pair: tuple[int, Any]) -> int:
    return pair[0]


#: The value of an equation, its derivatives by x, x̄, a, ā, y, ȳ, b, b̄, and its change.
_Row = tuple[Any, list[Any], Any]


def _leg_numbers(leg: Sequence[Any], d: Any, d_bar: Any) -> tuple[Any, Any, Any]:
    """p, q and r of a leg x, x̄, a, ā."""
    x, x_bar, a, a_bar = leg
    p, q = (a_bar - d_bar) * x, (a - d) * x_bar
    return p, q, d * (a_bar - x_bar) + d_bar * (a - x) - d * d_bar  # eq. (111)


def _pose_rows(linkage: Sequence[Any], pose: Sequence[Any], rate: Sequence[Any]) -> list[_Row]:
    """The equations of both legs in a pose e, δ, δ̄."""
    (e, d, d_bar), (e_rate, d_rate, d_bar_rate) = pose, rate
    e_bar = 1.0 / e
    g, g_bar, e_bar_rate = e - 1.0, e_bar - 1.0, e_rate * e_bar * e_bar
    rows = list[_Row]()
    for first in (0, 4):
        leg = linkage[first : first + 4]
        x, x_bar, a, a_bar = leg
        p, q, r = _leg_numbers(leg, d, d_bar)
        slopes_of_leg = [
            (a_bar - d_bar) * g - d_bar, (a - d) * g_bar - d,
            x_bar * g_bar + d_bar, x * g + d,
        ]  # fmt: skip
        change = p * e_rate - q * e_bar_rate
        change = change + (a_bar - x_bar - d_bar - x_bar * g_bar) * d_rate
        change = change + (a - x - d - x * g) * d_bar_rate
        slopes = [*slopes_of_leg, *[0.0] * 4] if first == 0 else [*[0.0] * 4, *slopes_of_leg]
        rows.append((p * g + q * g_bar + r, slopes, change))  # eq. (110)
    return rows


def _point_row(linkage: Sequence[Any], point: Sequence[Any], rate: Sequence[Any]) -> _Row:
    """The equation of a point δ, δ̄."""
    d, d_bar = point
    x, x_bar, a, a_bar, y, y_bar, b, b_bar = linkage
    p, q, r = _leg_numbers(linkage[:4], d, d_bar)
    u, v, w = _leg_numbers(linkage[4:], d, d_bar)
    det, g, h = p * v - q * u, q * w - v * r, r * u - p * w
    by_g, by_h, by_det = h + det, g + det, g + h
    # derivatives by p, q, r and u, v, w
    fp, fq, fr = v * by_det - w * by_h, w * by_g - u * by_det, u * by_h - v * by_g
    fu, fv, fw = r * by_h - q * by_det, p * by_det - r * by_g, q * by_g - p * by_h
    slopes = [
        (a_bar - d_bar) * fp - d_bar * fr, (a - d) * fq - d * fr,
        x_bar * fq + d_bar * fr, x * fp + d * fr,
        (b_bar - d_bar) * fu - d_bar * fw, (b - d) * fv - d * fw,
        y_bar * fv + d_bar * fw, y * fu + d * fw,
    ]  # fmt: skip
    by_d = fr * (a_bar - x_bar - d_bar) - fq * x_bar + fw * (b_bar - y_bar - d_bar) - fv * y_bar
    by_d_bar = fr * (a - x - d) - fp * x + fw * (b - y - d) - fu * y
    return g * h + by_det * det, slopes, by_d * rate[0] + by_d_bar * rate[1]  # eq. (112)


def _length_row(linkage: Sequence[Any], ends: tuple[str, str], square: Any, rate: Any) -> _Row:
    """The equation of a length, for its given square."""
    along, along_bar = 0.0, 0.0
    slopes: list[Any] = [0.0] * CONDITIONS
    signs = zip(ends, (1.0, -1.0), strict=True)
    pivots = [(PLACES[end], sign) for end, sign in signs if end in PLACES]
    for place, sign in pivots:
        along, along_bar = along + sign * linkage[place], along_bar + sign * linkage[place + 1]
    for place, sign in pivots:
        slopes[place], slopes[place + 1] = sign * along_bar, sign * along
    return along * along_bar - square, slopes, -rate  # eq. (112a)


def _random_turns(rng: np.random.Generator, count: int) -> ComplexArray:
    """Random complex rotations e."""
    turns: ComplexArray = np.exp(_TURN * 1j * normal_numbers(rng, count))
    return turns


def _positions_of(linkage: ComplexArray, turns: ComplexArray, start: ComplexArray) -> ComplexArray:
    """δ and δ̄, (2, J), in which a linkage (8,) has turned by ``turns`` (J,)."""
    moved = start.copy()
    with np.errstate(all="ignore"):
        for _ in range(_TRIES):
            by_both = []
            for rate in ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
                rows = _pose_rows(linkage.tolist(), (turns, *moved), rate)
                by_both.append([row[2] for row in rows])
            (a, b), (c, d) = by_both
            (f, _, _), (g, _, _) = rows
            moved = moved - np.array([d * f - c * g, a * g - b * f]) / (a * d - b * c)
    rows = _pose_rows(linkage.tolist(), (turns, *moved), (0.0, 0.0, 0.0))
    left = np.abs([row[0] for row in rows]).max()
    return moved if left < _CLOSED else np.full_like(moved, np.nan)
