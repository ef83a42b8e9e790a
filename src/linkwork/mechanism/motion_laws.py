"""Motion laws of cam followers and inputs: rises from 0 to 1 while x goes from 0 to 1.

A law is a polynomial, or is integrated from rest from accelerations α + A sin(ω t + ψ) (Norton, Cam
Design and Manufacturing Handbook, chapters 3 and 4; VDI 2143).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["INPUT_LAWS", "LAWS", "Piece", "pieces_of"]


@dataclass(frozen=True)
class Piece:
    """Σ c_k t^k + A sin(ω t + ψ) for t from 0 to ``over``; ``sine`` is (A, ω, ψ)."""

    over: float
    powers: tuple[float, ...]
    sine: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class _Accelerated:
    """α + A sin(ω t + ψ) for t from 0 to ``over``."""

    over: float
    constant: float = 0.0
    amplitude: float = 0.0
    rate: float = 1.0
    phase: float = 0.0


_POLYNOMIALS: dict[str, tuple[float, ...]] = {
    "3-4-5": (0.0, 0.0, 0.0, 10.0, -15.0, 6.0),
    "4-5-6-7": (0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0),
}
_PI = math.pi
_ACCELERATIONS: dict[str, tuple[_Accelerated, ...]] = {
    "harmonic": (_Accelerated(1.0, 0.0, 1.0, _PI, _PI / 2),),
    "cycloidal": (_Accelerated(1.0, 0.0, 1.0, 2 * _PI, 0.0),),
    "modified sine": (
        _Accelerated(1 / 8, 0.0, 1.0, 4 * _PI, 0.0),
        _Accelerated(3 / 4, 0.0, 1.0, 4 * _PI / 3, _PI / 2),
        _Accelerated(1 / 8, 0.0, 1.0, 4 * _PI, 3 * _PI / 2),
    ),
    "modified trapezoid": (
        _Accelerated(1 / 8, 0.0, 1.0, 4 * _PI, 0.0),
        _Accelerated(1 / 4, 1.0),
        _Accelerated(1 / 4, 0.0, 1.0, 4 * _PI, _PI / 2),
        _Accelerated(1 / 4, -1.0),
        _Accelerated(1 / 8, 0.0, 1.0, 4 * _PI, 3 * _PI / 2),
    ),
}

#: The laws by name; a dwell has no pieces.
LAWS = ("dwell", *_ACCELERATIONS, *_POLYNOMIALS)
_ACCELERATIONS["trapezoid"] = (
    _Accelerated(1 / 3, 1.0),
    _Accelerated(1 / 3, 0.0),
    _Accelerated(1 / 3, -1.0),
)
#: Further laws of inputs, which a cam could not follow: its follower would be thrown off. A ramp
#: begins at the speed of the segment before it.
INPUT_LAWS = (*LAWS, "constant", "ramp", "trapezoid")


def pieces_of(law: str) -> tuple[Piece, ...]:
    """The pieces of a law in order."""
    if law == "dwell":
        return (Piece(1.0, (0.0,)),)
    if law == "constant":
        return (Piece(1.0, (0.0, 1.0)),)
    if law in _POLYNOMIALS:
        return (Piece(1.0, _POLYNOMIALS[law]),)
    found, place, speed = [], 0.0, 0.0
    for part in _ACCELERATIONS[law]:
        a, w, p = part.amplitude, part.rate, part.phase
        shift = (place + a * math.sin(p) / w**2, speed + a * math.cos(p) / w, part.constant / 2)
        found.append(Piece(part.over, shift, (-a / w**2, w, p)))
        end = w * part.over + p
        place = shift[0] + shift[1] * part.over + shift[2] * part.over**2
        place -= a * math.sin(end) / w**2
        speed += part.constant * part.over - a * (math.cos(end) - math.cos(p)) / w
    return tuple(
        Piece(
            piece.over,
            tuple(c / place for c in piece.powers),
            (piece.sine[0] / place, *piece.sine[1:]),
        )
        for piece in found
    )
