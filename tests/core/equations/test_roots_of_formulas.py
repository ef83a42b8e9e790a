"""Plain equations: a root is found only where it is proved; a small residual is none."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import linkwork as lw
from linkwork.core.commands.main import linkwork
from linkwork.core.results.failure import LimitKind
from tests.campaigns.roots import root_campaign
from tests.thinned import thinned

NOT_PROVED = lw.Status.ROOT_NOT_PROVED


def solved(
    text: str, guess: float = 1.0, *, certify: bool = True, throw: bool = False
) -> lw.Position:
    mechanism = lw.plain_equations(angle="rad", equations={"F": text}, guess={"x": guess})
    return mechanism.solve(certify=certify, throw=throw)


@pytest.mark.parametrize("certify", [True, False])
@pytest.mark.parametrize(
    ("text", "guess"),
    [
        ("exp(-x) = 0", 1),
        ("1/x^2 = 0", 1),
        ("x^10 + 1e-40 = 0", 1),
        ("cos(x) = 1.0000000000000002", 10),
        ("(x - 1)^2 + 1e-30 = 0", 3),
    ],
)
def test_an_equation_that_is_only_small_has_no_root(text: str, guess: float, certify: bool) -> None:
    position = solved(text, guess, certify=certify)
    assert position.status is NOT_PROVED
    assert not position.certificate.certified
    with pytest.raises(lw.NotConvergedError, match="no root is proved"):
        solved(text, guess, throw=True)


@pytest.mark.parametrize("text", ["exp(-x) = 0", "x^10 + 1e-40 = 0"])
def test_that_no_root_exists_nearby_is_proved(text: str) -> None:
    assert "no root exists for x = " in solved(text).message


@pytest.mark.parametrize(
    ("text", "guess", "root", "order"),
    [("x^3 = 0", 1, 0, 3), ("x^10 = 0", 1, 0, 10), ("(x - 2)^2 = 0", 3, 2, 2)],
)
def test_the_accuracy_of_a_multiple_root_is_said(
    text: str, guess: float, root: float, order: int
) -> None:
    position = solved(text, guess)
    assert position.status is NOT_PROVED
    assert f"as near a root of order {order}" in position.message
    about = float(position.message.partition(" ± ")[2].partition(")")[0])
    # printed with two digits
    assert abs(position.unknowns["x"] - root) == pytest.approx(about, rel=0.1)


def test_the_radius_contains_the_root_where_the_guess_is_a_poor_scale() -> None:
    position = solved("(x - 1e8)^2 - 1 = 0", 1e8 + 3)
    assert position.certificate.certified
    assert position.certificate.radius is not None
    # radii are relative to the guess
    assert abs(position.unknowns["x"] - 100000001) <= position.certificate.radius * (1e8 + 3)
    assert position.certificate.radius < 1e-12


@pytest.mark.parametrize(
    ("text", "guess", "status"),
    [
        ("abs(x) = 1", 0.3, lw.Status.CONVERGED),
        ("max(x, 2*x) = 3", 1, lw.Status.CONVERGED),
        ("abs(x) = 0", 0.3, NOT_PROVED),
    ],
)
def test_a_kink_is_in_the_way_only_where_the_root_lies(
    text: str, guess: float, status: lw.Status
) -> None:
    assert solved(text, guess).status is status


@pytest.mark.parametrize("part", thinned(range(8), 8))
def test_two_hundred_equations_have_no_false_root(part: int) -> None:
    counts, false = root_campaign(part, 25)
    assert false == []
    assert counts["with a simple root: converged"] >= 4
    assert counts["with a simple root: root not proved"] == 0
    assert counts["without a root: converged"] == counts["multiple: converged"] == 0


def test_a_root_that_later_equations_need_is_proved_with_them() -> None:
    # cos z = 3 x has a double root for x = 1/3, which is no float
    mechanism = lw.plain_equations(
        angle="rad", equations={"1": "3*x = 1", "2": "cos(z) = 3*x"}, guess={"x": 0.3, "z": 0.2}
    )
    assert mechanism.solve().status is NOT_PROVED


CIRCLE = {"1": "x^2 + y^2 = r^2", "2": "y = t"}


def circle(stop: float, step: float, **settings: object) -> lw.Motion:
    return lw.plain_equations(
        equations=CIRCLE,
        dimensions={"r": 2},
        guess={"x": 1.9, "y": 0.5, "t": 0.5},
        inputs=lw.Input(variable="t", from_=0, to=stop, step=step),
    ).sweep(**settings)  # type: ignore[arg-type]


def test_rows_and_the_way_between_them_are_proved() -> None:
    motion = circle(1.9, 0.1)
    assert motion.certified.all()
    error = np.abs(motion["x"] - np.sqrt(4.0 - np.array(motion.inputs["t"]) ** 2))
    # the closed form is rounded twice
    assert (error <= motion.radius * 1.9 + 4e-16 * 2).all()


def test_the_dead_point_of_an_equation_is_proved() -> None:
    motion = circle(2.5, 0.25)
    (limit,) = motion.limits
    assert limit.kind is LimitKind.DEAD_POINT
    assert limit.located
    assert limit.bracket[0] <= 2.0 <= limit.bracket[1]
    assert limit.bracket[1] - limit.bracket[0] < 1e-13
    assert motion.certified[motion.found].all()


def test_a_row_where_branches_may_not_meet_is_not_found() -> None:
    # x² = t² - 1e-30 has no root at 0; its branches pass each other there
    motion = lw.plain_equations(
        equations={"1": "x^2 = t^2 - 1e-30"},
        guess={"x": 0.5, "t": 0.5},
        inputs=lw.Input(variable="t", from_=-1, to=1, step=0.5),
    ).sweep(change_points="straight", certify=False)
    row = int(np.argmin(np.abs(np.array(motion.inputs["t"]))))
    assert motion.status[row] is not lw.Status.CONVERGED
    assert np.isnan(motion["x"][row])


def test_commands_say_that_no_root_is_proved_and_fail(tmp_path: Path) -> None:
    file = tmp_path / "small.toml"
    file.write_text('format = 1\n[equations]\nF = "x^10 = 0"\n[guess]\nx = 1\n')
    done = CliRunner().invoke(linkwork, ["solve", str(file)])
    assert done.exit_code == 1
    assert "No position found" in done.output
    assert "as near a root of order 10" in " ".join(done.output.split())
    data = json.loads(CliRunner().invoke(linkwork, ["solve", str(file), "--json"]).output)
    assert data["status"] == "ROOT_NOT_PROVED"
    assert math.isfinite(data["unknowns"]["x"])


def test_other_roots_are_offered_only_if_they_are_proved() -> None:
    # (x² + 1e-14)(x - 5): the damped iteration from 1e-3 ends beside the pair of complex roots
    message = solved("(x^2 + 1e-14)*(x - 5) = 0", 1e-3).message
    assert "x = 5" in message
    assert "x = 0" not in message
