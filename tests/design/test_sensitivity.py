"""Sensitivities equal derivatives of closed forms, and differences of whole computations."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.design.derivatives.forces import LoadedRows
from linkwork.design.derivatives.rows import chosen_numbers
from linkwork.design.derivatives.tape import Tape, TapedNumber
from tests.campaigns.gradients import gradient_campaign
from tests.design.extrapolated import changed_by, extrapolated
from tests.library_mechanisms import driven_examples, read_example
from tests.thinned import thinned

STEP = 1e-40  # of a complex step: its square vanishes


def complex_step(of: Callable[..., complex], *at: float) -> list[float]:
    """The derivatives of a function of several numbers, exact to rounding."""
    found = []
    for k in range(len(at)):
        moved = [x + STEP * 1j * (j == k) for j, x in enumerate(at)]
        found.append(of(*moved).imag / STEP)
    return found


def slide(crank: complex, rod: complex, offset: complex, angle: float = math.pi / 3.0) -> complex:
    """The displacement of a slider on a line 20 below the crank's pivot, less an offset."""
    return crank * math.cos(angle) + cmath.sqrt(
        rod**2 - (crank * math.sin(angle) + 20.0 - offset) ** 2
    )


def slide_rate(crank: complex, rod: complex, offset: complex) -> complex:
    """Its derivative by the crank's angle at 60°."""
    angle = math.pi / 3.0
    height = crank * math.sin(angle) + 20.0 - offset
    return -crank * math.sin(angle) - height * crank * math.cos(angle) / cmath.sqrt(
        rod**2 - height**2
    )


#: Their curves and pitch curves are splines, which differences differentiate.
SPLINES = ("curved-slot", "eccentric-cam", "elliptical-gears", "garage-door", "oval-gears")
NAMES = ["O2 A", "B A", "d.offset"]
AT = (40.0, 120.0, 0.0)


def test_a_slider_crank_has_the_derivatives_of_its_closed_form() -> None:
    found = lw.design.sensitivity(read_example("slider-crank"), "d", at=60, by=NAMES)
    # published for this machine to sixteen digits
    assert found["O2 A"] == pytest.approx(0.0570816958859256, rel=1e-13)
    assert found["B A"] == pytest.approx(1.1231958120288066, rel=1e-13)
    assert found["d.offset"] == pytest.approx(0.511438004218547, rel=1e-13)
    assert [found[n] for n in NAMES] == pytest.approx(complex_step(slide, *AT), rel=1e-12)


def test_rates_have_the_derivatives_of_their_closed_form() -> None:
    found = lw.design.gradient(read_example("slider-crank"), "d.d1", at=60, by=NAMES)
    assert list(found.values()) == pytest.approx(complex_step(slide_rate, *AT), rel=1e-12)


def test_rows_of_a_table_have_the_derivatives_of_positions() -> None:
    mechanism = read_example("slider-crank")
    found = lw.design.gradient(mechanism, "d", by=NAMES)
    for row in (0, 60, 250):
        wanted = complex_step(partial(slide, angle=math.radians(row)), *AT)
        own = [np.asarray(found[n])[row] for n in NAMES]
        assert own == pytest.approx(wanted, rel=1e-12, abs=1e-12)


def test_a_dead_point_moves_as_its_closed_form() -> None:
    """The crank turns no further where coupler and rocker are in line."""
    lengths = {"O2 A": 80.0, "A B": 120.0, "O4 B": 80.0, "O2 O4": 100.0}
    mechanism = read_example("four-bar").changed(lengths=lengths)

    def cosine(a: complex, b: complex, c: complex) -> complex:
        return (a**2 + 100.0**2 - (b - c) ** 2) / (2.0 * a * 100.0)

    names = ["O2 A", "A B", "O4 B"]
    at = [lengths[n] for n in names]
    angle = math.acos(cosine(*at).real)
    wanted = [-math.degrees(slope / math.sin(angle)) for slope in complex_step(cosine, *at)]
    upper = lw.design.sensitivity(mechanism, "limit.lower", by=names)
    assert upper.value == pytest.approx(math.degrees(angle), abs=1e-9)
    assert [upper[n] for n in names] == pytest.approx(wanted, rel=1e-9)
    lower = lw.design.sensitivity(mechanism, "limit.upper", by=names)
    assert [lower[n] for n in names] == pytest.approx([-x for x in wanted], rel=1e-9)


def test_an_extreme_at_a_dead_point_moves_with_it() -> None:
    lengths = {"O2 A": 80.0, "A B": 120.0, "O4 B": 80.0, "O2 O4": 100.0}
    mechanism = read_example("four-bar").changed(lengths=lengths)
    found = lw.design.sensitivity(mechanism, "stroke(rocker)", by=["A B"])
    other = extrapolated(
        lambda x: {"stroke": changed_by(mechanism, "A B", x).sweep().value("stroke(rocker)")},
        120.0, 0.05,
    )  # fmt: skip
    # dead points are located to half the digits of their input, extremes there to fewer
    assert found["A B"] == pytest.approx(other["stroke"], rel=1e-6)


@pytest.mark.parametrize("of", ["stroke(d)", "max(rod)", "mean(d)", "path_length(B)"])
def test_numbers_of_a_motion_have_the_derivatives_of_their_rows(of: str) -> None:
    mechanism = read_example("slider-crank").changed(inputs=[lw.Input(link="crank", step=5)])
    found = lw.design.sensitivity(mechanism, of, by=["O2 A"])
    other = extrapolated(
        lambda x: {of: changed_by(mechanism, "O2 A", x).sweep().value(of)}, 40.0, 0.1
    )
    # the slider turns back within 1e-6 of the last step that is halved there
    rel = 1e-7 if of.startswith("path_length") else 1e-9
    assert found["O2 A"] == pytest.approx(other[of], rel=rel)


def around(start: float, stop: float, step: float = 1.0) -> lw.Mechanism:
    return lw.loops(
        loops={"1": "r*e^(i*t) = x + i*y"},
        dimensions={"r": 2.0, "c": 1.0, "s": 0.5},
        guess={"t": 30, "x": 1.0, "y": 1.0},
        inputs=lw.Input(variable="t", from_=start, to=stop, step=step),
        outputs={"mixed": "c*x + s*y + 0.1*x^2"},
    )


@pytest.mark.parametrize(("start", "step"), [(-90, 0.25), (90, -0.25)])
def test_a_dwell_moves_as_its_closed_form(start: float, step: float) -> None:
    """r cos t stays within a band b of its extreme for 2 acos(1 - b/r)."""
    motion = around(start, -start, step)
    r, band = 2.0, 0.3
    found = lw.design.sensitivity(motion, f"dwell(x, {band})", by=["r"])
    cosine = 1.0 - band / r
    by_r = -2.0 * (band / r**2) / math.sqrt(1.0 - cosine**2)
    # the slope of the cubic between rows
    assert found.value == pytest.approx(math.degrees(2.0 * math.acos(cosine)), rel=1e-8)
    assert found["r"] == pytest.approx(math.degrees(by_r), rel=1e-8)
    begins = lw.design.sensitivity(motion, f"dwell_start(x, {band})", by=["r"])
    assert abs(float(begins["r"])) == pytest.approx(abs(math.degrees(by_r)) / 2.0, rel=1e-8)


def test_a_dwell_that_is_the_whole_table_does_not_change() -> None:
    found = lw.design.sensitivity(around(0, 360), "dwell(x, 5)", by=["r"])
    assert found.status is lw.design.SensitivityStatus.FOUND
    assert (float(found.value), float(found["r"])) == (360.0, 0.0)


@pytest.mark.parametrize("step", [2.0, -2.0])
def test_a_time_ratio_has_the_derivative_of_its_extremes(step: float) -> None:
    mechanism = around(0, 360 if step > 0 else -360, step)
    for name, at in (("c", 1.0), ("s", 0.5), ("r", 2.0)):
        found = lw.design.sensitivity(mechanism, "time_ratio(mixed)", by=[name])

        def ratio(x: float, name: str = name) -> dict[str, float]:
            return {"": changed_by(mechanism, name, x).sweep().value("time_ratio(mixed)")}

        assert found[name] == pytest.approx(extrapolated(ratio, at, 5e-4)[""], rel=1e-9, abs=1e-11)


def test_a_time_ratio_of_equal_strokes_has_a_corner() -> None:
    found = lw.design.sensitivity(around(0, 360), "time_ratio(x)", by=["r"])
    assert found.status is lw.design.SensitivityStatus.CORNER


def test_a_length_given_by_a_formula_varies_alone_and_with_its_dimension() -> None:
    mechanism = read_example("geared-five-bar")
    found = lw.design.sensitivity(mechanism, "rod1", at=60, by=["a", "O A"])
    assert found["a"] == pytest.approx(found["O A"], rel=1e-14)
    assert "O A" not in lw.design.sensitivity(mechanism, "rod1", at=60).derivatives


@pytest.mark.parametrize("name", thinned(driven_examples(), 12))
def test_all_quantities_of_a_library_mechanism_have_the_derivatives_of_its_equations(
    name: str,
) -> None:
    """The equations that the file states, in seventy digits, differentiated by every number."""
    counts, false = gradient_campaign(driven_examples().index(name))
    assert not false
    # whatever the file of oval gears gives changes the form of the equations
    assert counts["compared"] > 0 or not counts["numbers"]
    assert counts["of these with stated equations"] > 0 or name in SPLINES


def test_sketched_coordinates_that_only_select_a_shape_have_no_effect() -> None:
    """Three points in line are fitted by an iteration from the sketch; its result knows it not."""
    found = lw.design.sensitivity(read_example("stephenson-valve-gear"), "x", at=50)
    assert found["F S G"] != 0.0
    assert [found[f"{p}.{axis}"] for p in ("F", "G", "S") for axis in "xy"] == [0.0] * 6


@pytest.mark.parametrize("name", ["slider-crank", "jansen-leg", "curved-slot", "five-bar-robot"])
def test_forward_and_adjoint_derivatives_are_equal(name: str) -> None:
    mechanism = read_example(name)
    model = mechanism.model
    position = mechanism.solve(certify=False)
    values = np.array(list(position.input.values())) * model.input_scale
    v = np.append(position.q, values)[None, :]
    taped = LoadedRows(model, chosen_numbers(model, None)[0], v, 2)
    compared = 0
    for asked in (*model.quantities.own.values(), *model.quantities.derived.values()):
        with np.errstate(all="ignore"):
            result = asked.values(taped, None)
            forward, backward = taped.tape.forward([result])[0], taped.tape.backward(result)
        if not np.isfinite(getattr(result, "values", result)).all():
            continue
        assert np.ravel(forward) == pytest.approx(np.ravel(backward), rel=1e-10, abs=1e-12)
        compared += bool(np.any(forward))
    assert compared > 5


def test_a_gradient_needs_no_more_nodes_for_more_numbers() -> None:
    """The adjoint visits what the quantity depends on, once for all numbers."""
    model = read_example("jansen-leg").model
    numbers, _ = chosen_numbers(model, None)
    position = read_example("jansen-leg").solve(certify=False)
    v = np.append(position.q, model.start_inputs)[None, :]
    sizes = []
    for count in (1, len(numbers)):
        taped = LoadedRows(model, numbers[:count], v, 0)
        result: Any = model.quantities.find("F.x").values(taped, None)
        written = len(taped.tape._needed([result.node]))
        sizes.append(written)
    assert len(numbers) > 20
    # more numbers reach more coefficients, not more equations
    assert sizes[1] < 5 * sizes[0]


# Statuses and wrong input


def test_a_dead_point_has_no_finite_sensitivity() -> None:
    lengths = {"O2 A": 80.0, "A B": 120.0, "O4 B": 80.0, "O2 O4": 100.0}
    mechanism = read_example("four-bar").changed(lengths=lengths)
    found = lw.design.sensitivity(mechanism, "rocker", by=["A B"])
    dead = [word == "dead point" for word in mechanism.sweep().limit]
    statuses = [status.name for status, row in zip(found.statuses, dead, strict=True) if row]
    assert statuses == ["DEAD_POINT", "DEAD_POINT"]
    assert np.isnan(np.asarray(found["A B"])[dead]).all()
    assert {status.name for status in found.statuses} == {"FOUND", "DEAD_POINT", "NO_POSITION"}
    assert "limit.lower" in found.statuses[dead.index(True)].value


def test_a_missing_position_has_a_status_and_no_numbers() -> None:
    lengths = {"O2 A": 80.0, "A B": 120.0, "O4 B": 80.0, "O2 O4": 100.0}
    found = lw.design.sensitivity(read_example("four-bar").changed(lengths=lengths), "rocker", at=5)
    assert found.status is lw.design.SensitivityStatus.NO_POSITION
    assert math.isnan(found["A B"])


def test_a_number_that_cannot_vary_alone_is_refused_with_its_reason() -> None:
    bar = read_example("four-bar")
    found = lw.design.sensitivity(bar, "rocker", at=60)
    assert "ground coordinates are exact" in found.refused["O2 O4"]
    with pytest.raises(
        InputError, match='"O2 O4" cannot vary: ground coordinates are exact and give lengths'
    ):
        lw.design.sensitivity(bar, "rocker", at=60, by=["O2 O4"])
    stressed = read_example("parallel-cranks")
    refused = lw.design.sensitivity(stressed, stressed.loop_equations.inputs[0].name).refused
    assert "a redundant link does not fit any more" in refused.values()


@pytest.mark.parametrize(
    "formula", ["max(a, 40)", "40 + abs(a - 40)", "40 + hypot(a - 40, 0)", "acos(a/40) + 40"]
)
def test_a_number_at_a_corner_of_its_formula_has_no_derivative_and_says_so(formula: str) -> None:
    """One side of |x| counts where equations are written with it, but not in formulas."""
    text = lw.example_text("four-bar").replace('"O2 A"  = 40', f'"O2 A" = "{formula}"')
    bar = lw.loads(text.replace("[points]\n", "[dimensions]\na = 40\n\n[points]\n"))
    told = r'^"a" cannot vary: at 40 a formula of it has a corner .*: change the number a little$'
    with pytest.raises(InputError, match=told):
        lw.design.gradient(bar, "rocker", by=["a"], at=60)
    assert "a corner" in lw.design.sensitivity(bar, "rocker", at=60).refused["a"]


@pytest.mark.parametrize(
    ("of", "by", "message"),
    [
        ("dd", None, 'there is no "dd"'),
        ("d", ["B Z"], '"B Z" is not a number of'),
        ("d", ["B A", "A B"], '"A B" is named twice'),
        ("residual", None, "it has no sensitivity"),
        ("stroke(d)", None, "leave out at"),
        ("d.velocity", None, "needs the speed of the input"),
    ],
)
def test_wrong_names_are_refused(of: str, by: list[str] | None, message: str) -> None:
    with pytest.raises((InputError, UnknownNameError), match=message):
        lw.design.sensitivity(read_example("slider-crank"), of, at=60, by=by)


def test_a_motion_without_dead_point_has_no_limit_to_differentiate() -> None:
    with pytest.raises(InputError, match="no dead point above its start"):
        lw.design.sensitivity(read_example("slider-crank"), "limit.upper")


def test_a_plain_zero_or_one_leaves_a_taped_number_as_it_is() -> None:
    tape = Tape()
    x: Any = tape.number(2.0)
    zero = np.zeros(())
    assert all(same is x for same in (x * 1.0, 1.0 * x, x + zero, zero + x, x - 0.0))
    for nothing in (x * zero, 0.0 * x):
        assert not isinstance(nothing, TapedNumber)
        assert nothing == 0.0
    (slope,) = tape.forward([zero - x])
    assert slope == -1.0


def test_numbers_of_every_mechanism_of_the_library_are_chosen() -> None:
    """A follower with two points on its line chooses a direction while its numbers are taped."""
    counts = {
        name: len(chosen_numbers(read_example(name).model, None)[0]) for name in lw.examples()
    }
    assert counts["cam-roller-follower"] == 5
