"""Files whose equations make no sense: each problem with file, line, key and what to do."""

from __future__ import annotations

import pytest

import linkwork as lw


def unlisted(name: str) -> str:
    """A file of the library without the lines of its family and its purpose."""
    lines = lw.example_text(name).splitlines(keepends=True)
    return "".join(line for line in lines if not line.startswith(("family", "purpose")))


RAPIER = unlisted("rapier-drive")
FOUR_BAR = unlisted("four-bar")
NEWTON = unlisted("newton-convergence")


def message(text: str) -> str:
    with pytest.raises(lw.MechanismFileError) as caught:
        lw.loads(text, "file.toml")
    return str(caught.value)


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new)


CASES = {
    "an unknown in no loop": (
        changed(RAPIER, "s16 = 400", "s16 = 400\nq = 3"),
        '1 problem in file.toml\n  line 28  guess.q  "q" occurs in no loop equation',
    ),
    "a syntax error with its column": (
        changed(RAPIER, "a3*e^(i*θ13) =", "a3*e^(i*θ13 ="),
        "1 problem in file.toml\n"
        '  line 19  loops."A0 A B C C0"  column 28: expected ")" for the "(" in column 21, '
        'found "="\n'
        "        a2*e^(i*θ12) + a3*e^(i*θ13 = -d1 - i*a1 + a5*e^(i*θ15) + a4*…\n"
        "                                   ^",
    ),
    "no equals sign": (
        changed(RAPIER, "a6 = -s16 - i*b1", "a6 + s16 + i*b1"),
        "1 problem in file.toml\n"
        '  line 20  loops."C0 C D E"  column 66: an equation needs "=": write "… = 0"\n'
        "        …4)*e^(i*θ14) + a6 + s16 + i*b1\n"
        "                                       ^",
    ),
    "a name as angle and as length": (
        changed(RAPIER, "-s16 - i*b1", "-s16*e^(i*s16) - i*b1"),
        "1 problem in file.toml\n"
        '  line 20  loops."C0 C D E"  "s16" is used as an angle and as a length',
    ),
    "a cosine of an unknown": (
        changed(RAPIER, "-s16 - i*b1", "-s16 - b1*cos(θ13)"),
        "1 problem in file.toml\n"
        '  line 20  loops."C0 C D E"  column 66: a loop equation cannot contain '
        "cos of the unknown θ13: write e^(i*θ13), or use [equations]\n"
        "        …4)*e^(i*θ14) + a6 = -s16 - b1*cos(θ13)\n"
        "                                       ^",
    ),
    "pi among degrees": (
        changed(RAPIER, "-s16 - i*b1", "-s16 - b1*e^(i*pi/2)"),
        "1 problem in file.toml\n"
        '  line 20  loops."C0 C D E"  column 67: angles are in degrees here: write 180 '
        'instead of pi, or set angle = "rad"\n'
        "        …)*e^(i*θ14) + a6 = -s16 - b1*e^(i*pi/2)\n"
        "                                       ^",
    ),
    "a real exponent": (
        changed(RAPIER, "-s16 - i*b1", "-s16 - b1*e^(θ13)"),
        "1 problem in file.toml\n"
        '  line 20  loops."C0 C D E"  column 67: the exponent has a part without i: a rotation is '
        "e^(i*angle)\n"
        "        …)*e^(i*θ14) + a6 = -s16 - b1*e^(θ13)\n"
        "                                       ^",
    ),
    "too many loops": (
        changed(RAPIER, "[guess]", '"X" = "a2*e^(i*θ12) + a3*e^(i*θ13) = d1"\n[guess]'),
        "1 problem in file.toml\n"
        '  line 18  loops  2 equations too many: "A0 A B C C0", "C0 C D E", "X" together contain '
        "only θ13, θ14, θ15, s16; remove an equation or an input",
    ),
    "too few loops": (
        changed(RAPIER, "a6 = -s16 - i*b1", "a6 = -s16*e^(i*q) - p*i*b1").replace(
            "s16 = 400", "s16 = 400\nq = 0\np = 1"
        ),
        "1 problem in file.toml\n"
        "  line 18  loops  2 unknowns too many for the equations: add an equation or an input "
        "(not determined: θ13, θ14, θ15, s16, q, p)",
    ),
    "a point of an unknown name": (
        changed(RAPIER, 'D = "B - b4*e^(i*θ14)"', 'D = "B - b4*e^(i*θ99)"'),
        "1 problem in file.toml\n"
        '  line 41  points.D  column 13: "θ99" is neither a dimension nor in [guess] '
        "(names: θ12, θ13, θ14, θ15, s16, a1, b1, d1, … 6 more)\n"
        "        B - b4*e^(i*θ99)\n"
        "                    ^",
    ),
    "points that are defined by each other": (
        changed(RAPIER, 'D = "B - b4*e^(i*θ14)"', 'D = "E - b4*e^(i*θ14)"'),
        "1 problem in file.toml\n  line 41  points.D  is defined in terms of itself: D → E → D",
    ),
    "a length as input without a range": (
        changed(RAPIER, 'variable = "θ12"\nfrom = 0\nto   = 360\nstep = 1', 'variable = "s16"'),
        "1 problem in file.toml\n"
        '  line 29  input.from  is missing: "s16" is not an angle and has no natural range',
    ),
    "an output of an unknown name": (
        changed(FOUR_BAR, '"rocker - coupler"', '"rocker - copler"'),
        "1 problem in file.toml\n"
        '  line 33  outputs.mu  column 10: "copler" is not defined (names: coupler, rocker, '
        "crank, O2.x, O2.y, O4.x, O4.y, A.x, … 3 more)\n"
        "        rocker - copler\n"
        "                 ^",
    ),
    "links that stay free": (
        changed(FOUR_BAR, 'coupler = ["A", "B"]', 'coupler = ["A", "C"]\nrod = ["C", "B"]')
        .replace("O4 = [100, 0]", "O4 = [100, 0]\nC = [90, 60]")
        .replace('"A B"   = 120', '"A C"   = 60'),
        "1 problem in file.toml\n"
        "  line 27  input  one degree of freedom has no input: add an input or a link "
        "(free to move: rocker, coupler, rod)",
    ),
    "an input too many": (
        changed(FOUR_BAR, "[input]", '[[input]]\nlink = "rocker"\n\n[[input]]'),
        "1 problem in file.toml\n"
        "  line 13  links  1 condition too many: remove an input or a link among crank, rocker, "
        "coupler (as assembled it has 1 degree of freedom for 2 inputs)",
    ),
    "a link that is connected to nothing": (
        changed(
            FOUR_BAR, 'rocker  = ["O4", "B"]', 'rocker  = ["O4", "B"]\nfree = ["X", "Y"]'
        ).replace("O4 = [100, 0]", "O4 = [100, 0]\nX = [1, 1]\nY = [2, 2]"),
        "1 problem in file.toml\n"
        "  line 20  links.free  is connected to nothing: let it share a point with another link",
    ),
    "an input whose coefficient is zero": (
        changed(RAPIER, "a2*e^(i*θ12) + a3", "0*e^(i*θ12) + a3"),
        '1 problem in file.toml\n  line 23  guess.θ12  "θ12" occurs in no loop equation',
    ),
    "a plain equation of an unknown name": (
        changed(NEWTON, "2*x - 5", "2*y - 5"),
        "1 problem in file.toml\n"
        '  line 7  equations.F  column 9: "y" is neither a dimension nor in [guess] (names: x)\n'
        "        x^3 - 2*y - 5 = 0\n"
        "                ^",
    ),
    "more plain equations than unknowns": (
        changed(NEWTON, "[guess]", 'G = "x^2 = 4"\n[guess]'),
        "1 problem in file.toml\n"
        '  line 6  equations  1 equation too many: "F", "G" together contain only x; remove an '
        "equation or an input",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_problem_is_told_with_its_place(case: str) -> None:
    text, expected = CASES[case]
    assert message(text) == expected


def test_all_problems_of_the_equations_are_told_together() -> None:
    text = changed(RAPIER, '"θ13" = 200\n', "")
    keys = [problem for problem in message(text).splitlines() if problem.startswith("  line")]
    assert [line.split()[1:3] for line in keys] == [["19", 'loops."A0'], ["38", "points.B"]]
