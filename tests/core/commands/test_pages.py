"""What a person sees in a terminal of eighty columns."""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import replace
from pathlib import Path

import click
import pytest

from linkwork import example_text, examples, load, wings
from linkwork.core.commands.main import linkwork
from linkwork.core.commands.solve import check_lines
from tests.core.commands.conftest import FILES, Run
from tests.thinned import thinned

COMMANDS = tuple(linkwork.list_commands(click.Context(linkwork)))
PAGES = (
    ("check",),
    ("solve",),
    ("solve", "--show-steps"),
    ("sweep",),
    ("configurations",),
    ("circuits", "--no-certificates"),
    ("equations",),
)

SOLVED = """\
Slider-crank
Position found at crank = 90 deg

  unknown       value      1st deriv.          2nd deriv.
  rod      -19.471221 deg      0      rad/rad    0.353553 rad/rad^2
  stroke   113.137    mm     -40.0000 mm/rad    14.1421   mm/rad^2

  point   x [mm]  y [mm]
  O        0.000   0.000
  X      100.000   0.000
  A        0.000  40.000
  B      113.137   0.000

  derivatives  with respect to crank (rad)
"""

CUBIC_STEPS = """\
A cubic
Position found

  unknown         value
  x        -1.769292354

  residual     0
  iterations   5
  condition    1.00
  certificate  true position within RADIUS of the size of the guess; no other
               within 0.25

Newton-Raphson from the guess

  k             x       |F|      step
  0  -2.000000000  2.00e+00  1.00e-01
  1  -1.800000000  2.32e-01  1.50e-02
  2  -1.769948187  4.85e-03  3.28e-04
  3  -1.769292663  2.28e-06  1.54e-07
  4  -1.769292354  """

SWEPT = """\
Four-bar
crank from 0 to 360 deg by 1: 361 positions, 2 more at limits
  found            325
  out of reach     38 at 0 to 18, 342 to 360 deg: this branch does not reach the
                   input value: the motion ends at the limit reported, ask for
                   values before it
  dead point       crank = 18.1948723388 deg, where loop "O2 A B O4" locks
                   (coupler and rocker in line)
"""

AROUND = """\
Four-bar
crank from 0 to 360 deg by 10: 37 positions, 2 more at limits and 35 on further
branches
  found            70
  out of circuit   4 at 0 to 10, 350 to 360 deg: this circuit does not reach the
                   input value on any of its branches: the motion reverses at
                   the limits reported, ask for values between them
  dead point       crank = 18.1948723388 deg, where loop "O2 A B O4" locks
                   (coupler and rocker in line)
  dead point       crank = 341.805127661 deg, where loop "O2 A B O4" locks
                   (coupler and rocker in line)
  maximum          mu = 114.9530208 deg at crank = 180 deg
  minimum          mu = -114.9530208 deg at crank = 180 deg
  circuit          closed: the motion returns to its start
  certified        70
"""

STRAIGHT = """\
Parallelogram
crank from 0 to 360 deg by 30: 13 positions
  found            13
  change point     crank = 0 deg, where loop "O2 A B O4" can close in two ways
                   (coupler and rocker in line)
  change point     crank = 180 deg, where loop "O2 A B O4" can close in two ways
                   (coupler and rocker in line); went straight on
  change point     crank = 360 deg, where loop "O2 A B O4" can close in two ways
                   (coupler and rocker in line)
  certified        5
  not certified    3: too close to a singular position: rounding errors exceed
                   the margin of the proof
  not certified    5: the position is proved; at a change point before it, the
                   chosen policy decides the branch
"""

CHECKED = """\
Four-bar
  written as  points and links
  parts       4 links, 4 joints
  loop        "O2 A B O4"
  unknowns    coupler [deg], rocker [deg]
  input       crank [deg]
  sweep       361 positions
  blocks      1, all unknowns are solved together: dyad RRR, class II
  mobility    1 by Grübler's count, 1 by rank
  chain       four-bar chain
  type        crank-rocker (GCRR): Grashof, s + l < p + q by 20 mm
  class       II

"""

JANSEN = """\
  blocks      3, solved one after the other:
              1. upper_rod, upper_triangle from "O A B P": dyad RRR, class II
              2. lower_rod, lower_rocker from "O A C P": dyad RRR, class II
              3. coupler, foot from "P C E D": dyad RRR, class II
  mobility    1 by Grübler's count, 1 by rank
  chain       eight-link chain, 3 multiple pins
  class       II, the highest of its Assur groups

"""

SHAPER = """\
  blocks      1, all unknowns are solved together: dyad RPR, class II
  mobility    1 by Grübler's count, 1 by rank
  chain       slider-crank chain (RRRP); pin in slot s counted as a block
  type        crank shaper: the driven link turns fully, s + e < l by 150 mm
  class       II

"""

RAPIER = """\
  written as  loops
  parts       6 links, 7 joints, read off the loops
  loops       "A0 A B C C0", "C0 C D E"
  unknowns    θ13 [deg], θ14 [deg], θ15 [deg], s16 [mm]
  input       θ12 [deg]
  sweep       361 positions
  blocks      1, all unknowns are solved together: triad RR-RR-PR, class III
  mobility    1 by Grübler's count, 1 by rank
  chain       Stephenson chain, 1 prismatic joint
  type        Stephenson III
  class       III

"""

EXTREMUM = """\
  chain       not known: plain equations do not determine links and joints

"""

MEASURED = """
Lengths measured between [points], because [lengths] does not give them
  link     points  length [mm]
  coupler  A P         89.0225
  coupler  B P         60.9262
"""

FIRST_WORDS = """\
Usage: linkwork [OPTIONS] [COMMAND] [ARGS]...

  Planar mechanisms, solved from their loop-closure equations.

  A first result in two commands:

    linkwork examples rapier-drive -o rapier.toml
    linkwork sweep rapier.toml --csv rapier.csv --draw rapier.png
"""


def _too_wide(text: str) -> list[str]:
    return [
        line
        for line in text.splitlines()
        if sum(2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in line) > 80
    ]


#: Their circuits take more than five seconds; those of the others show every form of the page.
COSTLY = {
    "beam-engine", "dixon-one", "dixon-two", "double-butterfly", "excavator", "jansen-leg",
    "kempe-translator", "pantograph", "scissor-lift", "trotbot-leg",
}  # fmt: skip


@pytest.mark.parametrize("name", thinned(examples(), 24))
def test_every_page_of_the_library_fits_eighty_columns(run: Run, folder: Path, name: str) -> None:
    assert run("examples", name, "-o", "mechanism.toml").exit_code == 0
    for command, *options in PAGES:
        if command == "circuits" and name in COSTLY:
            continue
        done = run(command, "mechanism.toml", *options)
        assert done.exit_code in (0, 1) or "has no input" in " ".join(done.stderr.split())
        assert _too_wide(done.output) == []


@pytest.mark.parametrize("name", FILES)
def test_every_page_and_message_fits_eighty_columns(run: Run, name: str) -> None:
    for command, *options in PAGES:
        assert _too_wide(run(command, f"{name}.toml", *options).output) == []


@pytest.mark.parametrize("command", [(), *((name,) for name in COMMANDS)])
def test_help_fits_and_shows_examples(run: Run, command: tuple[str, ...]) -> None:
    done = run(*command, "--help")
    assert done.exit_code == 0
    assert _too_wide(done.stdout) == []
    shown = done.stdout.count("\n    linkwork ")
    assert shown >= (1 if command in (("schema",), ("compile",)) else 2)


def test_long_names_are_cut_so_that_tables_fit(run: Run, folder: Path) -> None:
    long = "a_name_that_is_longer_than_the_table_has_room_for"
    text = FILES["slider-crank"].replace("rod", long).replace("Slider-crank", "Name " * 30)
    (folder / "long.toml").write_text(text, encoding="utf-8")
    for command, *options in PAGES[:-1]:  # an equation has no place to break within a name
        done = run(command, "long.toml", *options)
        assert done.exit_code == 0
        assert _too_wide(done.stdout) == []
    assert "a_name_that" in run("solve", "long.toml").stdout


def test_without_a_command_help_starts_with_the_way_to_a_first_result(run: Run) -> None:
    done = run()
    assert (done.exit_code, done.stderr) == (0, "")
    assert done.stdout.startswith(FIRST_WORDS)


def test_commands_are_listed_by_wing_without_loading_any(run: Run) -> None:
    text = run("--help").stdout.partition("Files, equations, positions, the cycle:\n")[2]
    names = [line.split()[0] for line in text.splitlines() if re.match(r"  [a-z]", line)]
    assert names[:9] == [
        "examples", "new", "check", "equations", "quantities", "solve", "sweep", "draw", "schema",
    ]  # fmt: skip
    assert set(names) == {name for wing in wings.WINGS for name in wing.commands}
    assert "Forces and motion in time:\n  forces    Compute" in text


def test_the_list_of_commands_says_what_each_command_says() -> None:
    for wing in wings.WINGS:
        for name, sentence in wing.commands.items():
            first = wings.command(name).help.partition("\n\n")[0]
            assert " ".join(first.split()) == sentence


def test_solve_prints_values_derivatives_points_and_evidence(run: Run) -> None:
    done = run("solve", "slider-crank.toml", "--at", "90")
    assert done.stdout.startswith(SOLVED)
    assert "  residual     " in done.stdout
    assert "of the longest link\n  iterations   " in done.stdout


def test_solve_prints_rates_by_time_if_there_is_a_speed(run: Run) -> None:
    text = run("solve", "four-bar.toml").stdout
    assert "\n  unknown  velocity        acceleration\n  coupler  " in text
    assert " rad/s^2\n" in text
    assert "\n  output   velocity" in text or "\n  output  velocity" in text


def test_show_steps_prints_the_newton_table(run: Run) -> None:
    text = run("solve", "cubic.toml", "--show-steps").stdout
    radius = text.partition("position within ")[2].split()[0]
    assert 0.0 < float(radius) < 1e-14
    assert text.startswith(CUBIC_STEPS.replace("RADIUS", radius))  # below, rounding shows
    assert "\n  5  -1.769292354  0.00e+00\n" in text
    first = text[text.index("\n  k = 0") :].split("\n\n")[0]
    assert first.split() == [
        "k",
        "=",
        "0",
        "F",
        "∂F/∂x",
        "f",
        *first.split()[6:8],
        "Δ",
        "x",
        first.split()[-1],
    ]
    residual, slope, change = (float(first.split()[k]) for k in (6, 7, -1))
    assert change == pytest.approx(-residual / slope, rel=1e-5)


def test_show_steps_tells_where_the_iteration_was_made(run: Run) -> None:
    near = run("solve", "slider-crank.toml", "--at", "60", "--show-steps").stdout
    assert "\nNewton-Raphson from the guess at crank = 60 deg\n\n" in near
    assert "do not lead" not in near
    far = run("solve", "drag-link", "--at", "0", "--show-steps").stdout
    assert "\nNewton-Raphson from the guess at crank = 0 deg\n\n" in far
    assert far.endswith(
        "\nThese steps do not lead to the position above, which was followed from the guess\n"
        "at crank = 60.0000089 deg.\n"
    )
    direct = run("solve", "slider-crank.toml", "--at", "60", "--show-steps", "--from-guess").stdout
    assert "\nNewton-Raphson from the guess at crank = 60 deg\n\n" in direct


def test_max_steps_and_full_steps_reach_the_solver(run: Run) -> None:
    few = run("solve", "cubic.toml", "--max-steps", "2", "--show-steps")
    assert few.exit_code == 1
    assert "\n  2  -1.769948187  4.85e-03\n" in few.stdout
    short, whole = (
        run("solve", "double-rocker.toml", "--at", "170", "--from-guess", "--show-steps", *option)
        for option in ((), ("--full-steps",))
    )
    assert "6.98e-01" in short.stdout  # forty degrees, the largest turn
    assert "6.98e-01" not in whole.stdout


@pytest.mark.parametrize("option", ["--equation-tolerance", "--solution-tolerance"])
def test_a_loose_tolerance_stops_earlier(run: Run, option: str) -> None:
    text = run("solve", "cubic.toml", option, "0.01").stdout
    assert "\n  iterations  5\n" not in text
    assert "Position found" in text


def test_sweep_summary_names_what_failed_and_where_the_motion_ends(run: Run) -> None:
    done = run("sweep", "double-rocker.toml")
    assert done.stdout.startswith(SWEPT)
    assert done.stdout.endswith(
        "\nFor the table add --csv double-rocker.csv, for a picture --draw\ndouble-rocker.png.\n"
    )


def test_sweep_through_dead_points_tells_of_the_whole_circuit(run: Run) -> None:
    words = ("sweep", "double-rocker.toml", "--step", "10", "--through", "--limits-of", "mu")
    done = run(*words)
    assert done.exit_code == 0  # what the circuit does not reach is an answer
    assert done.stdout.startswith(AROUND)
    assert _too_wide(done.stdout) == []
    # at dead points the condition is infinite: the worst of the others is shown
    assert "\n  worst condition  25, at crank = 20 deg\n" in done.stdout


@pytest.mark.parametrize(
    ("policy", "said"),
    [
        ("straight", "; went straight on\n"),
        ("turn", "; turned onto the other branch\n"),
        ("stop", ""),
    ],
)
def test_sweep_tells_how_the_motion_went_on_at_change_points(
    run: Run, policy: str, said: str
) -> None:
    done = run("sweep", "parallelogram.toml", "--change-points", policy)
    assert done.exit_code == (1 if policy == "stop" else 0)
    assert done.stdout.count(said) == 1 or policy == "stop"
    assert ("; went" in done.stdout, "; turned" in done.stdout) == (
        policy == "straight",
        policy == "turn",
    )
    if policy == "straight":
        assert done.stdout.startswith(STRAIGHT)
    if policy == "stop":
        assert "\n  change point     5 at 210 to 330 deg: the motion reaches" in done.stdout
    assert _too_wide(done.stdout) == []


def test_sweep_tells_which_ways_and_names_there_are(run: Run) -> None:
    way = run("sweep", "parallelogram.toml", "--change-points", "strait")
    assert way.exit_code == 2
    assert "'strait' is not one of 'stop', 'straight', 'turn'." in way.stderr
    name = run("sweep", "parallelogram.toml", "--limits-of", "roker")
    assert name.exit_code == 2
    assert name.stderr == (
        'Error: there is no "roker" (nearest: rocker, coupler, crank; all: linkwork\n'
        "  quantities FILE)\n"
    )


def test_sweep_gives_the_range_of_unknowns_outputs_and_traced_points(run: Run) -> None:
    lines = run("sweep", "slider-crank.toml").stdout.splitlines()
    assert "  range of rows     minimum   at     maximum   at  unit" in lines
    assert "  rod            -19.471221   90   19.471221  270  deg" in lines
    assert "  stroke          80.000     180  160.000       0  mm" in lines
    rows = [line.split()[0] for line in run("sweep", "four-bar.toml").stdout.splitlines() if line]
    assert rows[-6:-1] == ["coupler", "rocker", "mu", "P.x", "P.y"]


def test_an_output_that_has_no_value_anywhere_has_no_range(run: Run, folder: Path) -> None:
    text = FILES["four-bar"] + 'never = "sqrt(0*P.x - 1)"\n'
    (folder / "root.toml").write_text(text, encoding="utf-8")
    done = run("sweep", "root.toml")
    assert (done.exit_code, done.stderr) == (0, "")
    (row,) = (line.split() for line in done.stdout.splitlines() if "  never" in line)
    assert row == ["never", "-", "-", "-", "-"]


def test_ranges_leave_out_rows_that_were_not_found(run: Run) -> None:
    lines = run("sweep", "double-rocker.toml").stdout.splitlines()
    (row,) = (line.split() for line in lines if line.startswith("  coupler"))
    # the coupler is least at the dead point, in line with the rocker from A to O4
    least = math.degrees(math.atan2(-21.857492994, 33.5))
    assert row == ["coupler", f"{least:.6f}", "18.19487234", "85.459162", "307", "deg"]


def test_sweep_without_a_start_says_why_and_what_to_do(run: Run) -> None:
    text = " ".join(run("sweep", "open.toml").stdout.split())
    assert 'no start 361 at 0 to 360 deg why loop "O2 A B O4" cannot be closed' in text
    assert " remedy the loops just close with " in text
    assert text.endswith("To see the iterations: linkwork solve open.toml --show-steps")


def test_limits_bear_the_inputs_of_their_rows(run: Run, folder: Path) -> None:
    name = "rapier-drive-limited.toml"
    (folder / name).write_text(example_text("rapier-drive-limited"), encoding="utf-8")
    ends = ("149.617278637", "201.320100396")
    for option in ((), ("--through", "--limits-of", "s16")):
        text = " ".join(run("sweep", name, *option).stdout.split())
        for place in ends:
            assert f"dead point θ12 = {place} deg" in text
        assert "θ12 = -" not in text
    table = run("sweep", name, "--through", "--csv", "-").stdout.splitlines()[1:]
    assert all(0.0 <= float(line.split(",")[0]) <= 360.0 for line in table)


def test_a_list_without_configurations_says_where_to_ask(run: Run) -> None:
    text = run("configurations", "open.toml", "--at", "90").stdout
    assert text.endswith("\nFor the reason: linkwork solve open.toml --at 90\n")


def test_check_tells_what_was_understood(run: Run) -> None:
    text = run("check", "four-bar.toml").stdout
    assert text.startswith(CHECKED)
    assert text.endswith(MEASURED)
    assert "\nPosition found at crank = 29.7448813 deg\n  residual  " in text
    assert " of the longest link\n" in text


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("jansen-leg", JANSEN),
        ("inverted-slider-crank", SHAPER),
        ("rapier-drive", RAPIER),
        ("newton-extremum", EXTREMUM),
    ],
)
def test_check_says_what_a_textbook_says(run: Run, folder: Path, name: str, lines: str) -> None:
    assert run("examples", name, "-o", "mechanism.toml").exit_code == 0
    assert lines in run("check", "mechanism.toml").stdout


def test_check_of_a_loop_that_cannot_close_has_no_grashof_type(run: Run) -> None:
    assert (
        "  type        no closed loop: crank is 100 mm longer than the sum of the other\n"
        "              three\n"
    ) in run("check", "open.toml").stdout


@pytest.mark.parametrize(
    ("count", "rank", "said"),
    [
        (0, 1, "0 by Grübler's count, 1 by rank. They differ: because of this"),
        (None, 1, "mobility 1 by rank"),
        (1, None, "1 by Grübler's count, not known by rank, which needs a position"),
    ],
)
def test_check_says_when_grubler_and_rank_differ(
    count: int | None, rank: int | None, said: str
) -> None:
    report = replace(
        load("four-bar.toml").check(),
        mobility_count=count,
        mobility_rank=rank,
        mobility_why="because of this" if count == 0 else "",
    )
    lines = check_lines(report, "mm")
    assert said in " ".join(" ".join(lines).split())
    assert _too_wide("\n".join(lines)) == []


def test_check_without_a_position_says_why(run: Run) -> None:
    text = run("check", "open.toml").stdout
    assert "\nNo position found at crank = 29.7448813 deg\n  why        loop " in text
    assert "\n  elsewhere  no configuration exists there\n" in text
    assert "1 by Grübler's count, not known by rank, which needs a position" in text


def test_equations_are_shown_as_text_and_as_latex(run: Run) -> None:
    assert run("equations", "four-bar.toml").stdout.startswith("Four-bar\n\nunknowns  ")
    latex = run("equations", "four-bar.toml", "--latex").stdout
    assert latex.startswith("\\begin{align*}\n")
    assert latex.endswith("\\]\n")


def test_control_characters_of_a_file_do_not_reach_the_terminal(run: Run, folder: Path) -> None:
    text = FILES["cubic"].replace("A cubic", "A \\u001b[31mcubic")
    (folder / "escape.toml").write_text(text, encoding="utf-8")
    assert run("solve", "escape.toml").stdout.startswith("A ?[31mcubic\n")


def test_the_library_is_listed_with_titles(run: Run) -> None:
    text = run("examples").stdout
    assert "\n\nrapier drive\n  rapier-drive-limited-links  Rapier drive of a loom, limited" in text
    assert "\n  rapier-drive                Rapier drive of a loom\n\n" in text
    assert text.endswith("\n\nTo copy an example: linkwork examples NAME -o FILE.toml\n")
    assert all(f"\n  {name}  " in text for name in examples())
    assert _too_wide(text) == []
