"""What plans mean, and what is said of those that mean nothing."""

# ruff: noqa: E501 - messages are as long as they are

from __future__ import annotations

import tomllib
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from linkwork.core.foundation.errors import InputError, MechanismFileError
from linkwork.core.results.quantities.registry import Call
from linkwork.core.textfile import schema_of, schema_text
from linkwork.families import Plan, from_table, grid, latin_hypercube, random
from linkwork.families.sampling import CHUNK, Distribution, Normal
from linkwork.families.study import read_plan, read_plan_text
from linkwork.families.study.plan import PLAN as FORM
from linkwork.families.study.study import (
    Comparison,
    Word,
    read_condition,
    read_distribution,
    usual_chunk,
    values_between,
)
from tests.families.study.plans import PLAN, edited, study

VALIDATOR = jsonschema.Draft202012Validator(schema_of(FORM))
HEAD = 'format = 1\nmechanism = "four-bar"\n'
NAMES = "names: {}, … 4 more"

WRONG = {
    "misspelt keys and wrong types": (
        """\
format = 1
mechanism = "four-bar"
sampling = "latin"
count = 0
keeep = ["B.x"]
[dimensions]
"O2 A" = "three"
"A B" = { from = 1, too = 2 }
"O4 B" = [1, "x"]
[input]
setp = 3
[filters]
x = 40
""",
        """\
8 problems in plan.toml
  line 3   sampling              must be "grid" or "random" or "latin-hypercube" or "table", got "latin"
  line 4   count                 must be a whole number of at least 1, got 0
  line 5   keeep                 is not a key of the file (keys: keep, format, name, mechanism, sampling, count, seed, table, … 8 more)
  line 7   dimensions."O2 A"     must be a number, a list of numbers, or a table such as { from = 36, to = 44 }, got "three"
  line 8   dimensions."A B".too  is not a key of [dimensions.A B] (keys: to, from, levels, likeliest, mean, deviation)
  line 9   dimensions."O4 B"[2]  must be a number, got "x"
  line 11  input.setp            is not a key of [input] (keys: step, from, to)
  line 13  filters.x             must be text in quotes, got 40""",
    ),
    "what does not go together": (
        """\
format = 1
mechanism = "four-bar"
sampling = "latin-hypercube"
table = "x.csv"
certify = false
[dimensions]
"O2 A" = { mean = 3, deviation = 2 }
"A B" = { from = 5, to = 2 }
[input]
step = -3
[reductions]
a = "range(mu)"
b = "mu"
[filters]
x = "mu => 40"
y = "mu >= forty"
z = "certified"
""",
        """\
11 problems in plan.toml
  line 1   count              is missing: sampling = "latin-hypercube" needs it
  line 1   seed               is missing: sampling = "latin-hypercube" needs it
  line 4   table              has no effect: random designs are drawn; leave it out
  line 7   dimensions."O2 A"  sampling = "latin-hypercube" needs a range: { from = 36, to = 44 }; got mean, deviation
  line 8   dimensions."A B"   from = 5 must not be larger than to = 2
  line 10  input.step         a step of -3 does not lead from 0 to 360
  line 12  reductions.a       there is no number "range" of a motion (nearest: mean, path_length, stroke; all: linkwork quantities FILE)
  line 13  reductions.b       must be a number of a whole motion, as in "stroke(rocker)", got "mu" (nearest: min, max, mean; all: linkwork quantities FILE)
  line 15  filters.x          must be "whole cycle", "no dead point", "certified" or a comparison such as "mu >= 40" or "stroke(rocker) <= 60", got "mu => 40"
  line 16  filters.y          "forty" in "mu >= forty" must be a number, as in "mu >= 40"
  line 17  filters.z          no design passes it with certify = false: leave one of them out""",
    ),
    "quantities that do not exist, and names that are taken": (
        """\
format = 1
mechanism = "four-bar"
sampling = "random"
count = 10
seed = 1
keep = ["B.z", "crank", "B.x", "B.x"]
[dimensions]
"O2 A" = { mean = 3, deviation = 2 }
[reductions]
"B.x" = "min(B.x)"
passed = "min(mu)"
a = "min(mew)"
"x/y" = "min(mu)"
"zarr.json" = "min(mu)"
".x" = "min(mu)"
[filters]
x = "mew <= 40"
""",
        """\
10 problems in plan.toml
  line 6   keep[1]                 there is no "B.z" (nearest: B.y, B.x, B.centre.y; all: linkwork quantities FILE)
  line 6   keep[2]                 "crank" is an input, the same for every design: leave it out
  line 6   keep[4]                 "B.x" is already the name of keep[3]: leave it out or rename it
  line 10  reductions."B.x"        "B.x" is already the name of keep[3]: leave it out or rename it
  line 11  reductions.passed       "passed" is already an array of every study: leave it out or rename it
  line 12  reductions.a            there is no "mew" (nearest: mu, unique_within, rocker; all: linkwork quantities FILE)
  line 13  reductions."x/y"        "x/y" cannot name an array: up to 80 letters, without / \\ : *
  line 14  reductions."zarr.json"  "zarr.json" is already an array of every study: leave it out or rename it
  line 15  reductions.".x"         ".x" cannot name an array: begin with a letter
  line 17  filters.x               there is no "mew" (nearest: mu, unique_within, rocker; all: linkwork quantities FILE)""",
    ),
    "numbers of the mechanism that are called like an array of the store": (
        'format = 1\nmechanism = "circle.toml"\nsampling = "grid"\n'
        "[dimensions]\npassed = [1, 2]\nfound = [0, 1]\n",
        """\
3 problems in plan.toml
  line 2  mechanism          "found" is already an array of every study: leave it out or rename it
  line 5  dimensions.passed  "passed" is already an array of every study: leave it out or rename it
  line 6  dimensions.found   "found" is already an input, which every row has: leave it out or rename it""",
    ),
    "a mechanism that the library lacks": (
        edited(('"four-bar"', '"four-ber"')),
        """\
1 problem in plan.toml
  line 3  mechanism  there is no "four-ber" (library: four-bar, double-four-bar, ackermann-steering, andrews-squeezer, antiparallelogram, atkinson-engine, balanced-lamp, beam-engine, … 85 more); the name of a file ends in .toml""",
    ),
    "a dimension that the mechanism lacks": (
        edited(('"O2 A"', '"O2 X"')),
        """\
1 problem in plan.toml
  line 10  dimensions."O2 X"  "O2 X" is not a number of Four-bar linkage, open that can vary (numbers: O2 A, O2 O4, A B, O4 B, O2.x, O2.y, A.x, A.y, … 4 more)""",
    ),
    "one number given twice": (
        edited(('"A B"', '"A O2"')),
        """\
1 problem in plan.toml
  line 9  dimensions  "O2 A" and "A O2" are the same number: give it once""",
    ),
    "nothing that varies": (
        HEAD + 'sampling = "grid"\n[dimensions]\n"O2 A" = 40\n',
        """\
1 problem in plan.toml
  line 4  dimensions  is empty: give values: [40, 50, 60] or { from = 40, to = 60, levels = 3 }""",
    ),
    "a grid with a count": (
        HEAD + 'sampling = "grid"\ncount = 3\n[dimensions]\n"O2 A" = { from = 1, to = 2 }\n',
        """\
2 problems in plan.toml
  line 4  count              has no effect: a grid is every combination of its values; leave it out
  line 6  dimensions."O2 A"  sampling = "grid" needs values: [40, 50, 60] or { from = 40, to = 60, levels = 3 }; got from, to""",
    ),
    "a table that is not there": (
        HEAD + 'sampling = "table"\ntable = "none.csv"\n',
        """\
1 problem in plan.toml
  line 4  table  none.csv cannot be read: No such file or directory""",
    ),
    "a plan of the future": (
        "format = 2\n",
        """\
1 problem in plan.toml
  line 1  format  is 2, this version of Linkwork reads format = 1: update Linkwork""",
    ),
    "a mechanism without an input": (
        edited(('"four-bar"', '"sums.toml"')),
        """\
1 problem in plan.toml
  line 3  mechanism  has no input: a study goes through a table of input values""",
    ),
}


@pytest.mark.parametrize("title", WRONG)
def test_a_wrong_plan_is_refused_with_its_whole_message(
    title: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sums.toml").write_text(
        'format = 1\n[equations]\nf = "x^2 - 2 = 0"\n[guess]\nx = 1\n', encoding="utf-8"
    )
    (tmp_path / "circle.toml").write_text(
        'format = 1\n[loops]\n1 = "passed*e^(i*found) = x + i*y"\n[dimensions]\npassed = 2\n'
        "[guess]\nfound = 30\nx = 1\ny = 1\n"
        '[input]\nvariable = "found"\nfrom = 0\nto = 360\nstep = 30\n',
        encoding="utf-8",
    )
    monkeypatch.chdir(tmp_path)
    text, message = WRONG[title]
    with pytest.raises(MechanismFileError) as caught:
        read_plan_text(text, "plan.toml")
    assert str(caught.value) == message


def test_problems_of_the_mechanism_are_said_with_its_own_lines(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("format = 1\npoint = 3\n", encoding="utf-8")
    (tmp_path / "plan.toml").write_text(edited(('"four-bar"', '"mine.toml"')), encoding="utf-8")
    with pytest.raises(MechanismFileError) as caught:
        read_plan(tmp_path / "plan.toml")
    assert str(caught.value).startswith(f"3 problems in {tmp_path / 'mine.toml'}\n")
    assert [(p.key, p.line) for p in caught.value.problems][-1] == (("point",), 2)


def test_the_published_schema_is_that_of_the_reader() -> None:
    published = files("linkwork.families.study").joinpath("plan.schema.json")
    assert published.read_text(encoding="utf-8") == schema_text(schema_of(FORM))
    jsonschema.Draft202012Validator.check_schema(schema_of(FORM))


def test_the_schema_accepts_plans_and_refuses_wrong_structure() -> None:
    VALIDATOR.validate(tomllib.loads(PLAN))
    title = "misspelt keys and wrong types"
    found = {
        tuple(error.absolute_path)[:2]
        for error in VALIDATOR.iter_errors(tomllib.loads(WRONG[title][0]))
    }
    assert found == {
        (), ("sampling",), ("count",), ("dimensions", "O2 A"), ("dimensions", "A B"),
        ("dimensions", "O4 B"), ("input",), ("filters", "x"),
    }  # fmt: skip


def _drawn(entry: object) -> Distribution:
    distribution = read_distribution(entry)
    assert distribution is not None
    return distribution


DIMENSIONS: dict[str, tuple[str, str, Callable[[], Plan]]] = {
    "grid": (
        '"O2 A" = [40, 38]\n"A B" = { from = 110, to = 130, levels = 3 }\n"O4 B" = 81\n',
        "",
        lambda: grid({"O2 A": [40, 38], "A B": [110, 120, 130]}),
    ),
    "random": (
        '"O2 A" = { mean = 40, deviation = 0.1 }\n"A B" = { from = 110, to = 130 }\n'
        '"A.x" = [30, 34]\n"A.y" = { from = 10, to = 30, likeliest = 20 }\n"O4 B" = 81\n',
        "count = 70000\nseed = 3\n",
        lambda: random(
            70_000,
            {
                "O2 A": Normal(40, 0.1),
                "A B": (110, 130),
                "A.x": _drawn([30.0, 34.0]),
                "A.y": _drawn({"from": 10, "likeliest": 20, "to": 30}),
            },
            3,
        ),
    ),
    "latin-hypercube": (
        '"O2 A" = { from = 39, to = 41 }\n"O4 B" = 81\n',
        "count = 70000\nseed = 3\n",
        lambda: latin_hypercube(70_000, {"O2 A": (39, 41)}, 3),
    ),
    "table": (
        '"O4 B" = 81\n',
        'table = "designs.csv"\ncolumns = ["O2 A", "A B"]\n',
        lambda: from_table({"O2 A": [40.0, 41.0], "A B": [120.0, 121.0]}),
    ),
}


@pytest.mark.parametrize("sampling", DIMENSIONS)
def test_designs_are_those_of_the_plans_of_families(sampling: str, tmp_path: Path) -> None:
    (tmp_path / "designs.csv").write_text("O2 A,note,A B\n40,1,120\n41,2,121\n", encoding="utf-8")
    dimensions, head, wanted = DIMENSIONS[sampling]
    text = f'{HEAD}sampling = "{sampling}"\nchunk = 30000\n{head}[dimensions]\n{dimensions}'
    found, plan = read_plan_text(text, "plan.toml", tmp_path), wanted()
    assert found.constants == {"O4 B": 81}
    assert list(found.plan) == list(plan)
    for name in plan:
        parts = np.concatenate([found.varied(k)[name] for k in range(found.chunks)])
        np.testing.assert_array_equal(parts, plan[name])


def test_values_are_cut_out_of_the_chunks_of_a_plan_wherever_they_lie() -> None:
    plan = random(3 * CHUNK, {"a": (0, 1)}, 5)
    whole = plan["a"]
    for start, stop in ((0, 3), (CHUNK - 2, CHUNK + 2), (CHUNK, 2 * CHUNK), (5, 3 * CHUNK)):
        np.testing.assert_array_equal(values_between(plan, start, stop)["a"], whole[start:stop])


def test_draws_stay_within_what_was_asked() -> None:
    generator = np.random.default_rng(1)
    choice = read_distribution([1.0, 4.0])
    triangle = read_distribution({"from": 1, "likeliest": 2, "to": 5})
    assert choice is not None
    assert triangle is not None
    assert set(choice(generator, 100)) == {1.0, 4.0}
    drawn = triangle(generator, 100_000)
    assert drawn.min() >= 1
    assert drawn.max() <= 5
    assert drawn.mean() == pytest.approx(8 / 3, abs=0.02)  # (1 + 2 + 5) / 3; sigma 0.85 / √n
    with pytest.raises(InputError, match="a triangle needs from <= likeliest <= to"):
        read_distribution({"from": 1, "likeliest": 6, "to": 5})


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("mu >= 40", Comparison(Call("min", "mu"), ">=", 40.0)),
        ("mu<140.5", Comparison(Call("max", "mu"), "<", 140.5)),
        (" stroke( B.x ) <= -1e3 ", Comparison(Call("stroke", "B.x"), "<=", -1000.0)),
        ("max(stick-boom) > 1", Comparison(Call("max", "stick-boom"), ">", 1.0)),
        ("whole   cycle", Word("whole cycle")),
    ],
)
def test_conditions_are_read(text: str, read: object) -> None:
    assert read_condition(text) == read


@pytest.mark.parametrize(
    "text",
    ["", "mu", "mu = 40", "mu == 40", "40 <= mu <= 140", "mu >= nan", "mu >= inf", "mu >= 2*20",
     "min(max(mu)) >= 4", "__import__('os') >= 1", "whole cycles"],
)  # fmt: skip
def test_what_is_no_condition_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        read_condition(text)


def test_a_chunk_fits_into_memory_and_leaves_work_for_several_workers() -> None:
    assert usual_chunk(10**6, 100, 6) == 8192  # 64 MiB of six numbers at 100 rows
    assert usual_chunk(10**6, 1, 6) == 16384
    assert usual_chunk(50_000, 1, 6) == 2048  # a 16th of the designs
    assert usual_chunk(10, 1, 6) == 2048
    assert usual_chunk(10**6, 10**7, 60) == 1


def test_a_small_study_is_one_chunk() -> None:
    assert study(("chunk = 64", "")).chunk_size == 300
    assert repr(study()) == (
        '<Study "A small study" of "Four-bar linkage, open": 300 designs × 12 inputs in 5 chunks>'
    )
