"""``linkwork circuits``: the page, the JSON, and what is said where there is no circuit."""

from __future__ import annotations

import json
from pathlib import Path

import linkwork as lw
from tests.core.commands.conftest import FILES, Run

ROCKER = """\
Four-bar
1 circuit driven by crank

  circuit 1  from crank [deg]           to  at the guess's input
  branch 1        18.19487234  341.8051277  open
  branch 2        18.19487234  341.8051277  crossed
  closed      the motion returns to its start; proved
  input       turns back at the dead points
  rocking     crank, coupler, rocker
  dead point  crank = 341.805127661 deg, where loop "O2 A B O4" locks (coupler
              and rocker in line)
  dead point  crank = 18.1948723388 deg, where loop "O2 A B O4" locks (coupler
              and rocker in line)

  complete  the list of circuits is complete with probability one: all dead
            points were found, and all configurations at 3 input values, at
            least one between any two of them
"""

#: The crank's tip is 317.08 from O4, coupler and rocker reach 200.
NONE = """\
Four-bar
No circuits driven by crank

  why        loop "O2 A B O4" cannot be closed at crank = 29.7449°: near the
             guess a gap of at least 117.081 mm remains
  remedy     the loops just close with "O4 B" = 197.081 mm (117.081 longer) or a
             = 280.573 mm (119.427 shorter) or "O2 O4" = 322.49 mm (222.49
             longer)
  nearest    no input value was found at which the mechanism can be assembled
  elsewhere  no configuration exists there
  complete   the list of circuits is complete with probability one: all dead
             points were found, and all configurations at the guess's input
             (there is no dead point)
"""

#: Stretched out at 0 degrees, it reaches no other crank angle.
STRETCHED = (
    FILES["four-bar"]
    .replace("A = [35, 20]", "A = [10, 0]")
    .replace("B = [146, 66]", "B = [60, 0]")
    .replace("a = 40", "a = 10")
    .replace('"A B" = 120', '"A B" = 50')
    .replace('"O4 B" = 80', '"O4 B" = 40')
)

STUCK = """\
Four-bar
No circuits driven by crank

  why        position found at crank = 0°, at a dead point or change point, but
             no motion passes through it
  elsewhere  1 configuration exists there (perhaps not all): double (coupler =
             0°, rocker = 180°)
  complete   the list of circuits is complete with probability one: all dead
             points and change points were found, and all configurations at 2
             input values, at least one between any two of them
"""

NO_ROOT = """\
format = 1
name = "No root"
[equations]
f = "x^2 + u^2 + 1 = 0"
[guess]
x = 1
u = 1
[input]
variable = "u"
from = 0
to = 2
step = 1
"""

ROOTLESS = """\
No root
No circuits driven by u

  why        no position after the largest allowed number of iterations: start
             from a nearer guess or allow more iterations; "f" has at least the
             residual 2 nearby
  elsewhere  other guesses also lead to no position there
  complete   only the guess: the configurations of these equations cannot be
             listed
"""


def test_branches_limits_and_completeness_of_every_circuit(run: Run) -> None:
    done = run("circuits", "double-rocker.toml")
    assert (done.exit_code, done.stdout, done.stderr) == (0, ROCKER, "")


def test_what_cannot_be_assembled_anywhere_says_which_loop_and_by_how_much(run: Run) -> None:
    done = run("circuits", "open.toml")
    assert (done.exit_code, done.stdout, done.stderr) == (1, NONE, "")
    solved = run("solve", "open.toml").stdout.splitlines()
    reasons = [line for line in done.stdout.splitlines() if line.startswith("  ")]
    # the same words in both, but for the last field, which solve does not have
    assert solved[2:] == reasons[: len(solved) - 2]
    drawn = run("circuits", "open.toml", "--draw", "a.svg")
    assert drawn.stdout == NONE + "\nDid not write a.svg: there is nothing to draw.\n"
    assert not Path("a.svg").exists()


def test_the_reason_is_in_the_json(run: Run) -> None:
    data = json.loads(run("circuits", "open.toml", "--json").stdout)
    assert data["circuits"] == []
    assert data["failure"]["loops"] == ["O2 A B O4"]
    assert abs(data["failure"]["gap"] - 117.081) < 1e-3
    assert "failure" not in json.loads(run("circuits", "four-bar.toml", "--json").stdout)


def test_a_position_that_nothing_leads_to_is_told(run: Run, folder: Path) -> None:
    (folder / "stretched.toml").write_text(STRETCHED, encoding="utf-8")
    done = run("circuits", "stretched.toml")
    assert (done.exit_code, done.stdout) == (1, STUCK)


def test_equations_without_a_root_are_told(run: Run, folder: Path) -> None:
    (folder / "no-root.toml").write_text(NO_ROOT, encoding="utf-8")
    done = run("circuits", "no-root.toml")
    assert (done.exit_code, done.stdout) == (1, ROOTLESS)


def test_the_reason_is_given_in_python(run: Run) -> None:
    found = lw.load("open.toml").circuits()
    assert len(found) == 0
    assert found.failure is not None
    assert found.failure.message == lw.load("open.toml").solve().message
    # where there is a circuit, a guess without a position is no trouble
    beyond = lw.load("double-rocker.toml").changed(
        points={"O2": (0, 0), "A": (70, 1), "B": (146, 66), "O4": (100, 0), "P": (90, 90)}
    )
    assert not beyond.solve().status.ok
    circuits = beyond.circuits()
    assert len(circuits) == 1
    assert circuits.failure is None
