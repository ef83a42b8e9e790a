"""Piecewise functions in ball arithmetic, from the numbers that define them."""

from __future__ import annotations

from fractions import Fraction

from flint import arb, fmpq

from linkwork.core.table.rows import Piecewise

__all__ = ["ball_jet", "exact", "piece_jet"]


def exact(x: float) -> fmpq:
    """A float as the ratio that it is."""
    ratio = Fraction(float(x))
    return fmpq(ratio.numerator, ratio.denominator)


def piece_jet(law: Piecewise, piece: int, t: arb) -> tuple[arb, arb, arb]:
    """Value and two derivatives of one piece at t, wherever that lies."""
    found = [arb(0), arb(0), arb(0)]
    for k, c in enumerate(law.powers[piece]):
        for order in range(3):
            factor = 1
            for j in range(order):
                factor *= k - j
            if factor:
                found[order] += arb(float(c)) * factor * t ** (k - order)
    a, w, p = (arb(float(x)) for x in law.sines[piece])
    angle = w * t + p
    found[0] += a * angle.sin()
    found[1] += a * w * angle.cos()
    found[2] -= a * w**2 * angle.sin()
    return found[0], found[1], found[2]


def ball_jet(law: Piecewise, x: arb) -> tuple[arb, arb, arb]:
    """Value and two derivatives at x; the piece is that of the middle of the ball x."""
    breaks = [exact(b) for b in law.breaks]
    low, high = breaks[0], breaks[-1]
    middle = _middle(x)
    turns = (middle - low) / (high - low)
    if law.periodic:
        whole = turns.floor() * (high - low)
        inside, beyond = x - arb(whole), arb(0)
        middle -= whole
    else:
        nearest = max(low, min(middle, high))
        inside = x if low <= middle <= high else arb(nearest)
        beyond, middle = x - inside, nearest
    piece = max(k for k, b in enumerate(breaks[:-1]) if b <= middle)
    value, first, second = piece_jet(law, piece, inside - arb(breaks[piece]))
    if not law.periodic and not (low <= _middle(x) <= high):
        return value + first * beyond, first, arb(0)
    return value, first, second


def _middle(x: arb) -> fmpq:
    mantissa, exponent = x.mid().man_exp()
    return fmpq(int(mantissa)) * fmpq(2) ** int(exponent)
