"""Velocities and accelerations of a workbook are formulas that come to Linkwork's."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.names import canonical
from tests.oracles.spreadsheet import Spreadsheet
from tests.thinned import thinned
from tests.writers.coarse import coarse

_NEAR = 1e-9  # relative, of the largest value: both sides divide by the same Jacobian


def written(tmp_path: Path, mechanism: Any, motion: Any) -> Spreadsheet:
    path = tmp_path / "cycle.xlsx"
    mechanism.write(path, motion=motion)
    return Spreadsheet(path)


def named_column(sheet: Spreadsheet, name: str, rows: int) -> np.ndarray[Any, Any]:
    place, cell = sheet.names[name].replace("$", "").split("!")
    return np.array([sheet[place, f"{cell[:-1]}{7 + row}"] for row in range(rows)], dtype=float)


def check_rates(sheet: Spreadsheet, mechanism: Any, motion: Any, speed: float) -> None:
    """The rates of unknowns, outputs and moving points are Linkwork's."""
    shown = {v.name: v.shown for v in mechanism.model.equations.variables}
    series = {**motion.unknowns, **motion.outputs}
    for point, (x, y) in motion.points.items():
        series |= {f"{point}.x": x, f"{point}.y": y}
    checked = 0
    for name, own in series.items():
        for word, values in (
            ("velocity", own.first * speed), ("acceleration", own.second * speed**2),
        ):  # fmt: skip
            cell = canonical(f"{shown.get(name, name)}.{word}").casefold()
            if cell not in sheet.names:
                assert np.abs(values).max() == 0.0, name  # a point at rest
                continue
            found = named_column(sheet, cell, len(values))
            size = max(np.abs(values).max(), 1.0)
            np.testing.assert_allclose(found, values, rtol=0, atol=_NEAR * size, err_msg=name)
            checked += 1
    assert checked >= 2 * len(motion.unknowns)


@pytest.mark.parametrize(
    "name",
    thinned(
        ["slider-crank", "planetary-differential", "rapier-drive", "inverted-slider-crank",
         "belt-drive", "boxer-engine", "cam-swinging-follower", "double-butterfly", "excavator",
         "rack-and-pinion"], 2
    ),
)  # fmt: skip
def test_rates_are_linkworks(name: str, tmp_path: Path) -> None:
    mechanism = coarse(lw.example(name), 3)
    motion = mechanism.sweep(certify=False)
    speed = 1.0 if motion.speed is None else motion.speed
    check_rates(written(tmp_path, mechanism, motion), mechanism, motion, speed)


def test_rates_follow_a_changed_dimension_and_speed(tmp_path: Path) -> None:
    mechanism = lw.example("rapier-drive")
    sheet = written(tmp_path, mechanism, mechanism.sweep(step=120, certify=False))
    sheet.set("a2_", 240)
    sheet.set("theta12.velocity", 31.5)
    changed = mechanism.with_dimensions(a2=240).sweep(step=120, certify=False)
    check_rates(sheet, mechanism, changed, 31.5)


def test_the_speed_of_the_file_is_in_its_cell(tmp_path: Path) -> None:
    mechanism = lw.example("four-bar")
    sheet = written(tmp_path, mechanism, mechanism.sweep(step=90))
    _, cell = sheet.names["theta_crank.velocity"].replace("$", "").split("!")
    assert sheet["Dimensions", cell] == 25.0
    assert sheet["Dimensions", f"C{cell[1:]}"] == "rad/s"


def test_rates_of_equations_with_functions_are_their_derivatives(tmp_path: Path) -> None:
    mechanism = lw.loads(
        'format = 1\nname = "functions"\n[equations]\n'
        'F = "x*exp(x) + atan2(x, 3) - u = 0"\nG = "y^3 + hypot(x, y) - ln(u + 2) = 0"\n'
        '[guess]\nx = 1\ny = 1\nu = 2\n[input]\nvariable = "u"\nfrom = 1\nto = 4\nstep = 1\n'
    )
    motion = mechanism.sweep()
    check_rates(written(tmp_path, mechanism, motion), mechanism, motion, 1.0)


def test_a_row_without_a_position_has_no_rates(tmp_path: Path) -> None:
    mechanism = lw.example("rapier-drive-limited")
    motion = mechanism.sweep(from_=60, to=150, step=30, certify=False)
    sheet = written(tmp_path, mechanism, motion)
    place, cell = sheet.names["s16.velocity"].replace("$", "").split("!")
    for row, there in enumerate(motion.found[motion.asked]):
        assert isinstance(sheet[place, f"{cell[:-1]}{7 + row}"], float) == there


def test_formulas_of_rates_read_like_the_book(tmp_path: Path) -> None:
    mechanism = lw.example("rapier-drive")
    book = written(tmp_path, mechanism, mechanism.sweep(step=90)).book
    assert book["Velocities"]["C7"].value == "=-a2_*SIN(RADIANS(theta12))*theta12.velocity"
    assert book["Velocities"]["M7"].value == (
        "=-a2_*SIN(RADIANS(theta12))*theta12.velocity-a3_*SIN(RADIANS(theta13))*theta13.velocity"
    )
