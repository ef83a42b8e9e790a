"""The sheets of forces of a workbook come to Linkwork's efforts and reactions, and follow edits."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage
from tests.described import described_as
from tests.forces.random_loads import loaded
from tests.oracles.spreadsheet import Spreadsheet
from tests.writers.coarse import coarse

_NEAR = 1e-9  # relative to the largest value: rows solved by other iterations


def written(tmp_path: Path, mechanism: Any) -> Spreadsheet:
    path = tmp_path / "forces.xlsx"
    mechanism.write(path, motion=mechanism.sweep(certify=False))
    return Spreadsheet(path)


def reactions(sheet: Spreadsheet) -> tuple[dict[str, float], list[float]]:
    """The values of the reactions by name, and the sums of all free bodies."""
    cells = sheet.book["Equilibrium"]
    found: dict[str, float] = {}
    sums: list[float] = []
    part = ""
    for row in range(1, cells.max_row + 1):
        name = cells.cell(row, 1).value
        if name in ("reaction", "sum") or str(name).startswith("free body"):
            part = str(name)
        elif part == "reaction" and name and not str(name).endswith("virtual work"):
            found[str(name)] = float(sheet["Equilibrium", f"B{row}"])
        if name == "sum":
            sums += [float(sheet["Equilibrium", f"{column}{row}"]) for column in "BCD"]
    return found, sums


def belts_of(mechanism: lw.Mechanism) -> tuple[lw.Belt, ...]:
    return described_as(Linkage, mechanism).belts


def check(sheet: Spreadsheet, mechanism: lw.Mechanism) -> None:
    """Efforts of all rows, and all reactions of the selected one."""
    motion = mechanism.sweep(certify=False)
    forces = mechanism.forces(motion=motion)
    # the efforts of a balanced mechanism are differences of larger numbers
    loads = [np.abs(v).max() for name, v in forces.values.items() if ".load." in name]
    for effort in forces.efforts:
        wanted = np.asarray(forces[effort])
        found = np.array(sheet.column("Forces", effort), dtype=float)
        size = max([np.abs(wanted).max(), *loads])
        assert found == pytest.approx(wanted, rel=0, abs=_NEAR * size), effort
    row = int(sheet["Equilibrium", "B3"]) - 1
    by_name, sums = reactions(sheet)
    # every pin, guide, contact and weld, and the efforts; a belt has its pull, of which both
    # tensions are read, and the first link of a pin of three is a sum
    own = [name for name in forces.values if name in by_name]
    assert {part for part in by_name if part not in own} <= {
        f"{belt.name}.{word}" for belt in belts_of(mechanism) for word in ("pull", "mean")
    }
    assert set(forces.efforts) < set(own)
    largest = max(abs(by_name[name]) for name in own)
    for name in own:
        value = float(np.asarray(forces[name])[row])
        assert by_name[name] == pytest.approx(value, rel=0, abs=_NEAR * largest), name
    assert sums == pytest.approx([0.0] * len(sums), abs=_NEAR * largest * 100)


#: Loads of their own, sliders, slots, welds; teeth, strands, wheels; inputs of every kind.
NAMES = (
    "crank-press", "balanced-lamp", "scotch-yoke", "geared-five-bar", "crossed-belt",
    "rack-and-pinion", "landing-gear", "five-bar-robot",
)  # fmt: skip
MORE = (
    "four-bar", "whitworth", "elliptic-trammel", "cardan-circles", "belt-drive", "planetary-gear",
    "rack-steering", "rolling-inside", "rolling-wheel", "sun-and-planet", "scissor-lift",
    "double-pendulum", "excavator", "kempe-translator", "planetary-differential", "three-rpr",
)  # fmt: skip


@pytest.mark.parametrize(
    "name", [*NAMES, *(pytest.param(name, marks=pytest.mark.extended) for name in MORE)]
)
def test_forces_are_linkworks(name: str, tmp_path: Path) -> None:
    mechanism = lw.example(name)
    if not described_as(Linkage, mechanism).loaded:
        mechanism = loaded(mechanism, seed=3)
    mechanism = coarse(mechanism, 3)
    check(written(tmp_path, mechanism), mechanism)


def test_forces_follow_a_changed_mass_load_and_dimension(tmp_path: Path) -> None:
    press = coarse(lw.example("crank-press"), 8)
    sheet = written(tmp_path, press)
    sheet.set("mass_rod", 21.0)
    sheet.set("gravity_y", -1620.0)
    sheet.set("oa", 66.0)
    masses = dict(described_as(Linkage, press).masses)
    masses["rod"] = replace(masses["rod"], mass=21.0)
    changed = press.changed(masses=masses, gravity=lw.Gravity(size=1620)).with_dimensions(
        {"O A": 66.0}
    )
    check(sheet, changed)


def test_forces_follow_a_changed_pressure_angle(tmp_path: Path) -> None:
    five_bar = coarse(loaded(lw.example("geared-five-bar"), seed=5), 3)
    (gear,) = described_as(Linkage, five_bar).gears
    sheet = written(tmp_path, five_bar)
    sheet.set(f"{gear.name}_pressure", 27.0)
    check(sheet, five_bar.changed(gears=[replace(gear, pressure_angle=27)]))


def test_strands_follow_a_changed_pretension(tmp_path: Path) -> None:
    drive = coarse(loaded(lw.example("belt-drive"), seed=5), 3)
    (belt,) = belts_of(drive)
    drive = drive.changed(belts=[replace(belt, pretension=40)])
    sheet = written(tmp_path, drive)
    check(sheet, drive)
    sheet.set(f"{belt.name}_pretension", 90.0)
    check(sheet, drive.changed(belts=[replace(belt, pretension=90)]))


def test_each_of_several_inputs_follows_a_changed_mass(tmp_path: Path) -> None:
    robot = coarse(loaded(lw.example("five-bar-robot"), seed=5), 3)
    masses = dict(described_as(Linkage, robot).masses)
    link = next(iter(masses))
    sheet = written(tmp_path, robot)
    sheet.set(f"mass_{link}", 7.0)
    check(sheet, robot.changed(masses={**masses, link: replace(masses[link], mass=7.0)}))


@pytest.mark.parametrize(
    ("name", "part"), [("eccentric-cam", "disc (cam)"), ("hoist", "winding (linear coupling)")]
)
def test_a_mechanism_whose_forces_have_no_cells_says_so(
    name: str, part: str, tmp_path: Path
) -> None:
    mechanism = coarse(loaded(lw.example(name)), 3)
    path = tmp_path / "forces.xlsx"
    mechanism.write(path, motion=mechanism.sweep(certify=False))
    sheet = Spreadsheet(path)
    assert "Forces" not in sheet.book.sheetnames
    texts = [str(cell.value) for row in sheet.book["About"].iter_rows() for cell in row]
    message = f"no sheets of forces: the forces of {part} have no cells"
    assert any(message in text for text in texts)


@pytest.mark.parametrize("links", [("ground", "rocker"), ("coupler", "crank")])
def test_torsion_springs_have_cells(links: tuple[str, str], tmp_path: Path) -> None:
    spring = lw.Spring(name="torsion", links=links, stiffness=9000, free=40, damping=80)
    mechanism = coarse(loaded(lw.example("four-bar"), seed=2), 3).changed(springs=[spring])
    sheet = written(tmp_path, mechanism)
    check(sheet, mechanism)
    stiffer = mechanism.changed(springs=[replace(spring, stiffness=12000)])
    sheet.set("torsion_stiffness", 12000.0)
    check(sheet, stiffer)
