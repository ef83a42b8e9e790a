"""``linkwork export``: the bill of materials on the page, as CSV and as JSON."""

from __future__ import annotations

import json
from pathlib import Path

from tests.core.commands.conftest import Run


def test_the_command_writes_plates_with_their_bill(run: Run, tmp_path: Path) -> None:
    out, bill = tmp_path / "a.dxf", tmp_path / "bill.csv"
    page = run("export", "plates", "slider-crank", "-o", str(out), "--bill", str(bill)).stdout
    assert "proved for every position of the table, for pins without" in page
    assert max(map(len, page.replace(str(tmp_path), "").splitlines())) <= 80
    lines = bill.read_text("utf-8").splitlines()
    assert lines[0] == "kind,name,lowest layer,highest layer,length,diameter,area,holes"
    assert out.exists()
    data = json.loads(run("export", "plates", "four-bar", "-o", str(out), "--json").stdout)
    assert data["proved"]
    assert {row["name"]: row["lowest layer"] for row in data["bill"] if row["kind"] == "plate"} == {
        "ground": 0, "crank": 1, "coupler": 2, "rocker": 1,
    }  # fmt: skip


def test_a_bill_that_cannot_be_written_says_that_the_plates_are(run: Run, tmp_path: Path) -> None:
    out, bill = tmp_path / "a.svg", tmp_path / "bill.csv"
    bill.symlink_to(tmp_path / "gone" / "bill.csv")
    done = run("export", "plates", "four-bar", "-o", str(out), "--bill", str(bill))
    assert done.exit_code == 2
    told = "".join(done.stderr.split())
    assert told.endswith(f";theplatesarewrittento{out}")
    assert out.exists()
