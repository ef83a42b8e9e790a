"""Every printed entry of the Jacobian has the value that the solver uses."""

from __future__ import annotations

import re

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.equations.model import LoopEquations
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.values import value
from tests.core.laws.contacts import KINDS, contact

CASES = {
    name: lw.example(name)
    for name in ("four-bar", "rapier-drive", "inverted-slider-crank", "slider-crank", "jansen-leg")
} | {
    "complex factors": lw.loops(
        loops={"1": "(3+1*i)*s*e^(i*t) + (2.94 - 5.49*i)*e^(i*a) = 4 + 2*i*e^(i*(a+30))"},
        guess={"s": 1, "t": 20, "a": 30},
        inputs=lw.Input(variable="a"),
    ),
    "weighted angles": lw.loops(
        loops={"1": "3*e^(i*(2*t - u)) + 2*e^(-i*u) = 4*e^(i*a) + 1"},
        guess={"u": 10, "t": 20, "a": 30},
        inputs=lw.Input(variable="a"),
    ),
    "sines of degrees": lw.plain_equations(
        equations={"f": "sin(x) + x*y^2 = 0.5", "g": "atan2(x, y) - tan(y) = 3"},
        guess={"x": 20, "y": 10},
    ),
}


CASES |= {kind: contact(kind, 5) for kind in KINDS}
CASES |= {
    "cam angle as unknown": contact("cam by its follower, sliding roller", 6).changed(
        inputs=lw.Input(slider="s", from_=50, to=51, step=1)
    )
}


def printed(entry: str, names: dict[str, float], unit: lw.AngleUnit) -> float:
    """The number that a printed entry stands for; ``cos x`` takes its angle without brackets."""
    text = re.sub(r"(cos|sin) ([^ ·)]+)", r"\1(\2)", entry.replace("°", ""))
    return value(parse(text), names, unit)


def without_laws(entry: str, equations: LoopEquations, names: dict[str, float]) -> str:
    """An entry with numbers instead of derivatives of laws: ``x_u'(θ_u)``."""
    laws = {law.shown: law for law in equations.laws}
    kinds = {v.symbol: v.kind for v in equations.variables}

    def number(match: re.Match[str]) -> str:
        law = laws[match[1]]
        angle = kinds[law.inner[0][0]] == "angle"
        argument = printed(match[3], names, equations.angle)
        argument *= equations.angle.radians if angle else 1.0
        order = len(match[2]) - law.primes
        return f"({law.law.jet(np.array([argument]))[order][0]:.17f})"

    return re.sub(r"(\w+)('+)\(([^()]*)\)", number, entry)


@pytest.mark.parametrize("case", CASES)
def test_every_printed_entry_is_the_entry_that_is_used(case: str) -> None:
    mechanism = CASES[case]
    equations = mechanism.loop_equations
    sheet = mechanism.equations()
    unit = equations.angle
    start = equations.start
    names = dict(equations.symbols)
    for variable, number in zip(equations.variables, start, strict=True):
        scale = unit.radians if variable.kind == "angle" else 1.0
        names[variable.shown] = names[variable.symbol] = number / scale
    jacobian = mechanism.model.compiled.table.jacobian(start[None, :])[0]
    entries = sheet.to_dict()["jacobian_real"]["text"]
    assert len(entries) == len(jacobian)
    # fixed angles are printed to 1e-6 degrees
    for row, texts in zip(jacobian, entries, strict=True):
        for exact, text in zip(row, texts, strict=False):
            entry = without_laws(text, equations, names)
            assert printed(entry, names, unit) == pytest.approx(exact, rel=1e-6, abs=1e-6)


def test_conjugate_rows_are_conjugate() -> None:
    sheet = CASES["complex factors"].equations().to_dict()["jacobian_complex"]["text"]
    assert sheet[0][0] == "(3 + 1·i)·e^(it)"
    assert sheet[1][0] == "(3 - 1·i)·e^(-it)"


def test_a_law_is_printed_with_what_it_is() -> None:
    lines = CASES["cam by its follower, swinging flat"].equations().text().split("\n")
    k = lines.index('Equation "law"')
    words = " ".join(line.strip() for line in lines[k + 1 : k + 5])
    assert re.match(
        r"θ_arm [+-] [0-9.]+° [+-] law\(θ_cam [+-] [0-9.]+°\) = 0 "
        r"where law is the follower's motion (in the negative direction, )?"
        r"as the cam turns: [-a-z0-9 ]+ over 120 by 8.0, dwell over 50, "
        r"[-a-z0-9 ]+ over 140 by -8.0, dwell over 50",
        words,
    )
    latex = CASES["cam by its follower, swinging flat"].equations().latex()
    assert r"\mathrm{law}\left(\theta_{cam}" in latex
