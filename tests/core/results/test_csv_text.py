"""Cells of tables as text."""

from __future__ import annotations

import numpy as np

from linkwork.core.results.tables import Table, csv_text


def test_zeros_have_no_sign_and_missing_numbers_are_empty() -> None:
    columns = {"x": np.array([-0.0, -1.5, np.nan]), "ok": np.array([True, False, True])}
    table = Table(columns=columns, units={"x": "mm", "ok": ""}, index="x")
    assert csv_text(table) == "x,ok\n0,true\n-1.5,false\n,true\n"


def test_texts_that_a_spreadsheet_would_calculate_are_marked_as_texts() -> None:
    texts = np.array(["=1+1", "+1", "-1", "@SUM(A1)", "a=1", ""])
    columns = {"x": np.full(6, -1.0), "status": texts}
    table = Table(columns=columns, units={"x": "mm", "status": ""}, index="x")
    cells = [line.partition(",")[2] for line in csv_text(table).splitlines()[1:]]
    assert cells == ["'=1+1", "'+1", "'-1", "'@SUM(A1)", "a=1", ""]
