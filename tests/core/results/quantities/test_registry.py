"""Every registered quantity can be asked for everywhere, under one name and in one unit."""

from __future__ import annotations

import csv
import io
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import linkwork as lw
from linkwork.app import motion_page
from linkwork.core.commands.main import linkwork
from linkwork.core.foundation.errors import InputError, MechanismError, UnknownNameError
from linkwork.core.results.quantities.registry import EVIDENCE, MOTION_QUANTITIES, ROW_QUANTITIES
from linkwork.core.results.tables import csv_lines
from linkwork.families.study import read_plan_text
from linkwork.writers.charts.chart import column_of
from linkwork.writers.workbook.workbook import workbook_of
from tests.app.unpacking import unpacked

ROWS = ["B.transmission", "rocker.mechanical_advantage", "B.curvature", "B.centre.x", "B.centre.y"]
NUMBERS = [
    "min(mu)", "max(rocker.d1)", "mean(B.transmission)", "stroke(rocker)", "time_ratio(rocker)",
    "path_length(B)", "dwell(rocker, 1)", "dwell_start(rocker, 1)",
]  # fmt: skip


@pytest.fixture(scope="module")
def mechanism() -> lw.Mechanism:
    return lw.example("four-bar")


@pytest.fixture(scope="module")
def motion(mechanism: lw.Mechanism) -> lw.Motion:
    return mechanism.sweep()


def test_the_names_of_this_test_are_all_that_are_registered() -> None:
    words = {name.partition("(")[0] for name in NUMBERS}
    assert words == {quantity.word for quantity in MOTION_QUANTITIES}
    words = {name.partition(".")[2] for name in ROWS}
    assert words == {row.word for row in ROW_QUANTITIES} - {"pressure_angle"}
    assert "d.pressure_angle" in lw.example("slider-crank").model.quantities.derived


@pytest.mark.parametrize("name", ROWS)
def test_a_quantity_of_every_row_is_one_everywhere(
    name: str, mechanism: lw.Mechanism, motion: lw.Motion
) -> None:
    values, unit = motion[name], motion.quantity(name).unit
    assert mechanism.solve(50)[name] == pytest.approx(values[50], rel=1e-9, abs=1e-9)
    family = mechanism.family({"O2 A": [38.0, 40.0]}).sweep()
    np.testing.assert_allclose(family[name][1], values, rtol=1e-8, atol=1e-8)
    assert family.unit(name) == family.to_xarray(name)[name].attrs["units"] == unit
    table = motion.table(name)
    np.testing.assert_array_equal(table[name], values)
    assert table.units[name] == unit
    column = column_of(motion, name)
    np.testing.assert_array_equal(column.values, values)
    assert column.unit == unit
    output = {**mechanism.description.outputs, "copy": f"2*{name} + 1"}
    copied = lw.Mechanism(replace(mechanism.description, outputs=output)).sweep()
    np.testing.assert_allclose(copied["copy"], 2 * values + 1, rtol=1e-9, atol=1e-9)


def test_a_page_lists_what_follows_from_the_mechanism(motion: lw.Motion) -> None:
    shown = motion_page({"": motion}).motions[0]
    columns = {column.name: column for column in shown.columns}
    column = columns["B.transmission"]
    assert (column.group, column.unit) == ("derived", "deg")
    np.testing.assert_allclose(
        unpacked(column.values, motion.found), motion["B.transmission"], atol=1e-4
    )
    assert "A.curvature" not in columns  # no path of A is drawn


@pytest.mark.parametrize("name", NUMBERS)
def test_a_number_of_a_motion_is_one_everywhere(
    name: str, mechanism: lw.Mechanism, motion: lw.Motion
) -> None:
    value = motion.value(name)
    family = mechanism.family({"O2 A": [38.0, 40.0]})
    # a path that turns back is halved there in a motion only
    rel = 1e-6 if name.startswith("path_length") else 1e-8
    assert family.sweep().value(name)[1] == pytest.approx(value, rel=rel)
    assert family.reduced([name])[name][1] == pytest.approx(value, rel=rel)
    with pytest.raises(UnknownNameError, match="is a number of a whole motion"):
        motion[name]


def test_studies_keep_and_reduce_all_of_them() -> None:
    plan = "\n".join(
        [
            'format = 1\nmechanism = "four-bar"\nsampling = "grid"',
            f"keep = {[*ROWS, 'B.velocity']}",
            '[dimensions]\n"O2 A" = [38, 40]\n[reductions]',
            *(f'n{k} = "{name}"' for k, name in enumerate(NUMBERS)),
            '[filters]\nwide = "time_ratio(rocker) >= 1.1"\nlong = "dwell(rocker, 1) > 30"',
        ]
    )
    study = read_plan_text(plan, columns=["rocker.d1"])
    assert study.job.keep == (*ROWS, "B.velocity", "rocker.d1")
    assert study.units["B.curvature"] == "1/mm"
    assert study.units["B.velocity"] == "mm/s"
    assert [study.units[f"n{k}"] for k in range(8)] == [
        "deg", "rad/rad", "deg", "deg", "", "mm", "deg", "deg",
    ]  # fmt: skip
    old = plan.replace('"stroke(rocker)"', '"rocker.stroke"')
    with pytest.raises(lw.MechanismFileError, match=r'\(write "stroke\(rocker\)"\)'):
        read_plan_text(old)


def test_evidence_and_vectors_are_columns_like_any_other(motion: lw.Motion) -> None:
    for name in EVIDENCE:
        np.testing.assert_array_equal(motion[name], getattr(motion, name))
    np.testing.assert_allclose(motion["B.velocity"], np.abs(motion.trace("B.velocity")))
    position = lw.example("four-bar").solve(50)
    assert position["residual"] == position.residual
    assert position["radius"] == position.certificate.radius
    assert position["B.velocity"] == pytest.approx(motion["B.velocity"][50], rel=1e-9)


def test_a_wrong_name_is_answered_with_three_names_and_the_command(motion: lw.Motion) -> None:
    with pytest.raises(UnknownNameError) as caught:
        motion["B.transmision"]
    known = "nearest: B.transmission, "
    assert str(caught.value).startswith(f'there is no "B.transmision" ({known}')
    assert str(caught.value).endswith("; all: linkwork quantities FILE)")
    assert str(caught.value).count(",") == 2
    for text in ("strok(rocker)", "stroke", "stroke(rocker", ""):
        with pytest.raises(InputError, match="linkwork quantities FILE"):
            motion.value(text)


def test_formulas_with_quantities_that_do_not_exist_are_refused(mechanism: lw.Mechanism) -> None:
    for formula, told in (
        ("A.transmission", 'column 1: there is no "A.transmission" (nearest: B.transmission'),
        ("1 + B.transmision", 'column 5: "B.transmision" is not defined'),
    ):
        with pytest.raises(MechanismError) as caught:
            lw.Mechanism(replace(mechanism.description, outputs={"q": formula}))
        assert told in str(caught.value)


def test_rates_by_time_follow_the_speed_of_each_design() -> None:
    family = lw.example("four-bar").family({"O2 A": [38.0, 40.0]}).sweep()
    assert family.speed is not None
    np.testing.assert_allclose(
        family["B.transmission.velocity"],
        family["B.transmission.d1"] * family.speed[:, None],
        rtol=1e-12,
    )


def test_motions_and_positions_travel_with_their_names(motion: lw.Motion) -> None:
    motion["B.curvature"]
    again = pickle.loads(pickle.dumps(motion))
    np.testing.assert_array_equal(again["B.transmission"], motion["B.transmission"])


def test_the_command_lists_every_name_within_80_columns(tmp_path: Path) -> None:
    from click.testing import CliRunner

    path = tmp_path / "four.toml"
    path.write_text(lw.example_text("four-bar"), encoding="utf-8")
    text = CliRunner().invoke(linkwork, ["quantities", str(path)]).output
    assert max(map(len, text.splitlines())) <= 80
    for name in [
        *ROWS,
        *EVIDENCE,
        "mu",
        "….d1",
        "stroke(…)",
        "path_length(POINT)",
        "dwell(…, BAND)",
    ]:
        assert any(line.split()[:1] == [name] or f" {name} " in line for line in text.splitlines())


def test_sweep_writes_only_the_columns_asked_for(tmp_path: Path, motion: lw.Motion) -> None:
    from click.testing import CliRunner

    path = tmp_path / "four.toml"
    path.write_text(lw.example_text("four-bar"), encoding="utf-8")
    words = ["--columns", "B.transmission", "--of", "B.velocity", "--columns", "stroke(rocker)"]
    run = CliRunner()
    found = run.invoke(linkwork, ["sweep", str(path), *words, "--csv", "-"]).output
    header, first, *_ = csv.reader(io.StringIO(found))
    assert header == ["crank", "B.transmission", "B.velocity", "status"]
    assert float(first[1]) == motion["B.transmission"][0]
    page = run.invoke(linkwork, ["sweep", str(path), *words]).output
    assert "  stroke(rocker)   73.78181965 deg\n" in page
    assert "B.transmission" in page
    assert run.invoke(linkwork, ["sweep", str(path), "--columns", "B.transmision"]).exit_code == 2


def test_a_workbook_has_them_beside_linkworks_values(
    mechanism: lw.Mechanism, motion: lw.Motion
) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = workbook_of(mechanism.model, motion, ["B.transmission", "B.curvature"])
    sheet = openpyxl.load_workbook(io.BytesIO(book.content))["Linkwork"]
    rows = list(sheet.iter_rows(values_only=True))
    heads = next(row for row in rows if "B.transmission" in row)
    k = heads.index("B.transmission")
    numbers = [row[k] for row in rows if isinstance(row[k], float)]
    np.testing.assert_allclose(numbers, motion["B.transmission"], rtol=1e-12)
    output = {**mechanism.description.outputs, "q": "B.transmission - 90"}
    derived = lw.Mechanism(replace(mechanism.description, outputs=output))
    notices = workbook_of(derived.model, derived.sweep()).notices
    assert any(note.startswith("q: values on the sheet Linkwork only") for note in notices)


def test_csv_of_all_columns_is_as_it_was(motion: lw.Motion) -> None:
    header = next(iter(csv_lines(motion.table())))
    assert "transmission" not in header
