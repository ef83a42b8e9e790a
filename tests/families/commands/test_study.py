"""The command ``study``: its page, its line of progress, its refusals."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.core.commands.conftest import Run
from tests.families.study.plans import PLAN, edited

NEEDS = "a study needs a plan and a store:\n    linkwork study plan.toml -o out.zarr"
PAGE = """\
A small study
Four-bar linkage, open: 300 designs × 12 inputs in out.zarr
  computed      300
  cycle         292 (97.33 %)  whole cycle
  transmission  157 (52.33 %)  min(mu) >= 25
  passed        157 (52.33 %)

  rows
  found         3,592
  out of reach      8
  certified     3,592

  of designs that passed  minimum      mean   maximum  unit
  swing                   56.6204   70.3587   88.1451  deg
  mu_mean                 52.7058   61.1892   68.0350  deg
  B.x                     32.5994   85.1601  150.154   mm
  rocker                  49.0665  101.299   138.877   deg

  swing [deg]
     from  count
  56.6204      5  ############
  59.2474     10  ########################
  61.8745     13  ###############################
  64.5016     26  ##############################################################
  67.1286     25  ############################################################
  69.7557     23  #######################################################
  72.3828     18  ###########################################
  75.0098     13  ###############################
  77.6369     10  ########################
  80.2639      6  ###############
  82.8910      7  #################
  85.5181      1  ###

  mu_mean [deg]
     from  count
  52.7058      2  #####
  53.9833      3  #######
  55.2607      9  ####################
  56.5381     13  #############################
  57.8155     12  ###########################
  59.0930     19  ###########################################
  60.3704     25  ########################################################
  61.6478     28  ##############################################################
  62.9253     13  #############################
  64.2027     20  #############################################
  65.4801      9  ####################
  66.7575      4  #########

"""


@pytest.fixture(autouse=True)
def plan(folder: Path) -> None:
    (folder / "plan.toml").write_text(PLAN, encoding="utf-8")


def test_the_page_of_a_study(run: Run) -> None:
    done = run("study", "plan.toml", "-o", "out.zarr", "--workers", "1")
    assert done.exit_code == 0
    assert done.stderr == ""
    assert done.stdout[: len(PAGE)] == PAGE
    assert run("study", "--summary", "out.zarr").stdout == done.stdout
    assert max(map(len, done.stdout.split("\n"))) <= 80


def test_the_page_of_designs_that_cannot_be_built(run: Run, folder: Path) -> None:
    text = edited(
        ("latin-hypercube", "random"), ('"O4 B" = { from = 66, to = 90 }', '"O4 B" = [80, -10]')
    )
    (folder / "plan.toml").write_text(text, encoding="utf-8")
    done = run("study", "plan.toml", "-o", "out.zarr", "--workers", "1")
    assert done.stdout.split("\n")[2:7] == [
        "  computed      300",
        "  not built     158",
        '                158: 1 problem in mechanism "Four-bar linkage, open"',
        """                lengths."O4 B"  must be a positive length, got …""",
        "  cycle         142 (47.33 %)  whole cycle",
    ]


def test_a_summary_as_json(run: Run) -> None:
    run("study", "plan.toml", "-o", "out.zarr", "--workers", "1")
    data = json.loads(run("study", "--summary", "out.zarr", "--json").stdout)
    assert data["designs"] == data["computed"] == 300
    assert [output["name"] for output in data["outputs"]] == ["swing", "mu_mean", "B.x", "rocker"]
    assert data["filters"]["transmission"][0] == "min(mu) >= 25"


def test_a_plan_from_standard_input(run: Run) -> None:
    done = run("study", "-", "-o", "out.zarr", "--workers", "1", stdin=PLAN)
    assert done.stdout.startswith("A small study\n")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), NEEDS),
        (("plan.toml",), NEEDS),
        (
            ("plan.toml", "--summary", "x"),
            "--summary reads a store: leave out the plan and -o",
        ),
        (("--summary", "x.zarr"), 'there is no "x.zarr"'),
        (
            ("--summary", "plan.toml"),
            '"plan.toml" exists and is not the store of a study: choose another name',
        ),
        (("plan.toml", "-o", "no/x.zarr"), 'cannot write "no/x.zarr": there is no folder "no"'),
        (
            ("plan.toml", "-o", "x.zarr", "--workers", "0"),
            "workers must be a whole number, 1 or more, got 0",
        ),
    ],
)
def test_what_cannot_be_done_is_said(words: tuple[str, ...], message: str, run: Run) -> None:
    done = run("study", *words)
    assert (done.exit_code, done.stdout, done.stderr) == (2, "", f"Error: {message}\n")


def test_the_schema_of_plans_is_printed(run: Run) -> None:
    schema = json.loads(run("schema", "--plan").stdout)
    assert schema["title"] == "Linkwork study-plan file"
    assert "filters" in schema["properties"]


_WITHOUT_ZARR = """
import importlib.util, sys
real = importlib.util.find_spec
importlib.util.find_spec = lambda name: None if name == "zarr" else real(name)
from click.testing import CliRunner
from linkwork.core.commands.main import linkwork
done = CliRunner().invoke(linkwork, sys.argv[1:])
print(done.output, done.exit_code, "numba" in sys.modules)
"""


@pytest.mark.parametrize(
    "arguments",
    [
        ("study", "plan.toml", "-o", "out.zarr"),
        ("study", "--summary", "out.zarr"),
        ("atlas", "--index", "out.zarr", "-o", "out.npz"),
    ],
)
def test_a_missing_package_of_stores_is_told_before_kernels_are_loaded(
    arguments: tuple[str, ...], tmp_path: Path
) -> None:
    command = [sys.executable, "-c", _WITHOUT_ZARR, *arguments]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment)
    assert done.stdout == (
        'Error: studies are stored by zarr and xarray: pip install "linkwork[study]"\n 2 False\n'
    )
