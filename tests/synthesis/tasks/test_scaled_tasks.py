"""Tasks enlarged by a factor: the same designs, enlarged, in the same order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.synthesis.defects.verdicts import JudgedDesign

_PAIRS = [(0, 0), (20, 10), (45, 22), (60, 28), (80, 30)]
_DENSE = [(10 * k, 40 * np.cos(np.radians(30 + 10 * k)) + 3 * k) for k in range(12)]
_LOG = {"x": (1, 2), "input": (45, 105)}
_POSES = [(0, 0, 0), (40, -40, 10), (100, -80, 25), (170, -110, 45), (260, -140, 75)]
_PIVOTS = [(0, 0), (200, -50)]
_TURN = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
_CURVE = np.column_stack(
    [100 * np.cos(_TURN) + 30 * np.cos(2 * _TURN), 60 * np.sin(_TURN) + 10 * np.sin(2 * _TURN)]
)


def _slider(pairs: Sequence[tuple[float, float]], size: float, **tables: Any) -> lw.Task:
    scaled = [(x, size * y) for x, y in pairs]
    return lw.Task.function(scaled, mechanism="slider-crank", **tables)


def _scale(size: float, **tables: Any) -> lw.Task:
    return lw.Task.function("log10(x)", **_LOG, **tables)


def _poses(size: float, count: int, **tables: Any) -> lw.Task:
    poses = [(size * x, size * y, angle) for x, y, angle in _POSES[:count]]
    return lw.Task.motion(poses, **tables)


def _bounds(size: float) -> dict[str, Any]:
    return {"transmission": {"least": 40}, "lengths": {"least": 10 * size, "most": 300 * size}}


_TASKS: dict[str, Callable[[float], lw.Task]] = {
    "slider through three pairs": lambda s: _slider(_PAIRS[:3], s, rank={"deliver": 600}),
    "slider from a start": lambda s: _slider(
        _PAIRS[:3], s, input=(30, 75), output=(50 * s, 72 * s)
    ),
    "slider through five pairs": lambda s: _slider(_PAIRS, s),
    "slider at Chebyshev points": lambda s: _scale(s, output=(0, 90 * s), mechanism="slider-crank"),
    "slider by least squares": lambda s: _slider(_DENSE, s, fit="least squares"),
    "slider with bounds": lambda s: _slider(_DENSE, s, fit="minimax", wanted=_bounds(s)),
    "four-bar on a ground": lambda s: lw.Task.function(
        _PAIRS[:4], mechanism="four-bar", given={"fixed_pivots": [[10 * s, 0], [100 * s, 0]]}
    ),
    "five poses": lambda s: _poses(s, 5, wanted={"clear_of": [[140 * s, 40 * s, 30 * s]]}),
    "three poses": lambda s: _poses(s, 3, given={"fixed_pivots": [[0, -200 * s]]}),
    "points": lambda s: lw.Task.path(
        (s * np.array([(250, 0), (300, 60), (380, 100)])).tolist(),
        given={"fixed_pivots": (s * np.array(_PIVOTS)).tolist()},
    ),
    "points with a length": lambda s: lw.Task.path(
        (s * np.array([(250, 0), (300, 60), (380, 100)])).tolist(),
        given={"fixed_pivots": (s * np.array(_PIVOTS)).tolist(), "lengths": {"A0 A": 80 * s}},
    ),
    "a curve": lambda s: lw.Task.path((s * _CURVE).tolist(), improve={"starts": 40}),
}


@pytest.mark.parametrize("name", _TASKS)
def test_a_task_enlarged_by_a_factor_has_its_designs_enlarged(name: str) -> None:
    """By powers of two numbers are scaled without rounding."""
    plain = _TASKS[name](1.0).solve()
    assert plain.sound
    for size in (2.0**17, 2.0**-17):
        found = _TASKS[name](size).solve()
        counts = [(own.complex, own.real, own.proved, own.linkages) for own in (plain, found)]
        assert counts[0] == counts[1]
        assert found.completeness is plain.completeness
        for own, other in zip(plain.designs, found.designs, strict=True):
            assert other.kinds == own.kinds
            assert other.score == pytest.approx(own.score, rel=1e-6)
            assert _numbers(other, size) == pytest.approx(_numbers(own, 1.0), rel=1e-4, nan_ok=True)


def _numbers(design: JudgedDesign, size: float) -> list[float]:
    return [design.size / size, design.shortest / size, design.transmission]
