"""What a person sees of a workbook: units of dimensions, printed pages, progress."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path
from typing import Any

import openpyxl
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.results.quantity import Kind
from linkwork.writers.formulas.rate_formulas import dimension_kinds
from linkwork.writers.formulas.traced import traced
from linkwork.writers.workbook.workbook import workbook_of


def opened(tmp_path: Path, mechanism: Any, **asked: Any) -> Any:
    path = tmp_path / "cycle.xlsx"
    mechanism.write(path, motion=mechanism.sweep(certify=False, **asked))
    return openpyxl.load_workbook(path)


def units(book: Any) -> dict[str, str]:
    cells = book["Dimensions"].iter_rows(min_row=6, max_col=3, values_only=True)
    return {name: unit for name, _, unit in cells if unit}


def test_dimensions_of_loops_have_units(tmp_path: Path) -> None:
    shown = units(opened(tmp_path, lw.example("rapier-drive"), step=90))
    assert {shown[name] for name in ("a1", "b1", "d1", "a2", "a6")} == {"mm"}
    assert shown["θ12 from"] == "deg"


LOOPS = """format = 1
name = "kinds"
length = "cm"
angle = "deg"
[dimensions]
a = 40
beta = 10
half = "a/2"
share = 0.5
ratio = 2
area = 800
[loops]
L = "a*e^(i*(t + beta)) + 3*a*share*e^(i*p) = 100 + (area/half)*e^(i*q) + ratio*s*e^(i*0)"
M = "s*e^(i*1.5708) = half*e^(i*(p + 2*beta))*share + y*e^(i*0)"
[guess]
t = 60
p = 20
q = 80
s = 10
y = 10
[input]
variable = "t"
from = 60
to = 62
step = 1
"""


def test_the_kind_of_a_dimension_follows_from_its_place() -> None:
    kinds = dimension_kinds(traced(lw.loads(LOOPS).description))
    assert kinds["beta"] is Kind.ANGLE
    assert kinds["a"] is Kind.LENGTH  # alone before e^(iθ)
    assert kinds["half"] is Kind.LENGTH  # derived from it
    assert kinds["ratio"] is Kind.NUMBER  # before a variable length
    assert "share" not in kinds  # a factor of a product
    assert "area" not in kinds


def test_plain_equations_have_no_units(tmp_path: Path) -> None:
    mechanism = lw.loads(
        'format = 1\nname = "plain"\n[dimensions]\na = 2\n[equations]\nF = "a*x - u = 0"\n'
        '[guess]\nx = 1\nu = 1\n[input]\nvariable = "u"\nfrom = 1\nto = 2\nstep = 1\n'
    )
    assert "a" not in units(opened(tmp_path, mechanism))


@pytest.mark.parametrize("name", ["four-bar", "jansen-leg"])
def test_tables_print_on_few_pages_with_headings(name: str, tmp_path: Path) -> None:
    book = opened(tmp_path, lw.example(name), step=10)
    most = {"four-bar": 4, "jansen-leg": 6}[name]
    for sheet in ("Cycle", "Velocities", "Newton", "Linkwork"):
        page = book[sheet]
        assert page.page_setup.orientation == "landscape"
        assert page.page_setup.paperSize == 9  # A4
        assert page.sheet_properties.pageSetUpPr.fitToPage
        assert 1 <= int(page.page_setup.fitToWidth or 1) <= most
        assert page.page_setup.fitToHeight == 0
        assert page.print_title_rows == "$4:$6"
        assert page.print_title_cols.startswith("$A:")
        assert page.print_area
    rows = book["Newton"].print_area.rpartition("$")[2]
    assert int(rows) == 36  # thirty rows of iterations
    assert book["Cycle"].print_area.rpartition("$")[2] == "43"


def test_writing_tells_how_far_it_is() -> None:
    mechanism = lw.example("four-bar")
    told: list[float] = []
    workbook_of(mechanism.model, mechanism.sweep(step=90), progress=told.append)
    assert told == sorted(told)
    assert len(told) >= 8  # sheets, and iterations of the longest one
    assert 0.0 < told[0] < told[-1] <= 1.0


def test_a_mechanism_without_unknowns_is_written(tmp_path: Path) -> None:
    crank = lw.linkage(
        points={"O": (0, 0), "A": (1, 0)},
        links={"ground": ["O"], "crank": ["O", "A"]},
        inputs=[lw.Input(link="crank", step=60)],
    )
    book = opened(tmp_path, crank)
    assert book["Velocities"]["C7"].value.startswith("=-OA_x*SIN(")


def test_too_many_cells_are_refused(tmp_path: Path) -> None:
    mechanism = lw.example("double-butterfly")
    motion = mechanism.sweep(step=0.04, certify=False)
    message = (
        "9001 rows of 257 columns are too many cells for a workbook with formulas (at most "
        "2000000): take a larger step, or write CSV"
    )
    with pytest.raises(InputError, match=f"^{re.escape(message)}$"):
        mechanism.write(tmp_path / "x.xlsx", motion=motion)
    assert not (tmp_path / "x.xlsx").exists()


@pytest.mark.parametrize(
    "hostile", ["=cmd|' /C calc'!A0", "cmd!A0", "=1+1", "{=1+1}", "http://a.b"]
)
def test_no_text_of_a_file_becomes_a_formula_a_reference_or_a_link(
    hostile: str, tmp_path: Path
) -> None:
    mechanism = lw.example("slider-crank").changed(
        name=hostile, length=hostile, purpose=hostile, source=hostile, family=hostile
    )
    mechanism.write(tmp_path / "cycle.xlsx", motion=mechanism.sweep(step=90, certify=False))
    titles = 0
    with zipfile.ZipFile(tmp_path / "cycle.xlsx") as parts:
        for name in parts.namelist():
            text = parts.read(name).decode("utf-8", "replace")
            for formula in re.findall(r"<(?:c:)?f>(.*?)</(?:c:)?f>", text):
                assert not re.search(r"calc|cmd|^1\+1$", formula), name
            assert "hyperlink" not in text, name
            assert "externalLink" not in name
            titles += len(re.findall(r"<c:title><c:tx><c:rich>", text))
            assert "<c:title><c:tx><c:strRef>" not in text, name
    assert titles == 9
