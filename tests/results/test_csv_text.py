"""Cells of tables as text."""

from __future__ import annotations

import numpy as np

from linkwork.results.csv_text import csv_text
from linkwork.results.table import Table


def test_zeros_have_no_sign_and_missing_numbers_are_empty() -> None:
    columns = {"x": np.array([-0.0, -1.5, np.nan]), "ok": np.array([True, False, True])}
    table = Table(columns=columns, units={"x": "mm", "ok": ""}, index="x")
    assert csv_text(table) == "x,ok\n0,true\n-1.5,false\n,true\n"
