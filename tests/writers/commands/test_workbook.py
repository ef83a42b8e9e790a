"""``linkwork sweep --xlsx``."""

from __future__ import annotations

from pathlib import Path

import openpyxl

from tests.core.commands.conftest import Run


def test_sweep_writes_a_workbook(run: Run) -> None:
    done = run("sweep", "four-bar.toml", "--step", "45", "--xlsx", "bar.xlsx")
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines()[-1] == (
        "Wrote bar.xlsx: 9 rows with formulas; edit a yellow cell to solve them again."
    )
    book = openpyxl.load_workbook("bar.xlsx")
    assert book.sheetnames == [
        "About", "Dimensions", "Cycle", "Velocities", "Drawing", "Charts", "Newton", "Linkwork",
    ]  # fmt: skip
    assert book["Cycle"].freeze_panes == "C7"


def test_a_workbook_is_an_xlsx_file(run: Run) -> None:
    done = run("sweep", "four-bar.toml", "--xlsx", "bar.ods")
    assert done.exit_code == 2
    assert done.stderr == ('Error: cannot write "bar.ods": a workbook needs the suffix .xlsx\n')
    assert not Path("bar.ods").exists()


def test_a_table_named_like_a_workbook_points_to_the_option(run: Run) -> None:
    done = run("sweep", "four-bar.toml", "--csv", "bar.xlsx")
    assert done.exit_code == 2
    assert "linkwork sweep writes workbooks with --xlsx" in " ".join(done.stderr.split())
    assert not Path("bar.xlsx").exists()
