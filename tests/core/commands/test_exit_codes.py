"""How a run ends: its exit code, and the whole message."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import pytest

from linkwork.core.commands import main as program
from linkwork.core.foundation.errors import LinkworkError
from tests.core.commands.conftest import Run

COMMANDS = ("check", "equations", "solve", "sweep")

WRONG = """\
Error: 3 problems in wrong.toml
  line 8   points.P        is on no link: add it to a link or remove it
  line 12  links.coupler   point "Q" is not defined (points: O2, A, B, O4, P)
  line 19  lengths."O4 B"  must be a positive length, got -80
"""


@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_that_is_understood_ends_with_0(run: Run, command: str) -> None:
    done = run(command, "four-bar.toml")
    assert (done.exit_code, done.stderr) == (0, "")


@pytest.mark.parametrize("command", COMMANDS)
def test_wrong_input_ends_with_2_and_prints_every_problem_to_stderr(run: Run, command: str) -> None:
    done = run(command, "wrong.toml")
    assert (done.exit_code, done.stdout, done.stderr) == (2, "", WRONG)


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (("check", "open.toml"), 1),
        (("solve", "open.toml"), 1),
        (("solve", "four-bar.toml", "--max-steps", "1"), 1),
        (("sweep", "open.toml"), 1),
        (("sweep", "double-rocker.toml"), 1),
        (("sweep", "double-rocker.toml", "--from", "60", "--to", "70"), 0),
        (("sweep", "double-rocker.toml", "--json"), 1),
        (("solve", "open.toml", "--json"), 1),
        (("draw", "open.toml", "-o", "x.svg"), 1),
    ],
)
def test_mathematics_that_says_no_ends_with_1(run: Run, words: tuple[str, ...], code: int) -> None:
    assert run(*words).exit_code == code


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("solve", "nothing.toml"),
            "Error: 1 problem in nothing.toml\n"
            "  there is no such file (TOML files there: wrong.toml, open.toml, cubic.toml,\n"
            "  double-rocker.toml, five-bar.toml, four-bar.toml, parallelogram.toml,\n"
            "  slider-crank.toml)\n",
        ),
        (
            ("solve", "rapier-drive.toml"),
            'Error: there is no file "rapier-drive.toml"; to copy the example of this name:\n'
            "    linkwork examples rapier-drive -o rapier-drive.toml\n",
        ),
        (
            ("solve", "four-bar.toml", "--at", "coupler=3"),
            'Error: "coupler" is not an input of Four-bar (inputs: crank)\n',
        ),
        (
            ("solve", "four-bar.toml", "--at", "2 pi +"),
            'Error: --at 2 pi +: column 3: write the multiplication sign: "2*pi"\n'
            "    2 pi +\n"
            "      ^\n",
        ),
        (
            ("solve", "four-bar.toml", "--at", "3", "--at", "4"),
            "Error: --at 4: crank has a value already, 3\n",
        ),
        (
            ("solve", "five-bar.toml", "--at", "60"),
            'Error: --at 60: "Five-bar" has 2 inputs, name each: --at left=… --at right=…\n',
        ),
        (
            ("solve", "cubic.toml", "--at", "60"),
            'Error: "A cubic" has no input: leave out --at\n',
        ),
        (
            ("sweep", "cubic.toml"),
            'Error: mechanism "A cubic" has no input, so it does not move: solve and\n'
            "  configurations give its positions\n",
        ),
        (
            ("solve", "four-bar.toml", "--set", "b=3"),
            'Error: "b" is not a number of Four-bar that can vary (numbers: a, O2 A, A B, O4\n'
            "  B, O2 O4, O2.x, O2.y, A.x, … 7 more)\n",
        ),
        (
            ("solve", "four-bar.toml", "--set", "a"),
            "Error: --set a: write the name of a number and its value, as in --set a2=260 or\n"
            '  --set "O2 A=38"\n',
        ),
        (
            ("solve", "four-bar.toml", "--set", "a=1", "--set", "a=2"),
            'Error: "a" has a value already: 1.0\n',
        ),
        (
            ("solve", "four-bar.toml", "--set", "a=-3"),
            "Error: 1 problem in four-bar.toml with a=-3\n"
            '  line 17  lengths."O2 A"  must be a positive length, got -3\n',
        ),
        (
            ("draw", "cubic.toml", "-o", "x.svg"),
            'Error: "A cubic" has no points to draw: add [points] with the coordinates of its\n'
            "  pins\n",
        ),
        (
            ("draw", "four-bar.toml", "-o", "x.bmp"),
            'Error: cannot write "x.bmp": the suffix of a picture is one of .png, .svg, .pdf,\n'
            "  .tikz\n",
        ),
        (
            ("draw", "wrong.toml", "-o", "x.bmp"),  # told before anything is read
            'Error: cannot write "x.bmp": the suffix of a picture is one of .png, .svg, .pdf,\n'
            "  .tikz\n",
        ),
        (
            ("sweep", "four-bar.toml", "--csv", "four-bar.toml"),
            'Error: "four-bar.toml" is the mechanism file itself: write to another file\n',
        ),
        (
            ("sweep", "four-bar.toml", "--csv", "a.svg", "--draw", "a.svg"),
            'Error: "a.svg" is named twice: write to another file\n',
        ),
        (
            ("sweep", "four-bar.toml", "--csv", "nowhere/a.csv"),
            'Error: cannot write "nowhere/a.csv": there is no folder "nowhere"\n',
        ),
        (
            ("sweep", "four-bar.toml", "--json", "--csv", "-"),
            "Error: --json and --csv - both use standard output: name a file for the table\n",
        ),
        (
            ("equations", "four-bar.toml", "--json", "--latex"),
            "Error: --latex and --json exclude each other: leave one out\n",
        ),
        (
            ("examples", "-o", "x.toml"),
            "Error: -o needs the name of an example: linkwork examples NAME -o PATH\n",
        ),
    ],
)
def test_what_cannot_be_done_is_said_with_what_to_do(
    run: Run, words: tuple[str, ...], message: str
) -> None:
    done = run(*words)
    assert (done.exit_code, done.stderr) == (2, message)
    if "--json" in words:
        assert json.loads(done.stdout) == {"schema": 1, "error": message[7:-1]}
    else:
        assert done.stdout == ""


def test_problems_of_a_file_are_json_too(run: Run) -> None:
    done = run("solve", "-", "--json", stdin='format = 1\n[equations]\nF = "x"\n[guess]\nx = 1\n')
    assert done.exit_code == 2
    assert json.loads(done.stdout)["problems"] == [
        {
            "line": 3,
            "key": "equations.F",
            "message": 'column 2: an equation needs "=": write "… = 0"\n    x\n     ^',
        }
    ]


@pytest.mark.parametrize(
    "words",
    [
        ("solve",),
        ("solev", "four-bar.toml"),
        ("solve", "four-bar.toml", "--max-steps", "0"),
        ("solve", "four-bar.toml", "--equation-tolerance", "nan"),
        ("solve", "four-bar.toml", "--equation-tolerance", "-1"),
    ],
)
def test_usage_errors_end_with_2(run: Run, words: tuple[str, ...]) -> None:
    done = run(*words)
    assert (done.exit_code, done.stdout) == (2, "")


def _failing(monkeypatch: pytest.MonkeyPatch, trouble: BaseException) -> None:
    """Let reading a mechanism raise."""

    def fail(*_: object) -> None:
        raise trouble

    monkeypatch.setattr("linkwork.core.commands.solve.read_mechanism", fail)


def test_our_fault_ends_with_3_and_asks_to_report(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    _failing(monkeypatch, ZeroDivisionError("by nothing"))
    done = run("solve", "four-bar.toml")
    assert done.exit_code == 3
    assert done.stderr == (
        "Linkwork failed: ZeroDivisionError: by nothing\n"
        "This is an error in Linkwork, not in your input. Please report it with the\n"
        "mechanism file and the command you typed.\n"
        "Add --debug to print the traceback.\n"
    )


@pytest.mark.parametrize(
    "words", [("--debug", "solve", "four-bar.toml"), ("solve", "four-bar.toml", "--debug")]
)
def test_debug_shows_the_traceback(
    run: Run, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    _failing(monkeypatch, ZeroDivisionError("by nothing"))
    done = run(*words)
    assert done.exit_code == 3
    assert done.stderr.startswith("Traceback (most recent call last):\n")
    assert "raise trouble\nZeroDivisionError: by nothing\n" in done.stderr
    assert "--debug" not in done.stderr


@pytest.mark.parametrize(
    ("trouble", "code", "message"),
    [
        (KeyboardInterrupt(), 130, "\nInterrupted.\n"),
        (MemoryError(), 2, "Error: not enough memory: ask for fewer rows\n"),
        (OSError(28, "No space left on device"), 2, "Error: No space left on device\n"),
        (BrokenPipeError(), 141, ""),
        (LinkworkError("on purpose"), 3, "Error: on purpose\n"),
    ],
)
def test_every_other_end_has_its_code(
    run: Run, monkeypatch: pytest.MonkeyPatch, trouble: BaseException, code: int, message: str
) -> None:
    monkeypatch.setattr(program, "abandon_output", SimpleNamespace)
    _failing(monkeypatch, trouble)
    done = run("solve", "four-bar.toml")
    assert (done.exit_code, done.stdout, done.stderr) == (code, "", message)


def test_nothing_is_written_when_the_input_is_wrong(run: Run, folder: Path) -> None:
    before = sorted(folder.iterdir())
    for words in (
        ("sweep", "wrong.toml", "--csv", "a.csv", "--draw", "a.svg"),
        ("sweep", "cubic.toml", "--csv", "a.csv", "--draw", "a.svg"),
        ("sweep", "four-bar.toml", "--csv", "a.csv", "--draw", "a.bmp"),
        ("sweep", "four-bar.toml", "--csv", "a.csv", "--draw", "nowhere/a.svg"),
        ("sweep", "four-bar.toml", "--csv", "a.csv", "--to", "3*"),
        ("draw", "wrong.toml", "-o", "a.svg"),
        ("draw", "open.toml", "-o", "a.svg"),
        ("examples", "no-such-example", "-o", "a.toml"),
    ):
        assert run(*words).exit_code, words
        assert sorted(folder.iterdir()) == before, words


def test_what_to_draw_without_a_picture_ends_with_2(run: Run) -> None:
    done = run("circuits", "four-bar.toml", "--of", "rocker")
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr == "Error: --of selects the curves of --draw: add --draw PATH\n"


def test_an_unknown_quantity_is_answered_with_coordinates_too(run: Run) -> None:
    done = run("sweep", "four-bar.toml", "--limits-of", "B.z")
    assert done.exit_code == 2
    assert '"B.z" (nearest: B.y, B.x, ' in done.stderr
