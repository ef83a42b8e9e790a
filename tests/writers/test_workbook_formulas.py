"""Formulas of a workbook use the file format's own functions and keep to its limits."""

from __future__ import annotations

import re
from pathlib import Path

import openpyxl
import pytest
from openpyxl.utils import FORMULAE

import linkwork as lw
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.values import FUNCTIONS
from linkwork.core.foundation.units import AngleUnit
from linkwork.writers.formulas.closure_formulas import cell_text, of_radians
from tests.oracles.spreadsheet_functions import ARGUMENTS, calls
from tests.thinned import thinned
from tests.writers.coarse import coarse

_LONGEST_FORMULA, _LONGEST_TEXT, _DEEPEST, _MOST_ARGUMENTS = 8192, 255, 64, 255
_TWO = ("atan2", "hypot", "min", "max")


def check_formula(formula: str) -> None:
    assert len(formula) <= _LONGEST_FORMULA
    assert "_xlfn." not in formula
    assert all(len(text) <= _LONGEST_TEXT + 2 for text in re.findall(r'"[^"]*"', formula))
    for name, count, depth in calls(formula):
        assert name in ARGUMENTS, formula
        least, most = ARGUMENTS[name]
        assert least <= count <= (_MOST_ARGUMENTS if most is None else most), formula
        assert depth <= _DEEPEST, formula


def formulas_of(path: Path) -> set[str]:
    """All formulas, those that differ in rows only once."""
    book = openpyxl.load_workbook(path)
    found = {}
    for sheet in book:
        for row in sheet.iter_rows():
            for cell in row:
                if isinstance(cell.value, str) and cell.data_type == "f":
                    found[re.sub(r"\d+", "#", cell.value)] = cell.value[1:]
    return set(found.values())


def test_the_functions_are_those_of_the_specification() -> None:
    assert set(ARGUMENTS) <= set(FORMULAE)  # openpyxl's list, read from the specification


@pytest.mark.parametrize(
    "name",
    thinned(
        ["rapier-drive-limited", "double-butterfly", "cam-swinging-follower", "scissor-three-bars",
         "planetary-differential", "oval-gears", "excavator", "garage-door", "dixon-two",
         "geneva-drive", "watt-linkage", "curved-slot"], 3
    ),
)  # fmt: skip
def test_every_formula_is_one_of_the_file_format(name: str, tmp_path: Path) -> None:
    mechanism = coarse(lw.example(name), 6)
    mechanism.write(tmp_path / "cycle.xlsx", motion=mechanism.sweep(certify=False))
    found = formulas_of(tmp_path / "cycle.xlsx")
    assert len(found) > 20
    for formula in found:
        check_formula(formula)


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
@pytest.mark.parametrize("unit", list(AngleUnit))
def test_every_function_of_files_has_one_in_cells(name: str, unit: AngleUnit) -> None:
    given = "a, b" if name in _TWO else "a"
    formula = of_radians(parse(f"{name}({given})"), unit)
    check_formula(cell_text(formula, {"a": "B1", "b": "B2"}))


def test_a_formula_too_long_for_a_cell_is_values_only(tmp_path: Path) -> None:
    power = "^".join(["(x + 1)"] * 9)
    mechanism = lw.loads(
        f'format = 1\nname = "tower"\n[equations]\nF = "{power} - u = 0"\n'
        '[guess]\nx = 0.01\nu = 1.01\n[input]\nvariable = "u"\nfrom = 1.01\nto = 1.1\nstep = 0.01\n'
    )
    told = mechanism.write(tmp_path / "tower.xlsx", motion=mechanism.sweep())
    assert told == ("x: its formula is too long; the column contains Linkwork's values",)
    for formula in formulas_of(tmp_path / "tower.xlsx"):
        check_formula(formula)


def test_names_that_look_like_formulas_are_texts(tmp_path: Path) -> None:
    mechanism = lw.loads(
        'format = 1\nname = "=1+1"\nsource = "=HYPERLINK(1)"\n[equations]\nF = "x - u = 0"\n'
        '[guess]\nx = 1\nu = 1\n[input]\nvariable = "u"\nfrom = 1\nto = 2\nstep = 1\n'
    )
    mechanism.write(tmp_path / "x.xlsx", motion=mechanism.sweep())
    about = openpyxl.load_workbook(tmp_path / "x.xlsx")["About"]
    assert (about["A1"].value, about["A1"].data_type) == ("=1+1", "s")
    assert about["B4"].data_type == "s"
