"""Statuses follow the cells: no row says that it is proved once its numbers have changed."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import pytest

import linkwork as lw
from tests.oracles.spreadsheet import Spreadsheet


def written(tmp_path: Path, mechanism: Any, **asked: Any) -> Spreadsheet:
    path = tmp_path / "cycle.xlsx"
    mechanism.write(path, motion=mechanism.sweep(**asked))
    return Spreadsheet(path)


def statuses(sheet: Spreadsheet) -> Counter[str]:
    return Counter(sheet.column("Cycle", "status"))


def test_a_status_names_the_input_that_was_proved(tmp_path: Path) -> None:
    sheet = written(tmp_path, lw.example("four-bar"), step=90)
    assert sheet.column("Cycle", "status") == [
        f"proved for crank = {angle} deg" for angle in (0, 90, 180, 270, 360)
    ]


def test_the_inputs_of_a_proof_are_all_named(tmp_path: Path) -> None:
    mechanism = lw.example("planetary-differential")
    sheet = written(tmp_path, mechanism)
    assert sheet.column("Cycle", "status")[1] == "proved for sun = 4 deg, ring = 89 deg"


@pytest.mark.parametrize(
    ("cell", "value"),
    [
        ("O2A", 40.0000001),  # a dimension, by a part in a billion
        ("O4_x", 101.0),
        ("theta_crank_from", 1.0),
        ("theta_crank_step", 91.0),
    ],
)
def test_no_changed_row_is_proved(cell: str, value: float, tmp_path: Path) -> None:
    sheet = written(tmp_path, lw.example("four-bar"), from_=90, to=360, step=90)
    sheet.set(cell, value)
    changed = 3 if cell == "theta_crank_step" else 4  # the first row has no step
    assert statuses(sheet)["converged (not proved)"] == changed
    about = sheet.book["About"]
    row = next(cell.row for cell in about["A"] if cell.value == "Rows still proved")
    assert sheet["About", f"B{row}"] == 4 - changed


def test_a_change_taken_back_shows_the_proofs_again(tmp_path: Path) -> None:
    sheet = written(tmp_path, lw.example("four-bar"), step=90)
    before = statuses(sheet)
    sheet.set("AB", 121)
    assert statuses(sheet) != before
    assert sheet["Dimensions", "F8"] == "changed"
    sheet.set("AB", 120)
    assert statuses(sheet) == before


def test_another_branch_from_other_estimates_is_not_proved(tmp_path: Path) -> None:
    sheet = written(tmp_path, lw.example("four-bar"), step=90)
    sheet.set("theta_coupler_start", -36.0)
    sheet.set("theta_rocker_start", -62.0)
    assert statuses(sheet) == {"converged (not proved)": 5}


def test_a_row_out_of_reach_after_a_change_has_no_position(tmp_path: Path) -> None:
    sheet = written(tmp_path, lw.example("four-bar"), step=30)
    sheet.set("O2A", 75)
    assert set(statuses(sheet)) == {
        "converged (not proved)", "no convergence from the row above",
    }  # fmt: skip


def test_a_row_that_comes_into_reach_after_a_change_has_a_position(tmp_path: Path) -> None:
    sheet = written(tmp_path, lw.example("rapier-drive-limited"), from_=60, to=180, step=30)
    out = "no position: this branch does not reach the input value (OUT_OF_REACH)"
    lost = statuses(sheet)[out]
    assert lost > 0
    sheet.set("a2_", 200)
    assert statuses(sheet) == {"converged (not proved)": 5}
    assert all(isinstance(x, float) for x in sheet.column("Cycle", "s16"))


def test_rows_without_any_position_say_so(tmp_path: Path) -> None:
    bars = {"ground": ["O", "C"], "crank": ["O", "A"], "rod": ["A", "B"], "rocker": ["C", "B"]}
    mechanism = lw.linkage(
        points={"O": (0, 0), "A": (1, 0), "B": (3, 0.5), "C": (3, 0)},
        links=bars,
        lengths={"O A": 9, "A B": 1, "C B": 1},
        inputs=[lw.Input(link="crank", step=90)],
    )
    sheet = written(tmp_path, mechanism)
    assert all(said.startswith("no position: ") for said in statuses(sheet))
    sheet.set("OA", 1.0)
    sheet.set("AB", 3.0)
    sheet.set("CB", 2.0)
    assert statuses(sheet)["converged (not proved)"] > 0


def test_a_cam_row_is_not_solved_for_another_input(tmp_path: Path) -> None:
    sheet = written(tmp_path, lw.example("cam-swinging-follower"), step=90)
    sheet.set("theta_cam_from", 1.0)
    assert statuses(sheet) == {"arm not recalculated for another input": 5}


def test_a_changed_grey_cell_is_said_not_to_be_solved(tmp_path: Path) -> None:
    sheet = written(tmp_path, lw.example("parallel-cranks"), step=90)
    sheet.set("O2A2", 35.0)
    assert set(statuses(sheet)) == {"not solved: a changed cell is not used"}


def test_a_redundant_link_that_does_not_fit_is_named(tmp_path: Path) -> None:
    sheet = written(tmp_path, lw.example("scissor-three-bars"), from_=60, to=90, step=10)
    sheet.set("OC", 61.0)
    assert statuses(sheet) == {"redundant link bar3 does not fit": 4}
