"""The draft of a paper: its figures are those of the benchmarks, its references exist."""

from __future__ import annotations

import re
from pathlib import Path

_TREE = Path(__file__).resolve().parents[2]
_PAPER = (_TREE / "paper" / "paper.md").read_text(encoding="utf-8")
_RECORD = (_TREE / "docs" / "benchmarks.md").read_text(encoding="utf-8")
#: Numbers of four digits and more, with powers of ten.
_FIGURE = re.compile(r"\b\d{1,3}(?:,\d{3})+\b|\b\de-\d+\b")
#: Rows of the table by the names in the record; every other column is for 3,601 rows.
_ROWS = {
    "Linkwork, `sweep`, certified": "linkwork, certified",
    "pylinkage `step_fast`": "pylinkage step_fast",
    "CasADi `fast_newton`, C": "casadi fast_newton, C",
    "SciPy `fsolve`": "scipy fsolve",
    "Exudyn": "exudyn",
    "python-solvespace": "python-solvespace",
    "KinePy": "kinepy",
}


def test_the_figures_of_the_paper_are_recorded() -> None:
    body = _PAPER.partition("# Validation")[2]
    figures = set(_FIGURE.findall(body))
    assert len(figures) > 20
    assert figures - set(_FIGURE.findall(_RECORD)) == set()


def test_the_table_of_the_paper_is_that_of_the_peers() -> None:
    for name, recorded in _ROWS.items():
        written = next(row for row in _PAPER.split("\n") if row.startswith(f"| {name} |"))
        record = next(row for row in _RECORD.split("\n") if row.startswith(f"| {recorded} |"))
        cells = [re.sub(r" \(.*\)", "", cell).strip() for cell in record.split("|")[2:8]]
        shown = [cell.strip().replace("--", "–") for cell in written.split("|")[2:5]]
        assert shown == cells[1::2], name


def test_every_citation_of_the_paper_has_an_entry() -> None:
    entries = re.findall(
        r"^@\w+\{(\w+),", (_TREE / "paper/paper.bib").read_text(encoding="utf-8"), re.M
    )
    assert set(re.findall(r"@([a-z]+\d{4})", _PAPER)) == set(entries)
