"""``linkwork configurations``, and choosing one of them for solve and sweep."""

from __future__ import annotations

import json

import linkwork as lw
from linkwork.circuits.circuit_list import path_sentence
from linkwork.circuits.results import PathCount
from tests.core.commands.conftest import Run

FOUR_BAR_LISTED = """\
Four-bar
2 configurations at crank = 60 deg

  name     coupler [deg]  rocker [deg]  certified
  open         18.376018     64.943481  yes
  crossed     -65.202467   -111.769930  yes

  complete  the list is proved complete: the number of certified solutions
            equals the largest possible number
  paths     2 complex solutions, 2 of them real
"""

SIX_LINK = """\
6 configurations at θ12 = 60 deg

  name              θ14 [deg]   θ15 [deg]   s4 [mm]  s6 [mm]  certified
  configuration 1    0.638262   43.789160  -502.693  1252.62  yes
"""


def test_one_row_per_configuration_then_completeness_and_paths(run: Run) -> None:
    done = run("configurations", "four-bar.toml", "--at", "60")
    assert (done.exit_code, done.stdout, done.stderr) == (0, FOUR_BAR_LISTED, "")
    run("examples", "coupled-six-link", "-o", "six.toml")
    assert SIX_LINK in run("configurations", "six.toml").stdout


def test_paths_of_every_block_are_accounted_for(run: Run) -> None:
    run("examples", "andrews-squeezer", "-o", "seven.toml")
    text = run("configurations", "seven.toml").stdout
    assert "paths     Θ, γ: 2 complex solutions, 2 of them real\n" in text
    counted = "Φ, δ: 4 complex solutions, 2 of them real, for 2 positions of\n"
    assert counted + "            earlier blocks\n" in text


def test_what_became_of_paths_in_words() -> None:
    count = PathCount(
        unknowns=("a",), paths=20, finite=11, real=3, at_infinity=4, multiple=4, failed=1
    )
    said = path_sentence(count, several=False)
    assert said == (
        "15 complex solutions, 3 of them real, 4 multiple; 20 paths: 4 to infinity, 1 lost"
    )
    given = PathCount(unknowns=("a", "b"), solved=2, finite=2, real=2)
    assert path_sentence(given, several=True) == "a, b: follow from the others"


def test_json_has_positions_completeness_paths_and_seed(run: Run) -> None:
    done = run("configurations", "four-bar.toml", "--at", "60", "--json")
    data = json.loads(done.stdout)
    assert data["schema"] == 1
    assert [p["configuration"] for p in data["configurations"]] == ["open", "crossed"]
    assert all(p["certificate"]["certified"] for p in data["configurations"])
    assert (data["completeness"], data["complete"]) == ("PROVED", True)
    assert data["message"] == lw.Completeness.PROVED.value
    (paths,) = data["paths"]
    assert (paths["unknowns"], paths["paths"], paths["real"]) == (["coupler", "rocker"], 2, 2)
    assert data["seed"] > 0
    assert data["input"] == {"crank": 60.0}


def test_no_configuration_ends_with_one(run: Run) -> None:
    done = run("configurations", "open.toml")
    assert done.exit_code == 1
    assert "\nNo configurations at crank = 29.7448813 deg\n" in done.stdout
    assert "2 complex solutions, 0 of them real" in done.stdout


def test_equations_that_are_not_loops_have_no_list(run: Run) -> None:
    done = run("configurations", "cubic.toml")
    assert done.exit_code == 1
    assert "the equations of x are plain equations, not loops" in " ".join(done.stdout.split())


def test_changed_dimensions_and_several_inputs(run: Run) -> None:
    changed = run("configurations", "four-bar.toml", "--at", "60", "--set", "a=45").stdout
    assert changed != FOUR_BAR_LISTED
    done = run("configurations", "five-bar.toml", "--at", "left=90", "--at", "right=90")
    assert done.exit_code == 0
    assert "2 configurations at left = 90 deg, right = 90 deg\n" in done.stdout


def test_solve_and_sweep_take_a_name(run: Run) -> None:
    done = run("solve", "four-bar.toml", "--at", "60", "--configuration", "crossed")
    assert done.exit_code == 0
    assert "rocker   -111.769930 deg" in done.stdout
    assert "certificate  true position within " in done.stdout
    swept = run("sweep", "four-bar.toml", "--configuration", "crossed", "--step", "10", "--json")
    rocker = json.loads(swept.stdout)["columns"]["rocker"]
    assert abs(rocker[6] + 111.769930) < 1e-6


def test_names_that_do_not_exist_are_wrong_input(run: Run) -> None:
    for command in ("solve", "sweep"):
        done = run(command, "four-bar.toml", "--configuration", "cross")
        assert done.exit_code == 2
        assert 'there is no configuration "cross" of Four-bar' in " ".join(done.stderr.split())
        assert "(configurations: crossed, open)" in " ".join(done.stderr.split())


def test_steps_from_the_guess_and_a_configuration_exclude_each_other(run: Run) -> None:
    for option in ("--from-guess", "--show-steps"):
        done = run("solve", "four-bar.toml", "--configuration", "open", option)
        assert done.exit_code == 2
        assert "leave out --from-guess and --show-steps" in " ".join(done.stderr.split())
