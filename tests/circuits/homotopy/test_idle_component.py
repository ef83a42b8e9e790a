"""Real motions with the input at rest, told from curves of complex solutions."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.dead_inputs import DeadPointForm, dead_point_form
from linkwork.circuits.homotopy.dead_point_family import dead_point_roots
from linkwork.circuits.homotopy.monodromy import RealPoints, keeps_complex_input, real_motion
from linkwork.core.motion.following import Drive
from linkwork.core.motion.model import leading_input

KITE = "e^(i*t) + 2*e^(i*p) = 1 + 2*e^(i*q)"
ISOSCELES = "2*e^(i*p) + 2*e^(i*q) = s"


def _driven(text: str, variable: str, **guess: float) -> lw.Mechanism:
    driver = lw.Input(variable=variable, from_=guess[variable], to=guess[variable] + 1, step=1)
    return lw.loops(loops={"1": text}, guess=guess, inputs=driver)


def _form(mechanism: lw.Mechanism, number: int) -> DeadPointForm:
    """Of a block, its inputs in lock-step."""
    model = mechanism.model
    lead, rate = leading_input(model.rows)
    drive = Drive.through(model, model.start_inputs, rate, lead)
    form = dead_point_form(drive.leads, model.compiled.solver, drive.path, number)
    assert form is not None
    return form


def _kite() -> DeadPointForm:
    return _form(_driven(KITE, "t", t=60, p=30, q=80), 0)


def _isosceles() -> DeadPointForm:
    return _form(_driven(ISOSCELES, "s", s=1.0, p=70, q=-70), 0)


@pytest.mark.parametrize("form", [_kite(), _isosceles(), _form(lw.example("three-rpr"), 0)])
def test_slopes_of_the_input_are_its_differences(form: DeadPointForm) -> None:
    rng = np.random.default_rng(3)
    count = 2 * form.system.size + 2 * form.system.own
    x, d = rng.normal(size=(2, count)) + 1j * rng.normal(size=(2, count))
    h = 1e-6
    slope = (form.lead(x + h * d)[0] - form.lead(x - h * d)[0]) / (2 * h)
    np.testing.assert_allclose(form.lead(x)[1] @ d, slope, rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize(
    ("form", "value"), [(_kite(), 1.0), (_isosceles(), 0.0)], ids=["kite", "slider"]
)
def test_equal_bars_that_lie_on_each_other_really_turn(form: DeadPointForm, value: float) -> None:
    """The kite's crank on the ground, the slider at the crank's pivot: the input rests there."""
    curves = dead_point_roots(form.system).curves
    assert len(curves) > 0
    for x in curves:
        assert not keeps_complex_input(form.system, x, form.lead)
        found = real_motion(form.system, x, form.lead)
        assert found is not None
        m = form.system.size
        for point in found:
            residual, _ = form.system.residual_and_jacobian(point[None])
            assert np.abs(residual[0, :-1]).max() < 1e-10  # rates have another norm
            np.testing.assert_allclose(point[:m], point[m : 2 * m].conj(), rtol=0, atol=1e-12)
            np.testing.assert_allclose(form.lead(point)[0], value, rtol=0, atol=1e-7)
        assert np.abs(found[1] - found[0])[: 2 * m].max() > 1e-3


def test_two_slides_in_line_really_move() -> None:
    """From lengths of 0.3 and 0.4 at 5°, and any rates: the lengths run along at 0°."""
    form = _form(_driven("r*e^(i*t) = s", "t", t=30, r=0.0, s=0.0), 0)
    turn = np.exp(1j * np.radians(5))
    x = np.array([turn, 0.3 * turn, 0.4, 1 / turn, 0.3 / turn, 0.4, 1.0, 1.0j])
    found = real_motion(form.system, x, form.lead)
    assert found is not None
    for point in found:
        np.testing.assert_allclose(form.lead(point)[0], 1.0, rtol=0, atol=1e-9)
        np.testing.assert_allclose(point[1], point[2], rtol=0, atol=1e-9)
    assert abs(found[1][2] - found[0][2]) > 1e-3


def test_bars_that_fold_at_a_complex_input_only_never_turn() -> None:
    """The pantograph's tie and pen bar: the dead points of the arm before them are all complex."""
    form = _form(lw.example("pantograph"), 2)
    curves = dead_point_roots(form.system).curves
    assert len(curves) > 0
    for x in curves:
        assert keeps_complex_input(form.system, x, form.lead)
        assert abs(abs(form.lead(x)[0][0]) - 1.0) > 0.1
        assert real_motion(form.system, x, form.lead) is None


def test_a_dead_point_with_a_slide_is_a_real_position_but_no_motion() -> None:
    """The rod square to the slide, s free at first order: rates ω and σ are both at work."""
    form = _form(_driven("2*e^(i*t) + e^(i*p) = s", "t", t=30, p=-80, s=2.0), 0)
    x = next(x for x in dead_point_roots(form.system).x if abs(abs(x[1]) - 1.0) < 1e-6)
    real = RealPoints(form.system, form.lead)
    y = real.correct(real.near(x), None)
    assert y is not None
    m = 2 * form.system.size
    np.testing.assert_allclose(real.place(y)[:m], x[:m], rtol=0, atol=1e-9)
    assert np.abs(y[m:]).min() > 0.1
    assert real_motion(form.system, x, form.lead) is None
