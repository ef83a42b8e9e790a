"""Tolerances: sums, shares, clearances as pin forces, random designs."""

from __future__ import annotations

import math

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, MechanismFileError, UnknownNameError
from tests.design.test_force_sensitivity import MACHINE
from tests.library_mechanisms import read_example

DEVIATIONS = {"O2 A": 0.02, "B A": 0.05, "d.offset": 0.03}
SLOPES = {"O2 A": 0.0570816958859256, "B A": 1.1231958120288066, "d.offset": 0.511438004218547}


def test_worst_case_root_sum_square_and_shares_of_a_slider_crank() -> None:
    found = lw.design.tolerance(read_example("slider-crank"), "d", at=60, deviations=DEVIATIONS)
    parts = [abs(SLOPES[n]) * DEVIATIONS[n] for n in DEVIATIONS]
    assert found.worst_case == pytest.approx(sum(parts), rel=1e-12)
    assert found.root_sum_square == pytest.approx(0.0582291796, abs=5e-11)
    shares = {part.name: part.share for part in found.contributions}
    assert list(shares) == ["B A", "d.offset", "O2 A"]
    assert shares["B A"] == pytest.approx(0.930, abs=5e-4)
    assert sum(shares.values()) == pytest.approx(1.0, rel=1e-14)


def test_random_designs_deviate_by_the_root_sum_square_where_it_is_linear() -> None:
    crank = read_example("slider-crank")
    found = lw.design.tolerance(crank, "d", at=60, deviations=DEVIATIONS, samples=20_000, seed=7)
    drawn = found.sampled
    assert drawn is not None
    assert drawn.found == drawn.designs == 20_000
    assert abs(drawn.deviation - found.root_sum_square) < 3.0 * drawn.error
    again = lw.design.tolerance(crank, "d", at=60, deviations=DEVIATIONS, samples=20_000, seed=7)
    other = lw.design.tolerance(crank, "d", at=60, deviations=DEVIATIONS, samples=20_000, seed=8)
    assert again.sampled == drawn
    assert other.sampled != drawn


def test_random_designs_of_a_stroke_and_of_clearances() -> None:
    found = lw.design.tolerance(
        read_example("slider-crank"),
        "stroke(d)",
        deviations={"O2 A": 0.02},
        clearances={"A": 0.05},
        samples=4_000,
    )
    drawn = found.sampled
    assert drawn is not None
    assert abs(drawn.deviation - found.root_sum_square) < 3.0 * drawn.error


def test_a_clearance_acts_as_the_pin_force_of_a_unit_load() -> None:
    """The load is put on the slider, the input is held; the pins' forces come from free bodies."""
    bare = MACHINE[: MACHINE.index("[masses]")] + MACHINE[MACHINE.index("[input]") :]
    unit = lw.loads(f'{bare}[[loads]]\npoint = "B"\nlink = "block"\nforce = [1, 0]\n')
    forces = unit.forces(at=50)
    pins = {"O": 0.03, "A": 0.01, "B": 0.02}
    found = lw.design.tolerance(lw.loads(bare), "d", at=50, deviations={}, clearances=pins)
    for part in found.contributions:
        own = [np.asarray(forces[f"{part.name}.force.{axis}"]) for axis in "xy"]
        assert part.sensitivity == pytest.approx(math.hypot(*own), rel=1e-12)
        assert part.worst == pytest.approx(pins[part.name] * part.sensitivity, rel=1e-15)
        assert part.standard == pytest.approx(part.worst / math.sqrt(2.0), rel=1e-15)
    assert found.worst_case == pytest.approx(sum(p.worst for p in found.contributions))


def test_a_pin_anywhere_in_its_hole_moves_the_output_at_most_by_its_clearance() -> None:
    """A rod that is longer by the play in its direction is the worst place of the pin."""
    crank = read_example("slider-crank")
    found = lw.design.tolerance(crank, "d", at=60, deviations={}, clearances={"A": 1e-4})
    longer = crank.changed(lengths={"O2 A": 40.0, "B A": 120.0001}).solve(at=60)["d"]
    moved = longer - crank.solve(at=60)["d"]
    # the second-order term of a play of 1e-4 is about 1e-10
    assert found.worst_case == pytest.approx(moved, rel=1e-5)


def test_a_file_holds_deviations_and_clearances() -> None:
    text = lw.example_text("slider-crank") + (
        '\n[tolerances]\n"A B" = { deviation = 0.05 }\n"O2 A" = { deviation = "0.02" }\n'
        "[clearances]\nB = 0.02\n"
    )
    mechanism = lw.loads(text)
    found = lw.design.tolerance(mechanism, "d", at=60)
    assert {p.name for p in found.contributions} == {"B A", "O2 A", "B"}
    given = lw.design.tolerance(
        mechanism, "d", at=60, deviations={"B A": 0.05, "O2 A": 0.02}, clearances={"B": 0.02}
    )
    assert found == given


def test_what_is_written_is_read_again(tmp_path: object) -> None:
    crank = read_example("slider-crank").changed(
        tolerances={"B A": 0.05, "O2.x": 0.01}, clearances={"B": 0.02}
    )
    path = f"{tmp_path}/crank.toml"
    crank.save(path)
    again = lw.load(path)
    assert again.description == crank.description


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('[tolerances]\n"A Z" = { deviation = 0.1 }', '"A Z" is not a number of'),
        ('[tolerances]\n"A B" = { deviation = -0.1 }', "must not be negative, got -0.1"),
        ('[tolerances]\n"A B" = { deviation = 1 }\n"B A" = { deviation = 1 }', "the same number"),
        ('[tolerances]\n"A B" = { sigma = 1 }', "deviation"),
        ('[tolerances]\n"A B" = 1', "must be a table"),
        ("[clearances]\nd = 0.1", '"d" is no pin of two links'),
        ("[clearances]\nS = 0.1", "(pins: O2, A, B)"),
        ("[clearances]\nB = -0.1", "must not be negative, got -0.1"),
    ],
)
def test_wrong_tables_are_reported_with_their_lines(table: str, message: str) -> None:
    with pytest.raises(MechanismFileError) as raised:
        lw.loads(f"{lw.example_text('slider-crank')}\n{table}\n")
    assert message in str(raised.value)
    assert all(problem.line for problem in raised.value.problems)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"deviations": {"O2 A": -1.0}}, "must not deviate by a negative number"),
        ({"deviations": {"zz": 1.0}}, '"zz" is not a number'),
        ({"deviations": {}, "clearances": {"d": 1.0}}, "is no pin of two links"),
        ({}, "nothing deviates in"),
        ({"deviations": {"O2 A": 1.0}, "samples": -3}, "samples must be a whole number"),
        ({"deviations": {"O2 A": math.nan}}, "finite"),
    ],
)
def test_wrong_arguments_are_refused(given: dict[str, object], message: str) -> None:
    with pytest.raises((InputError, UnknownNameError), match=message):
        lw.design.tolerance(read_example("slider-crank"), "d", at=60, **given)  # type: ignore[arg-type]


def test_a_dwell_spreads_as_random_designs_do() -> None:
    crank = read_example("slider-crank").changed(inputs=[lw.Input(link="crank", step=5)])
    found = lw.design.tolerance(crank, "dwell(d, 2)", deviations={"O2 A": 0.1}, samples=400)
    assert found.sampled is not None
    assert found.sampled.found == 400
    assert found.sampled.deviation == pytest.approx(
        found.root_sum_square, abs=3.0 * found.sampled.error
    )


def test_a_dead_point_has_a_tolerance_and_a_position_there_has_none() -> None:
    lengths = {"O2 A": 80.0, "A B": 120.0, "O4 B": 80.0, "O2 O4": 100.0}
    bar = read_example("four-bar").changed(lengths=lengths)
    found = lw.design.tolerance(bar, "limit.lower", deviations={"A B": 0.05})
    assert found.root_sum_square == pytest.approx(0.05 * 0.7539571, rel=1e-6)
    lost = lw.design.tolerance(bar, "rocker", at=5, deviations={"A B": 0.05}, samples=10)
    assert lost.status is lw.design.SensitivityStatus.NO_POSITION
    assert lost.sampled is None


def test_results_are_short_in_a_terminal_and_tables_in_a_notebook() -> None:
    crank = read_example("slider-crank")
    slopes = lw.design.sensitivity(crank, "d", at=60, by=["B A"])
    assert repr(slopes).splitlines() == [
        "Sensitivity of d of Offset slider-crank at crank = 60 deg",
        "  B A  1.1232",
    ]
    found = lw.design.tolerance(crank, "d", at=60, deviations=DEVIATIONS)
    assert "  root sum square  0.0582292 mm" in repr(found)
    for result in (slopes, found):
        assert "<table" in result._repr_html_()
        assert "Offset slider-crank" in result._repr_html_()
    assert len(repr(lw.design.sensitivity(crank, "d", at=60, by=["A.x"])).splitlines()) == 1
