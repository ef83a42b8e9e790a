"""The script that counts what makes the source hard to carry on, over made-up packages."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest

from scripts.house import HERE, main, measure, report
from scripts.house_ideas import (
    arithmetic,
    containers,
    files_of_a_part,
    files_of_a_quantity,
    lists_of_parts,
    loop_counts,
    roundoffs,
    tolerances,
)
from scripts.house_source import (
    Count,
    Source,
    circles,
    comment_share,
    long_files,
    long_functions,
    read,
)

PARTS = {"Gear": "gears", "Rack": "racks", "Cam": "cams"}


def source(text: str, path: str = "a.py") -> Source:
    return Source(Path(path), text)


def package(folder: Path, files: dict[str, str]) -> Path:
    """A package on disk, with an ``__init__`` in every folder."""
    root = folder / "made"
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        for above in (path.parent, *path.parent.parents):
            if above.is_relative_to(root):
                (above / "__init__.py").touch()
        path.write_text(text, encoding="utf-8")
    return root


# ------------------------------------------------------------------ lines


def test_docstrings_comments_and_blank_lines_are_no_code() -> None:
    text = (
        '"""Said.\n\nMore.\n"""\n\n# why\nx = (\n    1  # one\n)\n\n\n'
        'def f():\n    """Do."""\n    return """\n    a text"""\n'
    )
    assert source(text).code == 6
    assert source('x = 1\n"""no docstring, for it comes second"""\n').code == 2
    assert source("1\nx = 1\n").code == 2


def test_comments_are_counted_against_lines_of_code() -> None:
    assert comment_share([source("# why\nx = 1\ny = 2  # and\nz = '# no'\nw = 3\n")]).value == 50.0


def test_a_long_file_needs_a_reason_at_its_head() -> None:
    body = "x = 1\n" * 9
    assert long_files([source(body)], 9).value == 0
    assert long_files([source("\n" + body)], 9).where == ("a.py: 10",)
    assert long_files([source('"""Said."""\n# long: a table\n' + body)], 9).value == 0
    assert long_files([source(body + "# long: too late\n")], 9).value == 1


def test_a_long_function_needs_a_reason_beside_it() -> None:
    body = "    x = 1\n" * 5
    assert long_functions([source("def f():\n" + body)], 6).value == 0
    assert long_functions([source("def f():\n" + body)], 5).where == ("a.py:1 f: 6",)
    assert long_functions([source('def f():\n    """Do.\n    More."""\n' + body)], 6).value == 0
    assert long_functions([source("@d\ndef f():\n" + body)], 5).value == 1
    assert long_functions([source("# long: one formula\n@d\ndef f():\n" + body)], 5).value == 0
    assert long_functions([source("def f():  # long: one formula\n" + body)], 5).value == 0
    assert (
        long_functions([source("def f():\n" + body + "    # long: too late\n    y = 1\n")], 5).value
        == 1
    )
    nested = "class C:\n  async def f(self):\n" + body
    assert long_functions([source(nested)], 5).where == ("a.py:2 f: 6",)


# ------------------------------------------------------------------ imports


def test_circles_are_found_between_neighbours_at_every_height(tmp_path: Path) -> None:
    root = package(
        tmp_path,
        {
            "a/one.py": "if TYPE_CHECKING:\n    from made.a import two\n",
            "a/two.py": "from made.a.three import x\n",
            "a/three.py": "import made.a.one\n",
            "b/one.py": "from made.c.one import x\n",
            "c/one.py": "x = 1\n",
            "c/two.py": "def f():\n    from made.b.two import y\n",
            "b/two.py": "from made.d import z\n",
            "d.py": "z = 1\n",
        },
    )
    found = circles(read(root), "made")
    assert found.where == ("made: b, c", "made.a: one, three, two")
    assert found.value == 2


def test_imports_downwards_make_no_circle(tmp_path: Path) -> None:
    root = package(
        tmp_path,
        {
            "a.py": "import made.b\nimport other.a\nfrom made.c import d\n",
            "b.py": "from made.c.d import x\nfrom other.a import y\n",
            "c/d.py": "",
        },
    )
    assert circles(read(root), "made") == Count(0)


# ------------------------------------------------------------------ one idea, one place


def test_files_of_a_part_name_its_class_or_its_table() -> None:
    sources = [
        source("class Gear: ...\n", "mechanism/part/gear.py"),
        source("from made.mechanism.part.gear import Gear\n", "b.py"),
        source("for x in linkage.gears: ...\n", "c.py"),
        source("tables = 'gears'\n", "d.py"),
        source("from made.kernels import Gear\nGears = 'the gears'\n", "e.py"),
        source("from made.mechanism import Gear\n", "__init__.py"),
        source("PARTS = (Gear, linkage.gears)\n", "index.py"),
        source("from made.mechanism import Rack\n", "b2.py"),
    ]
    found = files_of_a_part(sources, PARTS, ["index.py"])
    assert found.where[0] == "Gear: 4 (mechanism/part/gear.py, b.py, c.py, d.py)"
    assert found.where[1] == "Rack: 1 (b2.py)"
    assert found.value == 1  # of 4, 1 and 0
    assert files_of_a_part(sources, PARTS, []).where[0].startswith("Gear: 5 ")


def test_lists_of_parts_hold_three_kinds_or_more() -> None:
    sources = [
        source('A = ("gears", "racks", "cams")\nB = ("gears", "racks", "else")\n'),
        source('C = {"gears": 1, "racks": 2, "cams": 3}\nD = [Gear, Rack, Cam]\n', "b.py"),
        source('__all__ = ["Gear", "Rack", "Cam"]\n', "c.py"),
        source("E = [Gear, Rack, Cam]\n", "d/__init__.py"),
    ]
    found = lists_of_parts(sources, PARTS)
    assert [where.partition(": ")[0] for where in found.where] == ["a.py:1", "b.py:1", "b.py:2"]


def test_files_of_a_quantity_write_its_name_as_a_text() -> None:
    sources = [
        source("x = 'stroke'\n"),
        source("y = {'stroke': 1}\n", "b.py"),
        source("stroke = 1\n", "c.py"),
    ]
    found = files_of_a_quantity(sources, ["stroke", "dwell"])
    assert found == Count(2, ("stroke: 2 (a.py, b.py)", "dwell: 0 ()"))


def test_containers_have_several_arrays_that_rows_have() -> None:
    text = (
        "class Rows:\n    v: Array\n    status: StatusArray\n    other: Array\n"
        "class One:\n    v: float\n    status: Status\n"
    )
    found = containers([source(text)], ["v", "status"], 2, [])
    assert found.where == ("a.py:1 Rows: other, status, v",)
    assert containers([source(text)], ["v", "status", "w"], 3, []).value == 0
    assert containers([source(text)], ["v", "status"], 2, ["Rows"]).value == 0


@pytest.mark.parametrize("method", ["__add__", "__mul__", "__array_ufunc__"])
def test_classes_with_arithmetic_are_counted_once(method: str) -> None:
    text = (
        f"class A:\n    def {method}(self, other): ...\n    def __radd__(self, other): ...\n"
        "class B:\n    def __sub__(self, other): ...\n"
    )
    assert arithmetic([source(text)]).where == ("a.py:1 A",)


@pytest.mark.parametrize(
    "worked_out",
    [
        "np.finfo(float).eps / 2",
        "sys.float_info.epsilon",
        "2.0**-53",
        "2**-52",
        "1.11e-16",
        "2.220446e-16",
    ],
)
def test_a_roundoff_is_worked_out_in_one_module_only(worked_out: str) -> None:
    text = f"x = 1\nUNIT = {worked_out}\n"
    assert roundoffs([source(text)], "rounding.py").where == ("a.py:2",)
    assert roundoffs([source(text, "rounding.py")], "rounding.py").value == 0


def test_other_numbers_are_no_roundoffs() -> None:
    assert (
        roundoffs([source("x = (1e-16, 2.0**-5, 2.5e-16, node.eps, 3**-52)\n")], "r.py").value == 0
    )


def test_a_name_of_a_tolerance_is_counted_at_the_top_of_modules() -> None:
    text = "_SAME = 1e-6\ndef f():\n    _SAME = 1\n"
    assert tolerances([source(text)], ["_SAME"]).where == ("a.py:1 _SAME",)


# ------------------------------------------------------------------ loops


def test_loops_are_declared_by_their_function() -> None:
    text = (
        "class Walk:\n    def run(self):\n        while True: ...\n"
        "def follow():\n    for _ in range(9): ...\n    for x in range(9): ...\n"
        "def other():\n    for _ in rows: ...\n    for _ in zip(rows): ...\n"
        "def entries():\n    for x in range(9): ...\n"
    )
    declared = {
        "walk.Walk.run": "steps: a branch",
        "walk.gone": "steps: nothing",
        "walk.follow": "bisection",
    }
    sources = [source(text, "numerics/walk.py"), source("while x: ...\n", "cli/main.py")]
    found = loop_counts(sources, ["numerics"], declared)
    assert found["step loops"].where == ("walk.Walk.run: steps: a branch",)
    assert found["undeclared loops"].where == ("walk.gone: no longer there",)
    del declared["walk.follow"]
    found = loop_counts(sources, ["numerics"], declared)
    assert found["undeclared loops"].where[0] == "walk.follow: not in house.toml"


# ------------------------------------------------------------------ the table


def test_a_firm_goal_that_is_missed_ends_with_1() -> None:
    said: list[str] = []
    counts = {"few": Count(3, ("a.py:1",)), "many": Count(1.5), "free": Count(7)}
    goals: dict[str, Any] = {"few": {"most": 3, "firm": True}, "many": {"least": 2.0}}
    assert report(counts, goals, False, said.append) == 0
    assert [line.split() for line in said] == [
        ["few", "3", "at", "most", "3"],
        ["many", "1.5", "at", "least", "2.0", "not", "yet"],
        ["free", "7"],
    ]
    goals["many"] = {"most": 1, "ceiling": 1.5}  # may be missed, but not by more
    assert report(counts, goals, False, said.append) == 0
    goals["many"]["ceiling"] = 1.4
    assert report(counts, goals, False, said.append) == 1
    goals["many"] = {}
    goals["few"]["most"] = 2
    said.clear()
    assert report(counts, goals, True, said.append) == 1
    assert said[0].endswith("MISSED")
    assert said[1] == "    a.py:1"


def test_every_goal_belongs_to_a_figure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    known = tomllib.loads((HERE / "house.toml").read_text(encoding="utf-8"))
    root = package(tmp_path, {"a.py": "x = 1\n"})
    assert known["goals"].keys() <= measure(root, known).keys()
    assert main(["--package", str(root)]) == 1  # not one of the declared loops is there
    assert "undeclared loops" in capsys.readouterr().out
