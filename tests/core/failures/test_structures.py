"""Loops with as many unknowns as equations and no input: positions, and no motion."""

from __future__ import annotations

import pytest

import linkwork as lw

TWO_BARS = """\
format = 1
[loops]
roof = "2*cis(p) + 2*cis(q) = 3"
[guess]
p = 40
q = -40
"""


def test_loops_without_input_are_a_structure_with_positions() -> None:
    roof = lw.loads(TWO_BARS)
    position = roof.solve()
    assert position.certificate.certified
    assert position["p"] == pytest.approx(-position["q"])
    assert position["p"] == pytest.approx(41.40962210927086, rel=1e-14)  # arccos 3/4
    assert [found.configuration for found in roof.configurations()] == ["open", "crossed"]


@pytest.mark.parametrize("ask", ["sweep", "circuits"])
def test_what_does_not_move_is_not_swept(ask: str) -> None:
    with pytest.raises(lw.InputError) as refused:
        getattr(lw.loads(TWO_BARS), ask)()
    assert str(refused.value) == (
        'mechanism "mechanism" has no input, so it does not move: '
        "solve and configurations give its positions"
    )


def test_loops_that_move_need_an_input() -> None:
    with pytest.raises(lw.MechanismError) as refused:
        lw.loads(TWO_BARS.replace("= 3", "= r") + "r = 3\n").solve()
    assert str(refused.value) == (
        '1 problem in text\n  line 1  input  is missing: name the driven variable, variable = "p" '
        "(1 unknown more than equations; not determined: p, q, r)"
    )
