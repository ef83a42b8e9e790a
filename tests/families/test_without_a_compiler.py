"""Families where Numba is not installed: the rows that compiled code finds."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.families import array_march, design_sweep, values
from linkwork.families.family_motion import FamilyMotion

VARIED = {
    "four-bar": {"O2 A": [35.0, 40.0, 42.5]},
    "slider-crank": {"O2 A": [39.0, 40.0]},
    "jansen-leg": {"O A": [14.9, 15.0]},
    "rapier-drive": {"a2": [249.0, 250.0]},
}


def swept(name: str, *, certify: bool = True) -> FamilyMotion:
    return lw.example(name).family(VARIED[name]).sweep(certify=certify)


def assert_same(found: FamilyMotion, expected: FamilyMotion) -> None:
    """Variables and, where an input has a speed, their velocities."""
    model = found.designs.base
    names = [v.name for v in model.equations.variables]
    velocities = [f"{name}.velocity" for name in names] if model.speed is not None else []
    assert len(names) > 2
    for name in names + velocities:
        one, other = found[name], expected[name]
        scale = max(1.0, float(np.nanmax(np.abs(other))))
        np.testing.assert_allclose(one, other, atol=1e-9 * scale, err_msg=name)


@pytest.mark.parametrize("name", list(VARIED))
@pytest.mark.parametrize("certify", [True, False])
def test_rows_are_those_of_compiled_code(
    name: str, certify: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = swept(name, certify=certify)
    filled: list[np.ndarray] = []
    own = array_march.fill

    def seen(*arguments: object) -> np.ndarray:
        filled.append(own(*arguments))  # type: ignore[arg-type]
        return filled[-1]

    monkeypatch.setattr(array_march, "fill", seen)
    for module in (design_sweep, values):
        monkeypatch.setattr(module, "has_compiler", lambda: False)
    found = swept(name, certify=certify)
    assert filled[0].all()
    np.testing.assert_array_equal(found.found, expected.found)
    np.testing.assert_array_equal(found.certified, expected.certified)
    assert found.certified.all() == certify
    assert_same(found, expected)


@pytest.mark.parametrize(
    "range_",
    [
        {"from_": 360, "to": 0, "step": -5},
        {"from_": 60, "to": 60, "step": None},  # one row, where the designs start
        {"from_": 60, "to": 75, "step": 0.5, "begin": 200},
    ],
)
def test_tables_of_any_order(range_: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    drive = lw.example("rapier-drive")
    (driven,) = drive.description.inputs
    drive = drive.changed(inputs=(replace(driven, **range_),))
    family = drive.family(VARIED["rapier-drive"])
    expected = family.sweep()
    for module in (design_sweep, values):
        monkeypatch.setattr(module, "has_compiler", lambda: False)
    found = family.sweep()
    assert found.certified.all()
    assert not found.rows.alone.any()
    assert_same(found, expected)


def test_designs_that_lock_are_swept_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    def rocker() -> FamilyMotion:
        bar = lw.example("four-bar").driven_by(link="rocker", relative_to="ground")
        return bar.family({"O2 A": [40, 42]}).sweep()

    expected = rocker()
    for module in (design_sweep, values):
        monkeypatch.setattr(module, "has_compiler", lambda: False)
    found = rocker()
    np.testing.assert_array_equal(found.found, expected.found)
    np.testing.assert_allclose(found.limits.lower, expected.limits.lower, rtol=1e-9)
    assert list(found.limits.lower_kind) == list(expected.limits.lower_kind)


def test_nothing_but_a_compiler_is_missing(tmp_path: Path) -> None:
    """Sweeps, circuits, families, a page and a task run where Numba cannot be imported."""
    script = tmp_path / "plain.py"
    script.write_text(
        "import sys\n"
        "for name in ('numba', 'llvmlite'):\n"
        "    sys.modules[name] = None\n"
        "import importlib.util as util\n"
        "find = util.find_spec\n"
        "util.find_spec = lambda name, package=None: (\n"
        "    None if name in ('numba', 'llvmlite', 'numba_cuda') else find(name, package))\n"
        "import linkwork as lw\n"
        "bar = lw.example('four-bar')\n"
        "print(bar.sweep().certified.all(), len(bar.circuits()))\n"
        "print(bar.family({'O2 A': [38, 40]}).sweep().certified.all())\n"
        "bar.write('bar.html')\n"
        "print(sys.modules['numba'])\n",
        encoding="utf-8",
    )
    done = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert done.stderr == ""
    assert done.stdout.split() == ["True", "2", "True", "None"]


def test_a_compiler_is_offered_once_where_it_pays(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(design_sweep, "has_compiler", lambda: False)
    monkeypatch.setattr(design_sweep, "_OFFERED", [])
    monkeypatch.setattr(design_sweep, "_LONG", float("inf"))
    swept("four-bar")
    assert not caplog.records
    monkeypatch.setattr(design_sweep, "_LONG", 0.0)
    for _ in range(2):
        swept("four-bar")
    (offer,) = caplog.records
    assert offer.getMessage().startswith("1,083 positions took ")
    assert 'pip install "linkwork[fast]"' in offer.getMessage()
