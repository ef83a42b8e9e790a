"""How nearly two motions of the same mechanism, changed, have to agree."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

import linkwork as lw
from linkwork.core.results.quantity import Kind
from linkwork.core.results.tables import Series

__all__ = ["CLOSE", "agree", "angles_of", "internal", "series_of"]

Array = npt.NDArray[np.float64]
# Residuals stay below 1e-14 of the longest link; the largest condition number on these
# cycles is a few hundred (twenty in the library away from dead points).
CLOSE = 1e-11


def series_of(motion: lw.Motion) -> Iterator[Series]:
    for table in (motion.unknowns, motion.links, motion.sliders, motion.outputs):
        yield from table.values()
    for pair in motion.points.values():
        yield from pair


def internal(motion: lw.Motion, series: Series) -> Array:
    """Values with angles in radians."""
    return series.value * motion.units.scale(series.quantity.kind)


def agree(one: lw.Motion, other: lw.Motion, sign: float, turn: float, factor: float) -> None:
    """``other`` is the mirrored (sign -1), turned and scaled ``one``."""
    np.testing.assert_array_equal(one.found, other.found)
    assert one.status == other.status
    found = one.found
    size = max(1.0, *(float(np.abs(t[found]).max()) for t in traces(one)))
    for point in one.points:
        z = one.trace(point)[found]
        wanted = factor * (z if sign > 0 else z.conj()) * np.exp(1j * turn)
        np.testing.assert_allclose(
            other.trace(point)[found], wanted, rtol=0, atol=CLOSE * factor * size
        )
    unit = one.units.scale(Kind.ANGLE)
    for link in one.links:
        before, after = (np.exp(1j * unit * m.links[link].value[found]) for m in (one, other))
        wanted = (before if sign > 0 else before.conj()) * np.exp(1j * turn)
        np.testing.assert_allclose(after, wanted, rtol=0, atol=CLOSE)
    for slider in one.sliders:
        before, after = (m.sliders[slider].value[found] for m in (one, other))
        np.testing.assert_allclose(after, factor * before, rtol=0, atol=CLOSE * factor * size)


def traces(motion: lw.Motion) -> list[npt.NDArray[np.complex128]]:
    return [motion.trace(p) for p in motion.points] or [np.ones(len(motion), dtype=complex)]


def angles_of(motion: lw.Motion) -> dict[str, Array]:
    """Unknown angles [rad] in rows that were found."""
    scale = motion.units.scale(Kind.ANGLE)
    return {
        name: series.value[motion.found] * scale
        for name, series in motion.unknowns.items()
        if series.quantity.kind is Kind.ANGLE
    }
