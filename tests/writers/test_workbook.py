"""Workbooks solve their mechanism themselves: an independent spreadsheet calculates their cells."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest
from xlsxwriter.worksheet import Worksheet

import linkwork as lw
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.values import value
from linkwork.core.foundation.errors import InputError, MissingPackageError
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.mechanism.linkage import Linkage
from linkwork.writers.formulas.closure_formulas import cell_text, of_radians, value_of
from linkwork.writers.workbook import workbook
from linkwork.writers.workbook.book import CellNames, FastCells
from tests.described import described_as
from tests.oracles.spreadsheet import Spreadsheet, calculated
from tests.thinned import thinned
from tests.writers.coarse import coarse

_NEAR = 1e-9  # mm and degrees: both sides iterate until nothing but rounding is left
_ROUNDING = 1e-13  # of a formula with ten operations at most, some digits for differences


def written(tmp_path: Path, mechanism: Any, motion: Any) -> Spreadsheet:
    path = tmp_path / "cycle.xlsx"
    mechanism.write(path, motion=motion)
    return Spreadsheet(path)


def check_rows(sheet: Spreadsheet, motion: Any) -> None:
    """Unknowns, points and outputs of every row are Linkwork's."""
    asked = motion.asked
    names = [*motion.inputs, *motion.unknowns, *motion.outputs]
    names += [f"{point}.{axis}" for point in motion.points for axis in "xy"]
    for name in names:
        found = np.array(sheet.column("Cycle", name), dtype=float)
        np.testing.assert_allclose(found, motion[name][asked], rtol=0, atol=_NEAR, err_msg=name)
    assert set(sheet.column("Cycle", "closes")) == {"yes"}


@pytest.mark.parametrize(
    "name",
    thinned(
        ["rapier-drive", "four-bar", "jansen-leg", "slider-crank", "rack-and-pinion", "scotch-yoke",
         "excavator", "double-four-bar", "double-butterfly", "scissor-lift"], 2
    ),
)  # fmt: skip
def test_cells_come_to_linkworks_positions(name: str, tmp_path: Path) -> None:
    mechanism = coarse(lw.example(name), 6)
    motion = mechanism.sweep(certify=False)
    check_rows(written(tmp_path, mechanism, motion), motion)


@pytest.mark.parametrize(
    ("name", "cell", "value", "change"),
    [
        ("rapier-drive", "a2_", 240.0, {"dimensions": {"a2": 240}}),
        ("double-four-bar", "beta", 26.0, {"dimensions": {"beta": 26}}),
        ("four-bar", "O2A", 37.0, {"lengths": {"O2 A": 37}}),
        ("slider-crank", "S_y", -24.0, {"points": {"S": (0, -24)}}),
        ("slider-crank", "d_offset", 3.0, {"sliders": 3.0}),
        ("scotch-yoke", "T_y", 12.0, {"points": {"T": (150, 12)}}),
        ("jansen-leg", "BD", 57.0, {"lengths": {"B D": 57}}),
        ("planetary-gear", "OA", 50.0, {"lengths": {"O A": 50}}),
    ],
)
def test_a_changed_dimension_is_solved_by_the_cells(
    name: str, cell: str, value: float, change: dict[str, Any], tmp_path: Path
) -> None:
    mechanism = lw.example(name)
    sheet = written(tmp_path, mechanism, mechanism.sweep(step=30, certify=False))
    sheet.set(cell, value)
    description = mechanism.description
    parts: dict[str, Any] = {}
    for table, new in change.items():
        old = getattr(description, table)
        if table == "sliders":
            parts[table] = [lw.Slider(**{**vars(part), "offset": new}) for part in old]
        else:
            parts[table] = {**old, **new}
    check_rows(sheet, mechanism.changed(**parts).sweep(step=30, certify=False))


@pytest.mark.parametrize(
    ("wanted", "name"),
    [("a2", "a2_"), ("θ12", "theta12"), ("C1C2", "C1C2_"), ("R", "R_"), ("O2A", "O2A"),
     ("r3'", "r3_prime"), ("true", "true_"), ("B.x", "B.x"), ("3rd", "_3rd")],
)  # fmt: skip
def test_a_name_is_none_that_a_spreadsheet_reads_otherwise(wanted: str, name: str) -> None:
    assert CellNames().claim("key", wanted) == name


@pytest.mark.parametrize(
    "formula",
    ["-a^2", "-a^2*b", "(-a)^2", "a^b^c", "(a^b)^c", "a - (b - c)", "a/(b*c)", "a/b*c",
     "-(a + b)^2/c",
     "atan2(a, b) + hypot(b, c)", "2*sin(a) - cos(b)*tan(c)", "-sqrt(a)*ln(b)/log10(c)",
     "max(a, b, c)^min(a, b)", "asin(a/c) + acos(a/c) + atan(b)", "exp(-a) + abs(b - c)",
     "pi - e^a"],
)  # fmt: skip
@pytest.mark.parametrize("unit", list(AngleUnit))
def test_a_cell_formula_means_what_the_files_formula_means(formula: str, unit: AngleUnit) -> None:
    numbers = {"a": 1.3, "b": 2.1, "c": 1.7}
    tree = parse(formula)
    in_radians = of_radians(tree, unit)
    text = cell_text(in_radians, {name: str(number) for name, number in numbers.items()})
    assert calculated(text) == pytest.approx(value(tree, numbers, unit), rel=_ROUNDING)
    assert value_of(in_radians, numbers) == pytest.approx(value(tree, numbers, unit), rel=_ROUNDING)


def test_names_differ_without_regard_to_capitals() -> None:
    names = CellNames()
    assert [names.claim(str(k), wanted) for k, wanted in enumerate(["a2", "A2", "ab", "AB"])] == [
        "a2_", "A2_2", "ab", "AB_2",
    ]  # fmt: skip


def test_formulas_read_like_the_book(tmp_path: Path) -> None:
    mechanism = lw.example("rapier-drive")
    book = written(tmp_path, mechanism, mechanism.sweep(step=90)).book
    assert book["Cycle"]["G7"].value == (
        "=a2_*COS(RADIANS(theta12))+a3_*COS(RADIANS(theta13))+d1_"
        "-a5_*COS(RADIANS(theta15))-a4_*COS(RADIANS(theta14))"
    )
    assert book["Cycle"]["B8"].value == "=theta12_from+theta12_step*($A8-1)"
    assert book.defined_names["theta13_0"].attr_text == "Newton!$B1"


def test_a_derived_dimension_is_a_formula_of_the_others(tmp_path: Path) -> None:
    mechanism = lw.linkage(
        dimensions={"a": 40, "b": "3*a"},
        points={"O": (0, 0), "A": (35, 20), "B": (146, 66), "C": (100, 0)},
        links={"ground": ["O", "C"], "crank": ["O", "A"], "rod": ["A", "B"], "rocker": ["C", "B"]},
        lengths={"O A": "a", "A B": "b", "C B": "2*a"},
        inputs=[lw.Input(link="crank", step=45)],
    )
    sheet = written(tmp_path, mechanism, mechanism.sweep(certify=False))
    sheet.set("a", 39.0)
    check_rows(sheet, mechanism.with_dimensions(a=39).sweep(certify=False))


@pytest.mark.parametrize(
    ("name", "asked"),
    [("jansen-leg", {"step": 60}), ("parallel-cranks", {"from_": 161, "to": 175, "step": 7})],
)
def test_cells_contain_the_values_of_their_formulas(
    name: str, asked: dict[str, Any], tmp_path: Path
) -> None:
    mechanism = lw.example(name)
    sheet = written(tmp_path, mechanism, mechanism.sweep(**asked, certify=False))
    plain = openpyxl.load_workbook(tmp_path / "cycle.xlsx", data_only=True)
    for page in sheet.book.sheetnames:
        for row in sheet.book[page].iter_rows():
            for cell in row:
                found = sheet[page, cell.coordinate]
                if isinstance(found, int | float):
                    shown = plain[page][cell.coordinate].value
                    assert shown == pytest.approx(found, rel=_NEAR, abs=_NEAR), cell.coordinate


def test_an_even_table_with_endless_digits_has_a_first_value_and_a_step(tmp_path: Path) -> None:
    mechanism = lw.example("four-bar")
    motion = mechanism.sweep(from_=0, to=400, step=400 / 3, certify=False)
    sheet = written(tmp_path, mechanism, motion)
    assert sheet.book["Cycle"]["B8"].value == "=theta_crank_from+theta_crank_step*($A8-1)"
    assert sheet["Cycle", "B10"] == pytest.approx(400, rel=1e-13)
    assert set(sheet.column("Cycle", "as solved")) == {"yes"}


def test_cells_are_those_that_xlsxwriter_writes_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its private methods are overridden; other versions may not call them."""
    names = {name for name in vars(FastCells) if callable(getattr(FastCells, name))} - {"follow"}
    assert names == {"_prepare_formula", "_write_cell"} <= set(vars(Worksheet))
    mechanism = lw.example("rapier-drive-limited")
    motion = mechanism.sweep(from_=60, to=180, step=60, certify=False)
    fast = cells_of(written(tmp_path, mechanism, motion), tmp_path)
    assert len(fast) > 500
    monkeypatch.setattr(workbook, "FastCells", type("Slow", (), {"follow": FastCells.follow}))
    assert cells_of(written(tmp_path, mechanism, motion), tmp_path) == fast


def cells_of(sheet: Spreadsheet, folder: Path) -> dict[tuple[str, str], Any]:
    """Formula, value, type and style of every cell."""
    plain = openpyxl.load_workbook(folder / "cycle.xlsx", data_only=True)
    found = {}
    for page in sheet.book:
        for cell in (cell for row in page.iter_rows() for cell in row):
            value = plain[page.title][cell.coordinate].value
            if isinstance(value, float):
                value = float(f"{value:.16G}")  # as XlsxWriter writes numbers
            found[page.title, cell.coordinate] = (
                cell.value if cell.data_type == "f" else None, value, cell.data_type, cell.style_id,
            )  # fmt: skip
    return found


def test_rows_beyond_a_dead_point_say_so_and_the_next_starts_anew(tmp_path: Path) -> None:
    mechanism = lw.example("rapier-drive-limited")
    motion = mechanism.sweep(step=12, certify=False)
    sheet = written(tmp_path, mechanism, motion)
    found = motion.found[motion.asked]
    said = sheet.column("Cycle", "status")
    values = sheet.column("Cycle", "s16")
    assert 0 < found.sum() < len(found)
    for there, text, shown in zip(found, said, values, strict=True):
        assert text == (
            "converged (proofs were switched off)" if there
            else "no position: this branch does not reach the input value (OUT_OF_REACH)"
        )  # fmt: skip
        assert isinstance(shown, float) == there
    first = int(np.flatnonzero(~found)[-1]) + 1
    told = mechanism.write(tmp_path / "again.xlsx", motion=motion)
    assert told[:2] == (
        f"rows without a position, with Linkwork's reason in their status: {int((~found).sum())}",
        "rows that start from separate estimates, yellow cells of Newton: 1",
    )
    assert isinstance(sheet.book["Newton"].cell(7 + first, 2).value, float)
    assert str(sheet.book["Newton"].cell(8 + first, 2).value).startswith("=")
    own = motion["s16"][motion.asked]
    near = [abs(v - o) for v, o, there in zip(values, own, found, strict=True) if there]
    assert max(near) < _NEAR


def test_limits_and_further_branches_stand_with_linkworks_values_only(tmp_path: Path) -> None:
    mechanism = lw.example("rapier-drive-limited")
    motion = mechanism.sweep(step=10, through=True, certify=False)
    sheet = written(tmp_path, mechanism, motion)
    assert sheet.book["Cycle"].max_row - 6 == motion.asked.sum() < len(motion)
    assert sheet.book["Linkwork"].max_row - 6 == len(motion)


def test_a_cams_law_is_told_to_be_values_only(tmp_path: Path) -> None:
    mechanism = lw.example("cam-roller-follower")
    told = mechanism.write(tmp_path / "cam.xlsx", motion=mechanism.sweep(step=30, certify=False))
    assert told[0] == (
        's: "rise" is a motion law or a curve, given piece by piece; '
        "the column contains Linkwork's values"
    )
    about = openpyxl.load_workbook(tmp_path / "cam.xlsx")["About"]
    assert told[0] in [row[1].value for row in about.iter_rows()]


def test_a_side_across_an_angle_has_a_formula(tmp_path: Path) -> None:
    mechanism = lw.example("watt-linkage")
    motion = mechanism.sweep(step=6, certify=False)
    sheet = written(tmp_path, mechanism, motion)
    check_rows(sheet, motion)
    assert mechanism.write(tmp_path / "again.xlsx", motion=motion) == ()


def _with_four_points(lengths: dict[str, float], angles: dict[str, float]) -> lw.Mechanism:
    """A four-bar whose coupler carries C and D."""
    bar = described_as(Linkage, lw.example("four-bar"))
    return lw.Mechanism(
        replace(
            bar,
            points={**bar.points, "C": (50, 70), "D": (140, 110)},
            links={**bar.links, "coupler": ("A", "B", "C", "D")},
            lengths={**bar.lengths, **lengths},
            angles=angles,
        )
    )


def test_a_shape_that_can_be_placed_from_some_length_has_formulas(tmp_path: Path) -> None:
    """From A and B no other point can be placed, from A and C all can."""
    mechanism = _with_four_points({"A C": 50, "B D": 50, "C D": 100}, {"A C D": 100})
    motion = mechanism.sweep(step=30, certify=False)
    check_rows(written(tmp_path, mechanism, motion), motion)
    assert mechanism.write(tmp_path / "again.xlsx", motion=motion) == ()


@pytest.mark.parametrize(
    ("lengths", "angles"),
    [
        # no length leads to a point by an angle and a length, or by two lengths
        ({"C D": 98}, {"B A C": 50, "A B D": -105, "A C D": 131}),
        # nearest to the sketch: two dimensions are missing, four distances are open
        ({"A C": 50, "C D": 98}, {}),
    ],
)
def test_a_shape_without_a_formula_keeps_its_numbers(
    tmp_path: Path, lengths: dict[str, float], angles: dict[str, float]
) -> None:
    mechanism = _with_four_points(lengths, angles)
    motion = mechanism.sweep(step=30, certify=False)
    sheet = written(tmp_path, mechanism, motion)
    check_rows(sheet, motion)
    (told,) = mechanism.write(tmp_path / "again.xlsx", motion=motion)
    assert told.endswith(
        f"{', '.join([*lengths, *angles])}: no formula connects these with the equations; "
        "they keep the values of the file"
    )


def test_another_mechanisms_motion_is_refused(tmp_path: Path) -> None:
    motion = lw.example("slider-crank").sweep(step=90, certify=False)
    with pytest.raises(
        InputError, match='belongs to "Offset slider-crank", not to "Four-bar linkage'
    ):
        lw.example("four-bar").write(tmp_path / "x.xlsx", motion=motion)


def test_another_kind_of_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a workbook needs the suffix \.xlsx"):
        lw.example("four-bar").write(tmp_path / "x.xls", kind="workbook")


def test_without_xlsxwriter_the_install_command_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    bar = lw.example("four-bar")
    with pytest.raises(MissingPackageError, match=r'pip install "linkwork\[tables\]"'):
        bar.write(tmp_path / "x.xlsx", motion=bar.sweep(step=90, certify=False))
