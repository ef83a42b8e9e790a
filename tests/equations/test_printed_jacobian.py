"""Every printed entry of the Jacobian has the value that the solver uses."""

from __future__ import annotations

import re

import pytest

import linkwork as lw
from linkwork.expression.grammar import parse
from linkwork.expression.values import value

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


def printed(entry: str, names: dict[str, float], unit: lw.AngleUnit) -> float:
    """The number that a printed entry stands for; ``cos x`` takes its angle without brackets."""
    text = re.sub(r"(cos|sin) ([^ ·)]+)", r"\1(\2)", entry.replace("°", ""))
    return value(parse(text), names, unit)


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
            assert printed(text, names, unit) == pytest.approx(exact, rel=1e-6, abs=1e-6)


def test_conjugate_rows_are_conjugate() -> None:
    sheet = CASES["complex factors"].equations().to_dict()["jacobian_complex"]["text"]
    assert sheet[0][0] == "(3 + 1·i)·e^(it)"
    assert sheet[1][0] == "(3 - 1·i)·e^(-it)"
