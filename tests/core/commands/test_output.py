"""What programs read: JSON, CSV, pictures, files."""

from __future__ import annotations

import csv
import io
import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork import example_text, load
from linkwork.core.commands import options as output_file
from linkwork.core.foundation.errors import InputError
from linkwork.core.results.motion import table_of
from tests.core.commands.conftest import Run


def _json(text: str) -> Any:
    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    return json.loads(text, parse_constant=refuse)


def test_a_position_as_json(run: Run) -> None:
    data = _json(run("solve", "slider-crank.toml", "--at", "90", "--json").stdout)
    assert data["schema"] == 1
    assert data["units"] == {"angle": "deg", "length": "mm"}
    assert (data["status"], data["message"]) == ("CONVERGED", "position found")
    assert data["input"] == {"crank": 90.0}
    assert data["unknowns"]["stroke"] == pytest.approx(math.sqrt(120**2 - 40**2), rel=1e-12)
    assert data["sliders"]["stroke"] == data["unknowns"]["stroke"]
    assert data["points"]["A"] == pytest.approx([0, 40], abs=1e-12)
    assert {"residual", "iterations", "condition", "certificate", "links"} <= set(data)


def test_a_position_that_was_not_found_has_null_for_numbers(run: Run) -> None:
    data = _json(run("solve", "open.toml", "--json").stdout)
    assert data["status"] == "CANNOT_CLOSE"
    assert set(data["unknowns"].values()) == {None}
    assert data["condition"] is None


def test_steps_as_json(run: Run) -> None:
    data = _json(run("solve", "cubic.toml", "--json", "--show-steps").stdout)
    assert data["steps"][0]["steps"][1]["unknowns"] == {"x": pytest.approx(-1.8, rel=1e-12)}


def test_a_check_as_json(run: Run) -> None:
    data = _json(run("check", "four-bar.toml", "--json").stdout)
    assert data["schema"] == 1
    assert data["mobility"] == {"count": 1, "rank": 1}
    assert data["start"]["status"] == "CONVERGED"
    assert _json(run("check", "open.toml", "--json").stdout)["start"]["status"] == "CANNOT_CLOSE"


def test_a_classification_as_json(run: Run) -> None:
    data = _json(run("check", "four-bar.toml", "--json").stdout)
    dyad = {"links": ["coupler", "rocker"], "name": "dyad RRR", "class": 2, "order": 2}
    assert data["blocks"] == [
        {"equations": ["O2 A B O4"], "unknowns": ["coupler", "rocker"], "group": dyad}
    ]
    assert data["classification"] == {
        "chain": "four-bar chain",
        "links": 4,
        "inversion": None,
        "type": "crank-rocker (GCRR): Grashof, s + l < p + q by 20 mm",
        "blocks": [],
        "loop": {
            "links": ["ground", "crank", "coupler", "rocker"],
            "name": "crank-rocker",
            "barker": "GCRR",
            "grashof": True,
            "margin": 20.0,
            "relative_margin": pytest.approx(1 / 6, rel=1e-15),
            "turns_fully": True,
        },
        "groups": [dyad],
        "class": 2,
    }
    assert _json(run("check", "cubic.toml", "--json").stdout)["classification"] is None


def test_equations_as_json(run: Run) -> None:
    data = _json(run("equations", "four-bar.toml", "--json").stdout)
    assert (data["schema"], data["mechanism"]) == (1, "Four-bar")
    assert data["unknowns"] == ["coupler", "rocker"]


def test_a_motion_as_json(run: Run) -> None:
    done = run("sweep", "double-rocker.toml", "--json")
    data = _json(done.stdout)
    assert done.stderr == "38 of 361 positions were not found\n"
    assert (data["schema"], data["mechanism"]) == (1, "Four-bar")
    assert set(data["units"]) == set(data["columns"])
    assert (data["units"]["P.x"], data["units"]["coupler.d1"]) == ("mm", "rad/rad")
    assert {len(column) for column in data["columns"].values()} == {363}  # two at dead points
    assert data["columns"]["coupler"][0] is None
    assert data["columns"]["status"][0] == "OUT_OF_REACH"
    assert data["columns"]["status"][180] == "CONVERGED"
    assert data["counts"] == {"OUT_OF_REACH": 38, "CONVERGED": 325}
    assert [limit["status"] for limit in data["limits"]] == ["OUT_OF_REACH"] * 2
    low, high = data["limits"][0]["bracket"]
    assert low <= data["limits"][0]["input"] <= high


def test_a_whole_circuit_as_json(run: Run) -> None:
    words = ("sweep", "double-rocker.toml", "--step", "10", "--through", "--limits-of", "mu")
    data = _json(run(*words, "--json").stdout)
    assert data["circuit"] == "CLOSED"
    assert data["counts"] == {"OUT_OF_CIRCUIT": 4, "CONVERGED": 70}
    columns = data["columns"]
    assert columns["branch"].count("circuit 1 branch 2") == 35
    assert columns["limit"].count("dead point") == 4
    row = columns["limit"].index("dead point")
    assert columns["rocker.d1"][row] is None
    assert columns["condition"][row] is None
    assert columns["certified"][row] is True
    high, low = data["output_limits"]
    assert (high["name"], high["kind"], high["located"]) == ("mu", "maximum", True)
    assert (high["value"], low["value"]) == pytest.approx((114.9530208, -114.9530208), abs=1e-6)
    assert high["bracket"][0] <= 180 <= high["bracket"][1]
    for limit in data["limits"]:
        assert (limit["kind"], limit["located"], limit["passed"]) == ("DEAD_POINT", True, "")
        assert (limit["loops"], limit["in_line"]) == (["O2 A B O4"], ["coupler", "rocker"])
        assert limit["bracket"][0] <= limit["input"] <= limit["bracket"][1]
    assert _json(run("sweep", "four-bar.toml", "--json").stdout)["circuit"] is None


def test_change_points_as_json(run: Run) -> None:
    data = _json(run("sweep", "parallelogram.toml", "--change-points", "turn", "--json").stdout)
    assert [limit["passed"] for limit in data["limits"]] == ["", "turn", ""]
    assert [limit["input"] for limit in data["limits"]] == [0, 180, 360]
    assert data["limits"][1]["onward"]["rocker"] == pytest.approx(1, abs=1e-9)
    assert data["limits"][1]["other"]["rocker"] == pytest.approx(-1 / 5, abs=1e-9)
    assert data["columns"]["limit"][6] == "change point"


def test_rows_of_limits_are_in_the_csv_with_empty_cells(run: Run) -> None:
    words = ("sweep", "double-rocker.toml", "--step", "10", "--csv", "-")
    header, rows = _rows(run(*words).stdout)
    (first, second) = (row for row in rows if row[header.index("limit")] == "dead point")
    assert float(first[0]) == pytest.approx(18.1948723388, abs=1e-9)
    assert float(second[0]) == pytest.approx(341.805127661, abs=1e-9)
    for row in (first, second):
        assert row[header.index("rocker.d1")] == row[header.index("rocker.velocity")] == ""
        assert row[header.index("status")] == "CONVERGED"
        assert row[header.index("certified")] == "true"
        assert row[header.index("branch")] == "circuit 1 branch 1"
    assert [float(row[0]) for row in rows] == sorted(float(row[0]) for row in rows)


def _rows(text: str) -> tuple[list[str], list[list[str]]]:
    header, *rows = csv.reader(io.StringIO(text))
    return header, rows


@pytest.mark.parametrize("name", ["four-bar", "double-rocker"])
def test_csv_gives_every_float_back_exactly(run: Run, folder: Path, name: str) -> None:
    text = run("sweep", f"{name}.toml", "--csv", "-").stdout
    header, rows = _rows(text)
    table = table_of(load(f"{name}.toml").sweep())
    assert header == list(table.columns)
    for column, cells in zip(header, zip(*rows, strict=True), strict=True):
        expected = table[column]
        if expected.dtype == np.float64:
            back = np.array([float(cell) if cell else math.nan for cell in cells])
            np.testing.assert_array_equal(back, expected, err_msg=column)
    count = {"four-bar": 361, "double-rocker": 363}[name]
    assert run("sweep", f"{name}.toml", "--csv", "table.csv").stdout.endswith(
        f"\nWrote table.csv: {count} rows.\n"
    )
    assert (folder / "table.csv").read_bytes() == text.encode()


def test_the_table_is_written_although_rows_failed(run: Run, folder: Path) -> None:
    done = run("sweep", "open.toml", "--csv", "a.csv", "--draw", "a.svg")
    assert done.exit_code == 1
    assert len((folder / "a.csv").read_text(encoding="utf-8").splitlines()) == 362
    assert not (folder / "a.svg").exists()
    assert "Did not write a.svg: there is no position to draw.\n" in done.stdout


def test_range_options_replace_the_range_of_the_file(run: Run) -> None:
    words = ("--from", "90", "--to", "180/2 + 2*a/40", "--step", "0.5", "--csv", "-")
    _, rows = _rows(run("sweep", "four-bar.toml", *words).stdout)
    assert [row[0] for row in rows] == ["90", "90.5", "91", "91.5", "92"]


@pytest.mark.parametrize("value", ["50", "5*10", " 50.0 "])
def test_set_replaces_a_dimension(run: Run, value: str) -> None:
    words = ("solve", "four-bar.toml", "--at", "0", "--json")
    data = _json(run(*words, "--set", f"a={value}").stdout)
    assert data["points"]["A"] == pytest.approx([50, 0], abs=1e-9)
    assert _json(run(*words).stdout)["points"]["A"] == pytest.approx([40, 0], abs=1e-9)


@pytest.mark.parametrize("command", ["check", "equations", "solve", "sweep"])
def test_every_command_that_reads_a_file_can_set_dimensions(run: Run, command: str) -> None:
    assert run(command, "four-bar.toml", "--set", "a=41").exit_code == 0
    assert run(command, "four-bar.toml", "--set", "b=41").exit_code == 2


def test_set_replaces_every_number_that_a_family_varies(run: Run) -> None:
    words = ("solve", "four-bar.toml", "--at", "0", "--json")
    data = _json(run(*words, "--set", "O2 A=50", "--set", "A.x=30+3").stdout)
    assert data["points"]["A"] == pytest.approx([50, 0], abs=1e-9)
    assert run("solve", "four-bar.toml", "--set", "O2 A=50", "--set", "A O2=51").stderr == (
        'Error: "A O2" has a value already: 50.0\n'
    )


def test_a_mechanism_of_the_library_needs_no_file(run: Run) -> None:
    data = _json(run("solve", "four-bar", "--at", "60", "--json").stdout)
    assert data["unknowns"]["rocker"] == pytest.approx(64.94348110579881)


def test_set_finds_a_dimension_in_any_spelling(run: Run, folder: Path) -> None:
    text = (folder / "four-bar.toml").read_text(encoding="utf-8")
    renamed = text.replace("a = 40", '"ρ" = 40').replace('= "a"', '= "rho"')
    (folder / "rho.toml").write_text(renamed, encoding="utf-8")
    data = _json(run("solve", "rho.toml", "--at", "0", "--json", "--set", "rho=50").stdout)
    assert data["points"]["A"] == pytest.approx([50, 0], abs=1e-9)
    twice = run("solve", "rho.toml", "--set", "rho=50", "--set", "ρ=60")
    assert twice.stderr == 'Error: "ρ" has a value already: 50.0\n'


def test_at_takes_one_value_for_each_of_several_inputs(run: Run) -> None:
    words = ("solve", "five-bar.toml", "--at", "left=100", "--at", "right = 2*40", "--json")
    assert _json(run(*words).stdout)["input"] == {"left": 100.0, "right": 80.0}
    assert run("solve", "five-bar.toml", "--at", "left=100").exit_code == 2


def test_a_dash_reads_standard_input(run: Run, folder: Path) -> None:
    text = (folder / "four-bar.toml").read_text(encoding="utf-8")
    assert run("solve", "-", stdin=text).stdout == run("solve", "four-bar.toml").stdout
    wrong = run("solve", "-", stdin=text.replace("= 120", "= -120"))
    assert wrong.exit_code == 2
    assert wrong.stderr.startswith("Error: 1 problem in standard input\n  line 18  ")


def test_an_example_is_printed_as_it_is_and_written_once(run: Run, folder: Path) -> None:
    text = example_text("rapier-drive")
    assert run("examples", "rapier-drive").stdout == text
    done = run("examples", "rapier-drive", "-o", "r.toml")
    assert done.stdout == "Wrote r.toml. Next: linkwork sweep r.toml\n"
    assert (folder / "r.toml").read_bytes() == text.encode()
    (folder / "r.toml").write_text("mine", encoding="utf-8")
    again = run("examples", "rapier-drive", "-o", "r.toml")
    assert again.exit_code == 2
    assert again.stderr == ('Error: "r.toml" exists already: choose another name, or add --force\n')
    assert (folder / "r.toml").read_text(encoding="utf-8") == "mine"
    assert run("examples", "rapier-drive", "-o", "r.toml", "--force").exit_code == 0
    assert (folder / "r.toml").read_bytes() == text.encode()


def test_the_schema_is_json(run: Run) -> None:
    assert _json(run("schema").stdout)["title"] == "Linkwork mechanism file"


def test_a_file_that_fails_half_way_leaves_the_old_one(folder: Path) -> None:
    def pieces() -> Any:
        yield "new"
        raise OSError(28, "No space left on device")

    (folder / "a.csv").write_text("old", encoding="utf-8")
    with pytest.raises(
        InputError, match=r'^cannot write "a\.csv": No space left on device: make room'
    ):
        output_file.write_text("a.csv", pieces())
    assert (folder / "a.csv").read_text(encoding="utf-8") == "old"
    assert not list(folder.glob(".*"))


def test_a_link_is_followed_and_a_device_is_not_replaced(folder: Path) -> None:
    (folder / "real.csv").write_text("old", encoding="utf-8")
    (folder / "link.csv").symlink_to("real.csv")
    output_file.write_text("link.csv", ["new"])
    assert (folder / "link.csv").is_symlink()
    assert (folder / "real.csv").read_text(encoding="utf-8") == "new"
    pipe = folder / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        output_file.write_text("pipe", ["new"])
        assert os.read(reader, 10) == b"new"
    finally:
        os.close(reader)
    assert pipe.is_fifo()


@pytest.mark.parametrize(
    ("command", "suffix", "first"),
    [
        ("draw", "tikz", b"% "),
        ("export", "c", b"/*"),
        ("export", "sdf", b"<!--"),
        ("export", "md", b"# "),
    ],
)
def test_no_command_replaces_a_device(
    command: str, suffix: str, first: bytes, run: Run, folder: Path
) -> None:
    pipe = folder / f"pipe.{suffix}"
    os.mkfifo(pipe)
    (folder / f"link.{suffix}").symlink_to(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    (folder / "short.toml").write_text('sections = ["summary"]\n', encoding="utf-8")
    more = ["--template", "short.toml"] if suffix == "md" else []
    try:
        done = run(command, "four-bar.toml", "-o", f"link.{suffix}", *more)
        assert done.exit_code == 0, done.stderr
        assert os.read(reader, 10).startswith(first)
    finally:
        os.close(reader)
    assert pipe.is_fifo()
    assert (folder / f"link.{suffix}").is_symlink()


def test_every_command_prints_json(run: Run, folder: Path) -> None:
    written = {"draw": "a.svg", "plot": "b.svg", "animate": "c.html"}
    for command, path in written.items():
        done = run(command, "four-bar.toml", "-o", path, "--json")
        assert _json(done.stdout) == {"schema": 1, "written": [path]}
        assert (folder / path).exists()
    listed = _json(run("examples", "--json").stdout)["examples"]
    assert [entry["name"] for entry in listed] == list(lw.examples())
    assert ("boxer-engine", "engine and pump") in [(e["name"], e["family"]) for e in listed]
    text = _json(run("examples", "four-bar", "--json").stdout)["text"]
    assert text == lw.example_text("four-bar")
    assert _json(run("schema", "--json").stdout)["$schema"]


def test_inputs_that_a_whole_circuit_does_not_reach_are_no_failure(run: Run) -> None:
    words = ("sweep", "double-rocker.toml", "--from", "0", "--to", "360", "--step", "30")
    assert run(*words).exit_code == 1
    assert run(*words, "--through").exit_code == 0
    drawn = ("plot", *words[1:], "-o", "a.svg")
    assert run(*drawn).exit_code == 1
    assert run(*drawn, "--through").exit_code == 0


@pytest.mark.parametrize("speed", ["300 rpm", "300 RPM", "300Rpm", "10*pi RAD/S"])
def test_units_of_speeds_are_read_in_any_case(run: Run, folder: Path, speed: str) -> None:
    text = (folder / "four-bar.toml").read_text(encoding="utf-8")
    (folder / "fast.toml").write_text(text.replace("300 rpm", speed), encoding="utf-8")
    done = run("solve", "fast.toml", "--at", "60", "--json")
    slow = run("solve", "four-bar.toml", "--at", "60", "--json")  # 300 rpm
    found, wanted = (_json(text.stdout)["velocity"]["rocker"] for text in (done, slow))
    assert found == pytest.approx(wanted)
