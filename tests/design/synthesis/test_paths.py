"""Points: the solutions of the nine-point problem, their defects, and what is delivered."""

from __future__ import annotations

import time

import pytest

import linkwork as lw

_PROBLEM_3 = [
    (0.25, 0.0), (0.52, 0.10), (0.80, 0.70), (1.20, 1.00), (1.40, 1.30), (1.10, 1.48),
    (0.70, 1.40), (0.20, 1.00), (0.02, 0.40),
]  # fmt: skip
_ON_A_LINE = [(0.50, 1.06), (-0.83, -0.27), (-0.34, 0.22), (-0.13, 0.43), (0.22, 0.78)]


@pytest.mark.extended
def test_of_problem_3_of_wampler_morgan_and_sommese_one_curve_is_viable() -> None:
    """TOMS 921: 1442 triples, 64 of them real, one of these without defects."""
    found = lw.Task.path(_PROBLEM_3).solve()
    assert (found.complex, found.real, found.proved, found.triples) == (1442, 64, 64, 64)
    assert (found.linkages, len(found.designs), len(found.delivered)) == (192, 384, 2)
    pivots = [
        {complex(round(z.real, 6), round(z.imag, 6)) for z in (p["A0"], p["B0"])}
        for p in (design.design.points for design in found.delivered)
    ]
    # both four-bars share a fixed pivot: they are cognates
    expected = (1.216697 + 0.88585j, 1.341129 + 0.08454j, 0.704459 + 0.413897j)
    assert sorted(map(str, pivots)) == sorted(
        map(str, ({expected[0], expected[1]}, {expected[2], expected[1]}))
    )


def test_five_points_with_given_pivots_are_solved_and_judged() -> None:
    found = lw.Task.path(_ON_A_LINE, given={"fixed_pivots": [(0, 0), (1, 0)]}).solve()
    assert found.real == found.proved == 15
    assert len(found.designs) == 30
    assert sum(found.defects.values()) >= len(found.refused) == 30 - found.sound
    for design in found.designs[:4]:
        assert {design.design.points["A0"], design.design.points["B0"]} == {0j, 1 + 0j}


def test_a_delivered_design_passes_its_points_in_order() -> None:
    bar = lw.example("four-bar")
    inputs = (20, 60, 100, 140, 180)
    points = [
        [0.5 * sum(pair) for pair in zip(*(bar.solve(at=a).points[p] for p in "AB"), strict=True)]
        for a in inputs
    ]
    found = lw.Task.path(points, given={"fixed_pivots": [(0, 0), (100, 0)]}).solve()
    assert found.delivered
    design = next(d for d in found.delivered if abs(d.design.points["A"]) < 40.001)
    mechanism = lw.api.Mechanism(design.linkage)
    for value, point in zip(design.design.inputs, points, strict=True):
        place = mechanism.solve(at=value * 57.29577951308232).points["P"]
        assert place == pytest.approx(point, abs=1e-6)


@pytest.mark.extended
def test_equally_spaced_points_on_a_line_are_solved_in_seconds() -> None:
    """A third of the paths of each sample creep to infinity; the compiled tracker follows them."""
    begun = time.process_time()
    found = lw.Task.path([(10.0 * k, 0.0) for k in range(6)]).solve()
    # 4 s of processor time, and once after an installation the kernel is compiled for 20 s; 88 s
    # when NumPy followed them all
    assert time.process_time() - begun < 50.0
    assert found.real == found.proved == 191
    assert found.designs
