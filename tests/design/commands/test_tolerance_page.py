"""The pages of ``linkwork sensitivity`` and ``linkwork tolerance``."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from linkwork import example_text
from tests.core.commands.conftest import Run

TABLES = """
[tolerances]
"O2 A" = { deviation = 0.02 }
"B A" = { deviation = 0.05 }
"d.offset" = { deviation = 0.03 }
[clearances]
B = 0.02
"""


@pytest.fixture
def crank(tmp_path: Path) -> str:
    file = tmp_path / "crank.toml"
    file.write_text(example_text("slider-crank") + TABLES, encoding="utf-8")
    return str(file)


def test_sensitivities_at_a_position_are_listed_with_the_largest_first(run: Run) -> None:
    done = run("sensitivity", "slider-crank", "--of", "d", "--at", "60")
    assert done.exit_code == 0
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "  B A         120 mm   1.12320\n" in done.stdout
    assert done.stdout.index("B A") < done.stdout.index("d.offset") < done.stdout.index("O2 A")
    assert "5 more numbers have no effect" in done.stdout


def test_sensitivities_of_rows_and_of_motions_are_written(run: Run, tmp_path: Path) -> None:
    table = tmp_path / "rows.csv"
    by = ("--by", "O2 A", "--by", "B A")
    done = run("sensitivity", "slider-crank", "--of", "d", *by, "--csv", str(table))
    assert done.exit_code == 0
    header, *rows = table.read_text(encoding="utf-8").splitlines()
    assert header == "crank,d,by O2 A,by B A,status"
    assert len(rows) == 361
    assert rows[60].startswith("60,126.838005194522")
    assert ",1.12319581202880" in rows[60]
    data = json.loads(run("sensitivity", "slider-crank", "--of", "stroke(d)", "--json").stdout)
    assert data["status"] == ["FOUND"]
    # of sqrt((b + a)² - e²) - sqrt((b - a)² - e²) with a = 40, b = 120, e = 20
    exact = 160 / math.sqrt(160**2 - 20**2) + 80 / math.sqrt(80**2 - 20**2)
    assert data["derivatives"]["O2 A"] == pytest.approx(exact, rel=1e-9)


def test_a_position_that_is_missing_ends_with_exit_code_1(run: Run, tmp_path: Path) -> None:
    file = tmp_path / "bar.toml"
    text = example_text("four-bar").replace('"O2 A"  = 40', '"O2 A"  = 80')
    assert text != example_text("four-bar")
    file.write_text(text, encoding="utf-8")
    done = run("sensitivity", str(file), "--of", "rocker", "--at", "5")
    assert done.exit_code == 1
    assert "No sensitivity of rocker" in done.stdout


def test_a_tolerance_shows_shares_and_random_designs(run: Run, crank: str) -> None:
    done = run("tolerance", crank, "--of", "d", "--at", "60", "--samples", "500")
    assert done.exit_code == 0
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert "worst case       ± 0.0951085 mm\n" in done.stdout
    assert "500 of 500 found, seed 1" in done.stdout
    lines = done.stdout.splitlines()
    assert [line.split()[0] for line in lines[-4:]] == ["B", "pin", "d.offset", "O2"]


def test_a_tolerance_as_json_and_csv(run: Run, crank: str) -> None:
    data = json.loads(run("tolerance", crank, "--of", "stroke(d)", "--json").stdout)
    assert data["status"] == "FOUND"
    assert sum(part["share"] for part in data["contributions"]) == pytest.approx(1.0)
    assert {part["kind"] for part in data["contributions"]} == {"dimension", "clearance"}
    written = run("tolerance", crank, "--of", "d", "--at", "60", "--csv", "-").stdout
    assert written.splitlines()[0] == "name,kind,sensitivity,deviation,worst,standard,share"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("sensitivity", "slider-crank", "--of", "dd", "--at", "60"), 'there is no "dd"'),
        (("sensitivity", "slider-crank", "--of", "stroke(d)", "--at", "6"), "leave out --at"),
        (("sensitivity", "slider-crank", "--of", "d", "--by", "B Z"), "can vary (numbers: B A,"),
        (("tolerance", "slider-crank", "--of", "d", "--at", "60"), "add [tolerances]"),
        (("tolerance", "slider-crank", "--of", "d", "--json", "--csv", "-"), "both use standard"),
    ],
)
def test_wrong_questions_end_with_exit_code_2(
    run: Run, arguments: tuple[str, ...], message: str
) -> None:
    done = run(*arguments)
    assert done.exit_code == 2
    assert message in done.output
