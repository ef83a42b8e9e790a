"""Positions of one loop at any input of its branch, in closed form."""

from __future__ import annotations

import numpy as np

from linkwork.design.loops.candidates import Candidates, Drive, LoopKind
from linkwork.design.loops.guide_loops import guide_pivots_at
from linkwork.design.loops.loop_limits import DrivenLoops, cross, dot
from linkwork.foundation.arrays import Array, ComplexArray

__all__ = ["pivots_at"]


def pivots_at(
    given: Candidates, drive: Drive, loops: DrivenLoops, place: Array
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """The pivots A and B and the guided point P on the branch of the first position.

    Parameters
    ----------
    given, drive, loops
        D designs.
    place : (D, K)
        Inputs measured from the loops' origins.

    Returns
    -------
    A, B, P : (D, K) complex
        NaN where the loop cannot be closed.
    """
    if not given.kind.has_crank:
        return guide_pivots_at(given, drive, loops, place)
    if given.kind is LoopKind.INVERTED:
        return _inverted_at(given, drive, loops, place)
    other = given.driven_at_b() if drive is Drive.B0 else given
    side = np.sign(loops.side[:, :1])
    first, second = other.moving_a[:, :1], other.moving_b[:, :1]
    length = np.abs(second - first)
    with np.errstate(invalid="ignore"):
        if drive is Drive.SLIDER:
            b = other.fixed_b[:, None] + (place + loops.origin[:, None]) * other.direction[:, None]
            crank = np.abs(first - other.fixed_a[:, None])
            a = b + _closed(other.fixed_a[:, None] - b, length, crank, side)
        else:
            phase = np.exp(1j * (place + loops.origin[:, None]))
            fixed = other.fixed_a[:, None]
            a = fixed + np.abs(first - fixed) * phase
            if given.kind is LoopKind.FOUR_BAR:
                pivot = other.fixed_b[:, None]
                b = a + _closed(pivot - a, length, np.abs(second - pivot), side)
            else:
                along = other.direction[:, None]
                height = dot(1j * along, a - other.fixed_b[:, None])
                b = a + (side * np.sqrt(length**2 - height**2) - 1j * height) * along
    body = (other.guided[:, :1] - first) / (second - first)
    p = a + body * (b - a)
    return (b, a, p) if drive is Drive.B0 else (a, b, p)


def _inverted_at(
    given: Candidates, drive: Drive, loops: DrivenLoops, place: Array
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """The same of inverted slider-cranks."""
    side = np.sign(loops.side[:, :1])
    first, block = given.moving_a[:, :1], given.fixed_b[:, None]
    line, fixed = given.lines[:, :1], given.fixed_a[:, None]
    phase = np.exp(1j * (place + loops.origin[:, None]))
    with np.errstate(invalid="ignore"):
        if drive is Drive.A0:
            a = fixed + np.abs(first - fixed) * phase
            # B0 - A = (s + ih) times the line
            base, h = block - a, cross(line, block - first)
            along = base / (side * np.sqrt(base.real**2 + base.imag**2 - h**2) + 1j * h)
        else:
            along = phase
            across = loops.q(place)
            reach = side * np.sqrt(np.abs(first - fixed) ** 2 - across**2)
            a = fixed + (reach + 1j * across) * along
    b = a + (given.moving_b[:, :1] - first) / line * along
    p = a + (given.guided[:, :1] - first) / line * along
    return a, b, p


def _closed(base: ComplexArray, one: Array, other: Array, side: Array) -> ComplexArray:
    """The vector of length ``one`` from the start of the base to the apex of a triangle, whose
    other side has length ``other``.
    """
    square = base.real**2 + base.imag**2
    along = 0.5 * (square + one**2 - other**2)
    across = np.sqrt(square * one**2 - along**2)
    return np.asarray(base * (along + 1j * side * across) / square)
