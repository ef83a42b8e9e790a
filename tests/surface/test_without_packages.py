"""Linkwork without Numba, Matplotlib, networkx, rich and click, as in a browser."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

_WORK = """
import json, sys
from pathlib import Path

blocked = set(sys.argv[1].split())


class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in blocked:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


sys.meta_path.insert(0, Missing())
import linkwork as lw
from linkwork import example_text
from linkwork.synthesis.solvers.solving import solve_task
from linkwork.app.live.session import BrowserDesk

said, told = {}, []
for name in ("four-bar", "jansen-leg", "rapier-drive"):
    mechanism = lw.example(name)
    motion = mechanism.sweep()
    position = mechanism.solve()
    said[name] = [
        list(map(str, motion.status)),
        list(map(str, motion.certification)),
        {point: motion.trace(point).view(float).tolist() for point in motion.points},
        {point: list(place) for point, place in position.points.items()},
        repr(mechanism.circuits()),
        repr(mechanism.configurations()),
        repr(mechanism.scene()),
        mechanism.check().start_message,
    ]
deviations = {"A B": 0.1}
four_bar = lw.example("four-bar")
said["tolerance"] = repr(lw.design.tolerance(four_bar, "rocker", 60, deviations=deviations))
desk = BrowserDesk(lw.loads, example_text, told.append, list, solve_task)
desk.begin("#example=jansen-leg")
said["events"] = told
family = lw.example("four-bar").family({"O2 A": [38.0, 40.0]}).sweep()
said["family"] = family.certified.tolist()
said["unclassified"] = lw.example("four-bar").check().unclassified
failed = []
for work in blocked and (lambda: lw.circuits.inversions(lw.example("four-bar")),
                         lambda: lw.example("four-bar").draw("x.png")):
    try:
        work()
    except lw.MissingPackageError as error:
        failed.append(str(error))
said["failed"] = failed
print(json.dumps(said, default=str))
"""


def _said(blocked: str, folder: Path) -> dict[str, Any]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-W", "error", "-c", _WORK, blocked]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, env=environment)
    assert done.returncode == 0, done.stderr
    said: dict[str, Any] = json.loads(done.stdout)
    return said


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], dict[str, Any]]:
    """What is said with all packages, and without those that a browser lacks."""
    blocked = "numba llvmlite matplotlib networkx rich click"
    folders = [tmp_path_factory.mktemp(name) for name in ("all", "few")]
    return _said("", folders[0]), _said(blocked, folders[1])


def test_numbers_statuses_and_certificates_are_the_same(
    said: tuple[dict[str, Any], dict[str, Any]],
) -> None:
    every, few = said
    for name in ("four-bar", "jansen-leg", "rapier-drive", "tolerance", "events", "family"):
        assert few[name] == every[name]


def test_what_needs_a_missing_package_names_it(said: tuple[dict[str, Any], dict[str, Any]]) -> None:
    _, few = said
    assert few["failed"] == [
        "names of kinematic chains need networkx: pip install networkx",
        "drawing needs Matplotlib: pip install matplotlib",
    ]


def test_without_networkx_a_chain_has_no_name(said: tuple[dict[str, Any], dict[str, Any]]) -> None:
    every, few = said
    assert every["unclassified"] == ""
    assert few["unclassified"].startswith("names of kinematic chains need networkx")
