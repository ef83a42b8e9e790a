"""Selection of links to release in overconstrained linkages.

In an overconstrained linkage that can move (parallel cranks, Dixon's mechanisms), some conditions
follow from the others. Releasing the length of a link removes one condition; this has an effect
only if the link carries force in a self-stress, a left null vector of the Jacobian of all joint
conditions.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence

import numpy as np

from linkwork.equations.frames import Frames
from linkwork.equations.model import LawEquation, LinearEquation
from linkwork.foundation.arrays import Array
from linkwork.foundation.elementwise import plain_value
from linkwork.foundation.names import GROUND, canonical
from linkwork.foundation.rounding import RANK_TOLERANCE

__all__ = ["Bar", "released_links"]

#: A link and its two joint points.
Bar = tuple[str, str, str]

_STRESSED = 1e-6  # relative to the largest: smaller forces count as zero
_ALIKE = 0.5  # relative to the largest: among such links the last in the file is released


def released_links(
    frames: Frames,
    incidences: Sequence[tuple[str, str]],
    relations: Sequence[LinearEquation | LawEquation],
    unknown: set[str],
    count: int,
) -> tuple[Bar, ...]:
    """The links with two joints whose lengths are released, at most ``count``.

    Parameters
    ----------
    incidences : sequence of (body, point)
        All pairs of a body and a point on it that another body uses.
    unknown : set of str
        Symbols of the unknowns; inputs are not among them.
    """
    joined = {point for _, point in incidences}
    bars = []
    for link, points in frames.linkage.links.items():
        joints = [point for point in points if point in joined]
        own = link != GROUND and len(joints) == 2 and frames.angle[link].variable == link
        slides = any(place.sliding for place in frames.places[link].values())
        if own and canonical(link) in unknown and not slides:
            bars.append((link, joints[0], joints[1]))
    stress = _stresses(frames, incidences, relations, unknown, bars)
    if not stress.size:
        return ()
    found: list[Bar] = []
    largest = float(np.linalg.norm(stress, axis=0).max())
    for _ in range(count):
        size = np.linalg.norm(stress, axis=0)
        if size.max() <= _STRESSED * largest:
            break
        # among links with similar force, the last in the file is the redundant one; of equal bars
        # some carry exactly half the force of others, whichever way the forces are rounded
        chosen = int(np.flatnonzero(size >= (_ALIKE - _STRESSED) * size.max())[-1])
        found.append(bars[chosen])
        direction = stress[:, chosen] / size[chosen]
        # the remaining self-stresses do not load the released link
        stress = stress - np.outer(direction, direction @ stress)
    return tuple(found)


def _stresses(
    frames: Frames,
    incidences: Sequence[tuple[str, str]],
    relations: Sequence[LinearEquation | LawEquation],
    unknown: set[str],
    bars: Sequence[Bar],
) -> Array:
    """The force of every self-stress in each bar, (stresses, bars)."""
    ends = {(link, end): k for k, (link, _, end) in enumerate(bars)}
    columns: dict[str, int] = {}
    entries: list[tuple[int, str, complex]] = []
    elongations = np.zeros((2 * len(incidences) + len(relations), len(bars)))
    scale = max((abs(z) for places in _fixed(frames) for z in places), default=1.0) or 1.0
    for k, (body, point) in enumerate(incidences):
        entries += [(k, f"point {point} x", 1.0), (k, f"point {point} y", 1j)]
        if body != GROUND:
            entries += [(k, f"body {body} x", -1.0), (k, f"body {body} y", -1j)]
        for name, slope in _slopes(frames, body, point, scale).items():
            if name in unknown:
                entries.append((k, name, -slope))
        if (body, point) in ends:
            bar = ends[body, point]
            first = plain_value(frames.places[body][bars[bar][1]].fixed)
            along = plain_value(frames.places[body][point].fixed) - first
            angle = frames.angle[body]
            turned = plain_value(angle.constant + frames.now(angle))
            along *= cmath.exp(1j * turned) / abs(along)
            elongations[k, bar] = along.real
            elongations[len(incidences) + k, bar] = along.imag
    for _, name, _ in entries:
        columns.setdefault(name, len(columns))
    for equation in relations:
        for name in _gradient(frames, equation):
            if name in unknown:
                columns.setdefault(name, len(columns))
    matrix = np.zeros((len(elongations), len(columns)))
    for k, name, value in entries:
        matrix[k, columns[name]] += complex(value).real
        matrix[len(incidences) + k, columns[name]] += complex(value).imag
    for row, equation in enumerate(relations, 2 * len(incidences)):
        for name, value in _gradient(frames, equation).items():
            if name in unknown:
                matrix[row, columns[name]] += value
    u, sizes, _ = np.linalg.svd(matrix)
    rank = int((sizes > RANK_TOLERANCE * sizes[0]).sum()) if len(sizes) else 0
    stress: Array = u[:, rank:].T @ elongations
    return stress


def _fixed(frames: Frames) -> list[list[complex]]:
    return [
        [plain_value(place.fixed) for place in places.values()] for places in frames.places.values()
    ]


def _slopes(frames: Frames, body: str, point: str, scale: float) -> dict[str, complex]:
    """Derivatives of a point's position in a body, lengths relative to ``scale``."""
    place, angle = frames.places[body][point], frames.angle[body]
    found: dict[str, complex] = {}

    def add(name: str, value: complex) -> None:
        found[name] = found.get(name, 0j) + value

    values = {canonical(name): plain_value(value) for name, value in frames.start.items()}
    turned = plain_value(angle.constant + frames.now(angle))
    fixed = plain_value(place.fixed) / scale * cmath.exp(1j * turned)
    if angle.variable is not None:
        add(canonical(angle.variable), 1j * fixed)
    for term in place.sliding:
        direction = plain_value(term.value) * cmath.exp(
            1j * sum(w * values[n] for n, w in term.phase)
        )
        length = 1.0 / scale if term.length is None else values[term.length] / scale
        for name, weight in term.phase:
            add(name, 1j * weight * direction * length)
        if term.length is not None:
            add(term.length, direction)
    return found


def _gradient(frames: Frames, equation: LinearEquation | LawEquation) -> Mapping[str, float]:
    """Derivatives of a relation by its variables."""
    found = dict(equation.terms)
    if isinstance(equation, LawEquation):
        values = {canonical(name): plain_value(value) for name, value in frames.start.items()}
        argument = sum(w * values[n] for n, w in equation.inner) + equation.offset
        slope = float(equation.law.jet(np.array([argument]))[1][0])
        for name, weight in equation.inner:
            found[name] = found.get(name, 0.0) - slope * weight
    return found
