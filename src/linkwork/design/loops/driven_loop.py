"""One loop and its input: where it can move, with bounds of the errors of every sign.

With the input φ (an angle) or s (a slider's displacement) the loop closes where

    low ≤ q ≤ high,    q = q0 + q1 cos(φ - φ0)  or  q = q0 + s²,                         eq. (144)

| loop | q | low, high | the side of the loop: sign of |
|---|---|---|---|
| four-bar driven at A0 | \\|A - B0\\|² | (b - c)², (b + c)² | (B - A) × (B - B0) |
| slider-crank driven at A0 | distance of A from the line | -c, c | (B - A) · line |
| slider-crank driven at B | \\|B - A0\\|² | (a - c)², (a + c)² | (A - B) × (A - A0) |
| inverted slider-crank driven at A0 | \\|A - B0\\|² | h², ∞ | (B0 - A) · line |
| inverted slider-crank driven at B0 | (A - A0) across the line | -a, a | (A - A0) · line |

h is the distance of A from the line of the coupler, which slides through B0.

A loop changes its side only at a limit, which is a dead point. Each limit that is reached cuts the
circle of inputs around one of its poles φ0, φ0 + π: two limits leave two circuits, one limit one
circuit, none two circuits that differ in their side.
"""

from __future__ import annotations

import numpy as np

from linkwork.design.loops.candidates import Candidates, Drive, LoopKind
from linkwork.design.loops.guide_loops import guide_loops
from linkwork.design.loops.loop_limits import (
    PRODUCT,
    DrivenLoops,
    angle_error,
    cross,
    dot,
    doubt_of,
    phase_of,
)

__all__ = ["driven_loops"]


def driven_loops(given: Candidates, drive: Drive) -> DrivenLoops:
    """The loops of designs with one driven link."""
    if not given.kind.has_crank:
        return guide_loops(given, drive)
    if given.kind is LoopKind.FOUR_BAR:
        return _four_bars(given if drive is Drive.A0 else given.driven_at_b())
    if given.kind is LoopKind.INVERTED:
        return _inverted(given) if drive is Drive.A0 else _driven_blocks(given)
    return _slider_cranks(given) if drive is Drive.A0 else _driven_sliders(given)


def _four_bars(given: Candidates) -> DrivenLoops:
    crank = given.moving_a - given.fixed_a[:, None]
    coupler = given.moving_b - given.moving_a
    rocker = given.moving_b - given.fixed_b[:, None]
    ground = given.fixed_b - given.fixed_a
    a, b, c = (np.abs(v[:, 0]) for v in (crank, rocker, coupler))
    g = np.abs(ground)
    size = np.maximum(np.maximum(a, b), np.maximum(c, g))
    doubt = doubt_of(given, size)
    toward = phase_of(ground)
    with np.errstate(all="ignore"):
        cosine = (b**2 + c**2) / (2.0 * b * c), -1.0 / (2.0 * b * c)
    return DrivenLoops(
        turns=True,
        input=phase_of(crank),
        input_error=angle_error(a, doubt),
        origin=toward + np.pi,
        q0=a**2 + g**2,
        q1=2.0 * a * g,
        low=(b - c) ** 2,
        high=(b + c) ** 2,
        upper=(a + g) - (b + c),
        lower=np.abs(b - c) - np.abs(a - g),
        limit_error=4.0 * doubt,
        side=cross(coupler, rocker),
        half=cross(crank, ground[:, None]),
        sign_error=PRODUCT * size * doubt,
        q_error=4.0 * PRODUCT * size * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )


def _slider_cranks(given: Candidates) -> DrivenLoops:
    crank = given.moving_a - given.fixed_a[:, None]
    rod = given.moving_b - given.moving_a
    normal = 1j * given.direction
    a, c = np.abs(crank[:, 0]), np.abs(rod[:, 0])
    height = dot(normal, given.fixed_a - given.fixed_b)
    size = np.maximum(np.maximum(a, c), np.abs(given.fixed_a - given.fixed_b))
    doubt = doubt_of(given, size)
    toward = phase_of(normal)
    with np.errstate(all="ignore"):
        cosine = np.zeros_like(c), 1.0 / c
    return DrivenLoops(
        turns=True,
        input=phase_of(crank),
        input_error=angle_error(a, doubt),
        origin=toward,
        q0=height,
        q1=a,
        low=-c,
        high=c,
        upper=height + a - c,
        lower=a - height - c,
        limit_error=4.0 * doubt,
        side=dot(rod, given.direction[:, None]),
        half=cross(normal[:, None], crank),
        sign_error=PRODUCT * doubt,
        q_error=4.0 * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )


def _driven_sliders(given: Candidates) -> DrivenLoops:
    crank = given.moving_a - given.fixed_a[:, None]
    rod = given.moving_a - given.moving_b
    a, c = np.abs(crank[:, 0]), np.abs(rod[:, 0])
    to_crank = given.fixed_a - given.fixed_b
    height = dot(1j * given.direction, to_crank)
    size = np.maximum(np.maximum(a, c), np.abs(given.moving_b - given.fixed_b[:, None]).max(axis=1))
    size = np.maximum(size, np.abs(to_crank))
    doubt = doubt_of(given, size)
    foot = dot(given.direction, to_crank)
    s = dot(given.direction[:, None], given.moving_b - given.fixed_b[:, None])
    with np.errstate(all="ignore"):
        cosine = (a**2 + c**2) / (2.0 * a * c), -1.0 / (2.0 * a * c)
    return DrivenLoops(
        turns=False,
        input=s,
        input_error=4.0 * doubt,
        origin=foot,
        q0=height**2,
        q1=np.ones_like(a),
        low=(a - c) ** 2,
        high=(a + c) ** 2,
        # a slider far enough away reaches the outer limit always
        upper=np.full_like(a, np.inf),
        lower=np.abs(a - c) - np.abs(height),
        limit_error=4.0 * doubt,
        side=cross(rod, crank),
        half=size[:, None] * (s - foot[:, None]),
        sign_error=PRODUCT * size * doubt,
        q_error=4.0 * PRODUCT * size * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )


def _inverted(given: Candidates) -> DrivenLoops:
    crank = given.moving_a - given.fixed_a[:, None]
    ground = given.fixed_b - given.fixed_a
    to_block, lines = given.fixed_b[:, None] - given.moving_a, given.lines
    a, g = np.abs(crank[:, 0]), np.abs(ground)
    h = np.abs(cross(lines[:, 0], to_block[:, 0]))
    size = np.maximum(np.maximum(a, g), np.abs(to_block).max(axis=1))
    doubt = 2.0 * doubt_of(given, size)
    return DrivenLoops(
        turns=True,
        input=phase_of(crank),
        input_error=angle_error(a, doubt),
        origin=phase_of(ground) + np.pi,
        q0=a**2 + g**2,
        q1=2.0 * a * g,
        low=h**2,
        high=np.full_like(h, np.inf),
        # a block on an endless line limits one side only
        upper=np.full_like(h, -np.inf),
        lower=h - np.abs(a - g),
        limit_error=4.0 * doubt,
        side=size[:, None] * dot(lines, to_block),
        half=cross(crank, ground[:, None]),
        sign_error=PRODUCT * size * doubt,
        q_error=4.0 * PRODUCT * size * doubt,
        cosine=(np.zeros_like(h), np.zeros_like(h)),
        # rounding alone makes an offset of zero positive
        offset=h + doubt,
    )


def _driven_blocks(given: Candidates) -> DrivenLoops:
    crank = given.moving_a - given.fixed_a[:, None]
    ground = given.fixed_a - given.fixed_b
    to_block, lines = given.fixed_b[:, None] - given.moving_a, given.lines
    a, g = np.abs(crank[:, 0]), np.abs(ground)
    # A is h to the right of the line, A0 is g cos(φ - φ0) to the right of its parallel through B0
    h = cross(lines[:, 0], to_block[:, 0])
    size = np.maximum(np.maximum(a, g), np.abs(to_block).max(axis=1))
    doubt = 2.0 * doubt_of(given, size)
    toward = phase_of(ground) + 0.5 * np.pi
    with np.errstate(all="ignore"):
        cosine = np.zeros_like(a), 1.0 / a
    return DrivenLoops(
        turns=True,
        input=phase_of(lines),
        input_error=angle_error(size, doubt),
        origin=toward,
        q0=-h,
        q1=g,
        low=-a,
        high=a,
        upper=g - h - a,
        lower=g + h - a,
        limit_error=4.0 * doubt,
        side=dot(crank, lines),
        half=cross(1j * ground[:, None], lines),
        sign_error=PRODUCT * doubt,
        q_error=4.0 * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )
