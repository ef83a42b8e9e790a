"""Function generation: published ratios, all solutions, best fits."""

from __future__ import annotations

import re
from itertools import product
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares, minimize

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import MechanismError
from linkwork.synthesis.loops.driven_loop import Range
from linkwork.synthesis.solvers.functions import (
    FunctionWishes,
    freudenstein,
    rocker_errors,
    slider_errors,
)
from linkwork.synthesis.solvers.solving import remarks_on
from linkwork.synthesis.tasks.conditions import Wishes

_LOGARITHM = {"x": (1, 2), "input": (45, 105), "output": (0, 90), "mechanism": "four-bar"}
_PAIRS = [(0, 0), (20, 10), (45, 22), (60, 28), (80, 30)]


def _designs(task: lw.Task) -> list[lw.Mechanism]:
    return list(task.solve().defect_free)


def test_the_logarithm_at_three_chebyshev_points_has_the_published_ratios() -> None:
    (design,) = _designs(lw.Task.function("log10(x)", **_LOGARITHM))
    lengths = {
        name: np.hypot(*np.subtract(*(design.description.points[p] for p in name.split())))  # type: ignore[attr-defined]  # a linkage
        for name in ("A0 B0", "A0 A", "A B", "B0 B")
    }
    expected = {"A0 B0": 1.0, "A0 A": 0.652585741, "A B": 1.170609286, "B0 B": 0.528110663}
    assert lengths == pytest.approx(expected, abs=1e-9)


def test_a_power_at_three_chebyshev_points_has_the_published_numbers() -> None:
    share = 0.5 - 0.5 * np.cos((2 * np.arange(1, 4) - 1) * np.pi / 6)
    x = 1.0 + 3.0 * share
    u = np.radians(30.0 + 90.0 * share)
    v = np.radians(90.0 + 90.0 * (x**1.5 - 1.0) / 7.0)
    k, error = freudenstein(u[None], v[None])
    assert k[0] == pytest.approx([-0.58824741, -0.44968071, 0.12403491], abs=1e-8)
    assert error.max() < 1e-12


def test_a_design_passes_its_precision_points_measured_as_the_task_measures_them() -> None:
    """Negative lengths point the other way: the file's angles are the task's all the same."""
    power = {"x": (1, 4), "input": (30, 120), "output": (90, 180), "mechanism": "four-bar"}
    (design,) = _designs(lw.Task.function("x^1.5", **power))
    for share in 0.5 - 0.5 * np.cos((2 * np.arange(1, 4) - 1) * np.pi / 6):
        position = design.solve(at=30.0 + 90.0 * share)
        wanted = 90.0 + 90.0 * ((1.0 + 3.0 * share) ** 1.5 - 1.0) / 7.0
        assert position["rocker"] == pytest.approx(wanted, abs=1e-9)
        assert position["structural_error"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("mechanism", ["four-bar", "slider-crank"])
@pytest.mark.parametrize("count", [3, 4, 5])
def test_designs_follow_the_differences_of_pairs(mechanism: str, count: int) -> None:
    found = lw.Task.function(_PAIRS[:count], mechanism=mechanism, rank={"deliver": 3}).solve()
    if count == 5:
        assert found.complex == 3
        assert found.real in (1, 3)
        assert found.completeness is lw.Completeness.PROVED
    else:
        assert found.completeness is lw.Completeness.SAMPLED
        assert found.delivered
    output = "rocker" if mechanism == "four-bar" else "slide"
    for design in found.delivered:
        bar = lw.Mechanism(design.linkage)
        inputs = np.array(design.inputs)
        values = np.array([bar.solve(at=float(value))[output] for value in inputs])
        assert np.diff(inputs) == pytest.approx(np.diff(_PAIRS[:count], axis=0)[:, 0], abs=1e-9)
        assert np.diff(values) == pytest.approx(np.diff(_PAIRS[:count], axis=0)[:, 1], abs=1e-6)


def _logarithm() -> tuple[Array, Array]:
    x = np.linspace(1.0, 2.0, 181)
    return np.radians(45.0 + 60.0 * (x - 1.0)), np.radians(90.0 * np.log10(x) / np.log10(2.0))


@pytest.mark.parametrize("slides", [False, True])
def test_derivatives_of_structural_errors_are_their_differences(slides: bool) -> None:
    u, v = _logarithm()
    errors = (slider_errors if slides else rocker_errors)(u, v, 1.0)
    start = np.array([0.4, 0.2, 1.3] if slides else [0.65, 0.53, 1.17])
    if not slides:
        errors = rocker_errors(u, v, -1.0)
    gradient = errors(start)[1]
    for k in range(3):
        step = 1e-6 * np.eye(3)[k]
        difference = (errors(start + step)[0] - errors(start - step)[0]) / 2e-6
        assert gradient[:, k] == pytest.approx(difference, abs=1e-6)


def test_the_least_squares_fit_is_that_of_scipy() -> None:
    u, v = _logarithm()
    found = lw.Task.function("log10(x)", fit="least squares", **_LOGARITHM).solve().designs[0]
    design = found.points
    lengths = np.abs([design["A"], design["B"] - 1.0, design["B"] - design["A"]])
    side = np.sign(((design["B"] - design["A"]).conjugate() * (design["B"] - 1.0)).imag)
    errors = rocker_errors(u, v, float(side))
    referee = least_squares(lambda x: errors(x)[0], lengths * 1.02, xtol=1e-15, ftol=1e-15)
    assert lengths == pytest.approx(referee.x, rel=1e-6)


def test_the_minimax_fit_has_four_equal_errors_of_alternating_sign() -> None:
    found = lw.Task.function("log10(x)", fit="minimax", **_LOGARITHM).solve()
    (design,) = found.defect_free
    error = np.asarray(design.sweep(certify=False)["structural_error"])
    largest = found.delivered[0].error
    assert np.abs(error).max() == pytest.approx(largest, rel=2e-3)  # rows between those fitted
    extremes = error[np.abs(error) > 0.99 * largest]
    signs = np.sign(extremes)
    assert 1 + int((np.diff(signs) != 0).sum()) == 4
    squares = lw.Task.function("log10(x)", fit="least squares", **_LOGARITHM).solve()
    assert largest < squares.delivered[0].error


_SLIDE = "cos(x) + sqrt(9 - (0.2 - sin(x))^2)"  # crank 1, rod 3, offset 0.2


@pytest.mark.parametrize(
    "how", [{}, {"spacing": "even"}, {"fit": "least squares"}, {"fit": "minimax"}]
)
def test_a_slider_crank_is_found_again_from_its_own_displacements(how: dict[str, str]) -> None:
    """The closed form of its displacement, in radians, is the function."""
    x = np.array([0.5, 2.0])
    ends = np.cos(x) + np.sqrt(9.0 - (0.2 - np.sin(x)) ** 2)
    task = lw.Task.function(
        _SLIDE, x=x, input=np.degrees(x), output=ends, mechanism="slider-crank", **how
    )  # fmt: skip
    found = task.solve()
    (design,) = found.defect_free
    points = found.delivered[0].points
    assert abs(points["A"]) == pytest.approx(1.0, abs=1e-9)
    assert abs(points["B"] - points["A"]) == pytest.approx(3.0, abs=1e-9)
    assert points["S"].imag == pytest.approx(0.2, abs=1e-9)
    motion = design.sweep()
    assert motion.certified.all()
    assert np.abs(motion["structural_error"]).max() < 1e-9
    inputs = np.radians(motion["crank"])
    closed = np.cos(inputs) + np.sqrt(9.0 - (0.2 - np.sin(inputs)) ** 2)
    assert motion["slide"] == pytest.approx(closed, abs=1e-9)


def test_structural_errors_of_the_logarithm_are_those_of_its_closed_form() -> None:
    """Freudenstein's four-bar: the rocker's angle by the law of cosines, against the formula."""
    (design,) = _designs(lw.Task.function("log10(x)", **_LOGARITHM))
    motion = design.sweep()
    a, c, b = 0.652585741, 1.170609286, 0.528110663
    crank = a * np.exp(1j * np.radians(motion["crank"]))
    base = 1.0 - crank
    along = (np.abs(base) ** 2 + b**2 - c**2) / (2.0 * b * np.abs(base))
    x = 1.0 + (motion["crank"] - 45.0) / 60.0
    wanted = 90.0 * np.log10(x) / np.log10(2.0)
    ways = [np.degrees(np.angle(-base) + side * np.arccos(along)) for side in (1.0, -1.0)]
    closed = min((way - wanted for way in ways), key=lambda error: np.abs(error).max())
    # nine digits of the published ratios
    assert motion["structural_error"] == pytest.approx(closed, abs=1e-6)
    zeros = np.sign(closed[:-1]) != np.sign(closed[1:])
    assert zeros.sum() == 3


@pytest.mark.parametrize("fit", ["least squares", "minimax"])
def test_a_rocker_is_found_again_from_its_own_angles(fit: str) -> None:
    a, c, b = 0.4, 1.2, 0.9
    u = np.radians(np.linspace(40.0, 130.0, 10))
    base = 1.0 - a * np.exp(1j * u)
    along = (np.abs(base) ** 2 + b**2 - c**2) / (2.0 * b * np.abs(base))
    v = np.angle(-base) - np.arccos(along)
    pairs = np.degrees(np.column_stack([u, v]))
    ends = {"input": pairs[[0, -1], 0].tolist(), "output": pairs[[0, -1], 1].tolist()}
    found = lw.Task.function(pairs.tolist(), fit=fit, mechanism="four-bar", **ends).solve()
    points = found.delivered[0].points
    lengths = [abs(points["A"]), abs(points["B"] - points["A"]), abs(points["B"] - 1.0)]
    assert lengths == pytest.approx([a, c, b], abs=1e-7)
    assert found.delivered[0].error < 1e-8


_STEP = [(90.0 * x, 60.0 * x**2 + 5.0 * np.sin(7.0 * x)) for x in np.linspace(0.0, 1.0, 11)]


def _closed_form(z: Array, slides: bool, side: float) -> Array:
    """Structural errors of a, b or e, c and both starts, by the law of cosines, in file units."""
    u, v = np.array(_STEP).T
    crank = z[0] * np.exp(1j * np.radians(u + z[3]))
    if slides:
        return np.asarray(
            crank.real + side * np.sqrt(z[2] ** 2 - (z[1] - crank.imag) ** 2) - v - z[4]
        )
    away = crank - 1.0
    turned = (np.abs(away) ** 2 + z[1] ** 2 - z[2] ** 2) / (2.0 * z[1] * np.abs(away))
    wrong = np.angle(away) - side * np.arccos(turned) - np.radians(v + z[4])
    return np.asarray(np.degrees(np.angle(np.exp(1j * wrong))))


@pytest.mark.parametrize("fit", ["least squares", "minimax"])
@pytest.mark.parametrize("slides", [False, True])
def test_fits_with_free_start_angles_are_those_of_scipy(slides: bool, fit: str) -> None:
    mechanism = "slider-crank" if slides else "four-bar"
    found = lw.Task.function(_STEP, fit=fit, mechanism=mechanism).solve()
    best = min(found.designs, key=lambda design: design.error)
    z = best.points
    b0 = z["S"] if slides else z["B0"]
    a, b, c = z["A"] - z["A0"], z["B"] - b0, z["B"] - z["A"]
    first = np.degrees(np.angle(a)), b.real if slides else np.degrees(np.angle(b))
    start = np.array([abs(a), b0.imag if slides else abs(b), abs(c), *first])
    side = np.sign(c.real if slides else (c.conjugate() * b).imag)
    errors = _closed_form(start, slides, side)
    start[4] += 0.5 * (errors.max() + errors.min()) if fit == "minimax" else errors.mean()
    wrong = _closed_form(start, slides, side)
    assert np.abs(wrong).max() == pytest.approx(best.error, rel=1e-9)
    near = start * (1.0 + 1e-5 * np.random.default_rng(2).uniform(-1.0, 1.0, 5))
    if fit == "least squares":
        ends = [
            least_squares(
                lambda q: _closed_form(q, slides, side), begin, x_scale=np.abs(start), xtol=1e-15,
                ftol=1e-15, gtol=1e-15,
            ).x
            for begin in (near, start)
        ]  # fmt: skip
        # SciPy finds nothing lower, also from the fit itself
        squares = [np.sum(_closed_form(q, slides, side) ** 2) for q in ends]
        assert np.sum(wrong**2) <= min(squares) * (1.0 + 1e-8)
        return
    # the largest error as a bound of all errors, by sequential quadratic programming
    scale = np.abs(start)

    def scaled(q: Array) -> Array:
        return _closed_form(q[:5] * scale, slides, side)

    referee = minimize(
        lambda q: q[5], [*near / scale, 2.0 * np.abs(wrong).max()], method="SLSQP",
        constraints=[
            {"type": "ineq", "fun": lambda q, sign=sign: q[5] - sign * scaled(q)}
            for sign in (1.0, -1.0)
        ],
        options={"ftol": 1e-14, "maxiter": 2000},
    )  # fmt: skip
    assert best.error <= referee.x[5] * (1.0 + 1e-7)
    assert "proved to be local minima" in found.message
    # six errors are equal
    assert np.sum(np.abs(wrong) > best.error * (1.0 - 1e-8)) == 6


def test_a_wanted_range_bounds_a_free_start_angle() -> None:
    wanted = {"input": {"from": 100.0, "to": 200.0}}
    task = {"fit": "minimax", "mechanism": "four-bar"}
    found = lw.Task.function(_STEP, wanted=wanted, **task).solve()
    assert min(design.error for design in found.delivered) < 5.0
    for design in found.delivered:
        assert min(design.inputs) >= 100.0 - 1e-9
        assert max(design.inputs) <= 200.0 + 1e-9
    with pytest.raises(MechanismError, match="spans 80, but the given inputs span 90"):
        lw.Task.function(_STEP, wanted={"input": {"from": 100.0, "to": 180.0}}, **task)


@pytest.mark.parametrize("fit", ["least squares", "minimax"])
def test_links_of_a_fit_without_wishes_for_lengths_are_in_proportion(fit: str) -> None:
    task = {"x": (0, 1.57), "input": (97, 187), "output": (60, 150), "mechanism": "four-bar"}

    def ratios(**tables: Any) -> tuple[str, list[float]]:
        found = lw.Task.function("sin(x)", fit=fit, **task, **tables).solve()
        told = " ".join([found.message, *remarks_on(found)])
        return told, [design.size / design.shortest for design in found.delivered]

    message, usual = ratios()
    assert "; lengths up to 20 times the shortest unless [wanted] bounds them" in message
    assert (
        "a longest link at the default bound, 20 times the shortest: 2. [wanted] lengths = {"
        in message
    )
    assert max(usual) == pytest.approx(20.0, rel=1e-3)
    assert max(ratios(wanted={"lengths": {"ratio": 40}})[1]) == pytest.approx(40.0, rel=1e-3)
    message, any_size = ratios(rank={"by": {"error": 1}})
    assert "a longest link over 20 times the shortest: " in message
    assert "unless [wanted]" not in message
    assert max(any_size) > 40.0  # how far it goes hangs on roundings: longer links gain little


_LEVEL = r"pairs  all have the output 0\.3, so that the output has no range"


@pytest.mark.parametrize("mechanism", ["four-bar", "slider-crank"])
@pytest.mark.parametrize("fit", [{}, {"fit": "minimax"}, {"fit": "least squares"}])
@pytest.mark.parametrize("outputs", [(0.3,) * 5, (0.3, 0.1 + 0.2, 0.3, 0.3, 0.3)])
def test_pairs_whose_outputs_are_equal_are_refused(
    mechanism: str, fit: dict[str, str], outputs: tuple[float, ...]
) -> None:
    pairs = list(zip((0, 10, 20, 30, 40), outputs, strict=True))
    with pytest.raises(MechanismError, match=_LEVEL):
        lw.Task.function(pairs, mechanism=mechanism, **fit)


@pytest.mark.parametrize(
    ("mechanism", "free"),
    [*product(("four-bar", "slider-crank"), (True, False)), ("watt-ii", False)],
)
@pytest.mark.parametrize(
    ("of", "end", "told"),
    [
        ("sin(x)", np.pi, "the value 0 at both ends"),
        ("sin(x)", 2.0 * np.pi, "the value 0 at both ends"),
        ("sin(x)", 3.14159, "the value 0 at both ends"),
        ("sin(x)^2 + cos(x)^2", 0.7, "the value.* at both ends"),
        ("9e307*cos(x)", 2.0 * np.pi, "the value 9e[+]307 at both ends"),
    ],
)  # fmt: skip
def test_a_function_that_comes_back_to_its_first_value_is_refused(
    mechanism: str, free: bool, of: str, end: float, told: str
) -> None:
    spans = {"input": 90, "output": 40} if free else {"input": (30, 120), "output": (40, 80)}
    with pytest.raises(MechanismError, match=f"of  has {told}, so that the output has no range$"):
        lw.Task.function(of, x=(0, end), mechanism=mechanism, **spans)


def test_a_range_of_the_output_that_is_small_beside_the_way_is_none_of_rounding() -> None:
    spans = {"x": (0, 3.14), "input": 90, "output": 0.04, "mechanism": "slider-crank"}
    goal = lw.Task.function("sin(x)", **spans).described.function
    assert goal is not None
    assert max(goal.dense_points()[1]) > 25.0


_OVER = "function.{}  spans outputs of more than a turn, {}"


@pytest.mark.parametrize("fit", [{}, {"fit": "minimax"}, {"fit": "least squares"}])
@pytest.mark.parametrize(
    ("spans", "told"),
    [
        ({"input": (0, 340), "output": (120, 60)}, ": cos(x) gives -2893 to 120"),
        ({"input": 340, "output": -60}, ": cos(x) gives -3013 to 0"),
        ({"input": (0, 1), "output": (1, 7.3), "angle": "rad"}, ": cos(x) gives 1 to 317.3"),
    ],
)
def test_an_angle_of_the_output_of_more_than_a_turn_is_refused(
    spans: dict[str, Any], told: str, fit: dict[str, str]
) -> None:
    turn = "6.28319" if "angle" in spans else "360"
    with pytest.raises(MechanismError, match=re.escape(_OVER.format("output", turn) + told)):
        lw.Task.function("cos(x)", x=(0, 6.0), mechanism="four-bar", **spans, **fit)
    pairs = [(0, 0), (20, 10), (40, 200), (60, 361)]
    with pytest.raises(MechanismError, match=_OVER.format("pairs", 360)):
        lw.Task.function(pairs, mechanism="four-bar", **fit)


def test_outputs_of_more_than_a_turn_are_refused_of_those_alone_that_cannot_have_them() -> None:
    """Displacements are lengths, a turn is none too many, and six-bars may make several."""
    spans: dict[str, Any] = {"x": (0, 1), "input": (0, 100)}
    lw.Task.function("x", output=(0, 500), mechanism="slider-crank", **spans)
    lw.Task.function("x", output=(40, 400), mechanism="four-bar", **spans)
    spans["mechanism"] = "watt-ii"
    with pytest.raises(MechanismError, match=r"360: x gives 0 to 361"):
        lw.Task.function("x", output=(0, 361), **spans)
    spans["input"] = (0, 400)
    lw.Task.function("x", output=(0, 400), **spans)


def test_pairs_of_a_real_four_bar_are_fitted_exactly() -> None:
    a, c, b = 0.4, 1.2, 0.9
    u = np.radians(np.linspace(40.0, 130.0, 10))
    base = 1.0 - a * np.exp(1j * u)
    along = (np.abs(base) ** 2 + b**2 - c**2) / (2.0 * b * np.abs(base))
    v = np.angle(-base) - np.arccos(along)
    found = lw.Task.function(np.degrees(np.column_stack([u, v])), fit="minimax",
                             mechanism="four-bar").solve()  # fmt: skip
    best = min(found.delivered, key=lambda design: design.error)
    assert best.error < 1e-9
    assert abs(best.points["A"]) == pytest.approx(a, abs=1e-6)
    assert best.inputs[0] == pytest.approx(40.0, abs=1e-4)


_SQUARE = {"x": (0, 1), "mechanism": "four-bar", "output": (0, 60)}


@pytest.mark.parametrize("fit", ["least squares", "minimax"])
def test_the_best_fit_with_given_starts_is_that_of_scipy_from_many_starts(fit: str) -> None:
    found = lw.Task.function("x^2", fit=fit, input=(30, 120), **_SQUARE).solve()
    assert "hardly closes" not in found.message
    u = np.radians(np.linspace(30.0, 120.0, 101))
    v = np.radians(60.0 * np.linspace(0.0, 1.0, 101) ** 2)
    ends, rng = [], np.random.default_rng(4)
    for start in np.exp(rng.normal(0.0, 1.0, (40, 3))) * rng.choice([-1, 1], (40, 3)):
        start[2] = abs(start[2])
        errors = rocker_errors(u, v, float(rng.choice([-1, 1])))
        if np.isfinite(errors(start)[0]).all():
            wrong = least_squares(
                lambda x, errors=errors: np.nan_to_num(errors(x)[0], nan=9.0), start
            ).fun
            ends.append(_miss(wrong, fit))
    assert len(ends) > 5
    best = min(_miss(_wrong(design, u, v), fit) for design in found.designs)
    assert best <= min(ends) * (1.0 + 1e-3)  # rows between those fitted


def _miss(wrong: Array, fit: str) -> float:
    return float(np.abs(wrong).max() if fit == "minimax" else np.sqrt((wrong**2).mean()))


def _wrong(design: Any, u: Array, v: Array) -> Array:
    """The structural errors of a design."""
    a, b = design.points["A"], design.points["B"]
    side = float(np.sign(((b - a).conjugate() * (b - 1.0)).imag))
    begin = complex(np.exp(1j * u[0])), complex(np.exp(1j * v[0]))
    lengths = np.array([(a / begin[0]).real, ((b - 1.0) / begin[1]).real, abs(b - a)])
    signs = np.sign(lengths[:2])
    lengths[:2] = signs * np.abs([a, b - 1.0])
    return rocker_errors(u, v, side)(lengths)[0]


@pytest.mark.parametrize("fit", ["least squares", "minimax"])
def test_a_fit_that_ends_where_its_loop_hardly_closes_may_be_no_local_minimum(fit: str) -> None:
    found = lw.Task.function("x^2", fit=fit, input=(0, 90), **_SQUARE).solve()
    (design,) = found.designs
    # a verdict that hangs on rounding has a number too: the lower bound 0
    hardly = design.transmission < 1.0
    assert hardly or design.transmission >= 1.0
    # along the edge rounding may lead a minimax fit away from it
    assert hardly or fit == "minimax"
    told = "the loop of the best one hardly closes: it may be no local minimum"
    assert (told in found.message) == hardly
    assert "fits from 75 starts" in repr(found)


def test_a_function_that_no_single_four_bar_is_determined_by_says_so() -> None:
    """Equal angles: any parallelogram has them, and the equations are singular."""
    same = {"x": (0, 1), "input": (0, 90), "output": (0, 90), "mechanism": "four-bar"}
    found = lw.Task.function("x", **same).solve()
    assert found.completeness is lw.Completeness.NOT_PROVED
    assert found.message.endswith("families of mechanisms, such as parallelograms, are not listed")
    assert not found.designs
    same |= {"input": (30, 120), "output": (30, 120)}
    fitted = lw.Task.function("x", fit="minimax", **same).solve()
    assert fitted.message.startswith("no result: no loop through three of the pairs")


def test_given_pivots_set_the_scale() -> None:
    pivots = {"fixed_pivots": [(10, 20), (110, 20)]}
    (design,) = _designs(lw.Task.function("log10(x)", given=pivots, **_LOGARITHM))
    position = design.solve(at=75)
    assert position.points["B0"] == (110.0, 20.0)
    assert position.links is not None
    radius = np.hypot(position.points["A"][0] - 10, position.points["A"][1] - 20)
    assert radius == pytest.approx(65.2585741, abs=1e-7)


@pytest.mark.parametrize("fit", ["least squares", "minimax"])
@pytest.mark.parametrize(
    ("mechanism", "wanted"),
    [
        ("four-bar", {"transmission": {"least": 40.0}}),
        ("four-bar", {"lengths": {"least": 0.75, "most": 1.3, "ratio": 1.6}}),
        # beyond the range of the formula, where the best fit has a dead point
        ("four-bar", {"input": {"from": 30.0, "to": 125.0}}),
        ("slider-crank", {"transmission": {"least": 40.0}}),
    ],
)
def test_fits_hold_the_wishes_that_the_best_fit_breaks(
    mechanism: str, wanted: dict[str, Any], fit: str
) -> None:
    task = {**_LOGARITHM, "mechanism": mechanism, "fit": fit}
    free = lw.Task.function("log10(x)", **task).solve()
    found = lw.Task.function("log10(x)", wanted=wanted, **task).solve()
    (design,) = found.delivered
    assert free.delivered[0].error < design.error < 6.0 * free.delivered[0].error
    assert design.transmission >= wanted.get("transmission", {}).get("least", 0.0)


def test_a_wanted_range_is_measured_like_the_input_of_a_crank_that_points_back() -> None:
    wanted = {"input": {"from": -40.0, "to": 65.0}}
    task = {"x": (0, 1), "input": (-32, 60), "output": (200, 260), "mechanism": "four-bar"}
    (design,) = _designs(lw.Task.function("x^2", wanted=wanted, **task))
    assert design.sweep().inputs["crank"][[0, -1]] == pytest.approx([-40.0, 65.0])


@pytest.mark.parametrize("slides", [False, True])
@pytest.mark.parametrize("asked", [None, Range(start=0.5, stop=1.5), Range(turn=True)])
def test_wishes_of_fits_have_the_derivatives_of_their_differences(
    slides: bool, asked: Range | None
) -> None:
    wishes = Wishes(range=asked, transmission=1.5, shortest=4.0, longest=0.1, ratio=1.01)
    held = FunctionWishes(wishes, np.array([0.0, 1.0]), 1.3, slides, 1)
    x, lane = np.array([[-0.9, -0.4, 1.7, 0.3, 0.2]]), np.zeros(1, dtype=np.intp)
    h, by_x = held.broken(x, lane)
    assert (h > 0.0).sum() > 4
    for k in range(5):
        step = 1e-6 * np.eye(5)[k]
        difference = (held.broken(x + step, lane)[0] - held.broken(x - step, lane)[0]) / 2e-6
        assert by_x[:, :, k] == pytest.approx(difference, abs=1e-7)


@pytest.mark.parametrize("mechanism", ["four-bar", "slider-crank"])
def test_a_formula_whose_ranges_begin_anywhere_is_met_at_five_points(mechanism: str) -> None:
    spans = {"x": (1, 2), "input": 60, "output": 50, "mechanism": mechanism}
    found = lw.Task.function("log10(x)", **spans).solve()
    assert (found.complex, found.real) == (3, 1)
    (design,) = found.delivered
    share = 0.5 - 0.5 * np.cos((2 * np.arange(1, 6) - 1) * np.pi / 10)
    bar, output = lw.Mechanism(design.linkage), {"four-bar": "rocker", "slider-crank": "slide"}
    positions = [bar.solve(at=float(a)) for a in design.inputs]
    values = np.array([position[output[mechanism]] for position in positions])
    assert [p["structural_error"] for p in positions] == pytest.approx([0.0] * 5, abs=1e-9)
    assert np.diff(design.inputs) == pytest.approx(60.0 * np.diff(share), abs=1e-9)
    assert np.diff(values) == pytest.approx(50.0 * np.diff(np.log2(1.0 + share)), abs=1e-6)
    fitted = lw.Task.function("log10(x)", fit="minimax", **spans).solve()
    assert min(d.error for d in fitted.delivered) < 0.01
    sizes = np.sort([d.size for d in fitted.designs])
    assert (np.diff(sizes) > 1e-3 * sizes[:-1]).all()  # ends in one valley count once


@pytest.mark.parametrize("fit", ["least squares", "minimax"])
@pytest.mark.parametrize(
    ("mechanism", "wanted", "begin"),
    [
        ("four-bar", {}, (0.0, 360.0)),
        ("four-bar", {"input": {"from": -40.0, "to": 20.0}}, (-40.0, -40.0)),
        ("slider-crank", {}, (0.0, 360.0)),
    ],
)
def test_a_fit_whose_start_angles_were_found_has_its_structural_error(
    mechanism: str, wanted: dict[str, Any], begin: tuple[float, float], fit: str
) -> None:
    spans = {"x": (1, 2), "input": 60, "output": 50, "mechanism": mechanism, "wanted": wanted}
    found = lw.Task.function("log10(x)", fit=fit, **spans).solve()
    assert found.delivered
    for design in found.delivered:
        motion = lw.Mechanism(design.linkage).sweep(certify=False)
        assert np.abs(motion["structural_error"]).max() == pytest.approx(design.error, rel=2e-3)
        assert begin[0] - 1e-9 <= motion.inputs["crank"][0] <= begin[1] + 1e-9


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        ({"input": 60, "output": (0, 90)}, "has no start, unlike the other one"),
        ({"input": 60, "output": 90, "mechanism": "watt-ii"}, "must be a range with its start"),
        (
            {"input": 60, "output": 90, "positions": 6},
            "6 precision points leave no four-bar with f",
        ),
        (
            {"input": 60, "output": 90, "wanted": {"input": {"from": 0, "to": 50}}},
            "spans 50, but the given inputs span 60",
        ),
        (
            {**_LOGARITHM, "fit": "minimax", "wanted": {"input": {"from": 50, "to": 100}}},
            "from 50 to 100 leaves out inputs of the function, which are from 45 to 105: move",
        ),
        (
            {**_LOGARITHM, "wanted": {"input": {"from": 410, "to": 460}}},
            "from 410 to 460 leaves out inputs of the function, which are from 405 to 465",
        ),
        ({**_LOGARITHM, "input": (0, 400)}, "input  spans inputs of more than a turn, 360"),
        ({**_LOGARITHM, "wanted": {"lengths": {"least": 50}}}, "exclude the ground of length 1: "),
    ],
)
def test_ranges_and_wishes_that_no_loop_has_are_refused(
    tables: dict[str, Any], message: str
) -> None:
    with pytest.raises(MechanismError, match=message):
        lw.Task.function("log10(x)", **{"x": (1, 2), "mechanism": "four-bar", **tables})


def test_a_function_with_a_pole_in_its_range_is_refused() -> None:
    with pytest.raises(MechanismError, match=r"of  jumps by 943.5 near x = 1.567"):
        lw.Task.function("tan(x)", **{**_LOGARITHM, "x": (1, 2)})


@pytest.mark.parametrize(
    ("mechanism", "ends", "output"),
    [
        ("four-bar", (-32, 60), (200, 260)),
        ("four-bar", (300, 390), (170, 200)),
        ("slider-crank", (500, 590), (20, 80)),
    ],
)
def test_the_structural_error_holds_in_whatever_turn_angles_are_counted(
    mechanism: str, ends: tuple[float, float], output: tuple[float, float]
) -> None:
    task = {"x": (0, 1), "input": ends, "output": output, "mechanism": mechanism}
    found = lw.Task.function("x^2", fit="minimax", **task).solve()
    motion = lw.Mechanism(found.delivered[0].linkage).sweep(certify=False)
    assert motion.inputs["crank"][[0, -1]] == pytest.approx(ends)
    error = np.abs(motion["structural_error"]).max()
    assert error == pytest.approx(found.delivered[0].error, rel=2e-3)


def test_a_range_that_touches_a_dead_point_is_not_proved() -> None:
    task = lw.Task.function(
        "sin(x)", x=(0, 1.5), input=(200, 290), output=(10, 70), mechanism="four-bar", fit="minimax"
    )
    (design,) = task.solve().designs
    (defect,) = design.defects
    assert defect.message == "not proved: to rounding, the driven range touches a dead point"


@pytest.mark.parametrize(("x", "ends"), [((0, 1), (10.0, 90.0)), ((1, 0), (90.0, 10.0))])
def test_a_dead_point_behind_the_precision_points_is_in_the_range_of_a_function(
    x: tuple[float, float], ends: tuple[float, float]
) -> None:
    """The last one is at 84.64 deg, the dead point at 84.84 deg."""
    output = tuple(50.0 + 100.0 * number**2 for number in x)
    task = lw.Task.function("x^2", x=x, input=ends, output=output, mechanism="four-bar")
    (design,) = task.solve().designs
    message = design.defects[0].message
    expected = "the driven range passes a dead point: the branch ends at 275.2° and 84.8°"
    assert message == expected
    # as pairs the same points leave nothing behind them
    outputs = 50.0 + 100.0 * ((np.array(design.inputs) - 10.0) / 80.0) ** 2
    given = {"input": design.inputs[:: len(design.inputs) - 1], "output": outputs[[0, -1]]}
    pairs = np.stack([design.inputs, outputs], axis=1).tolist()
    (alone,) = lw.Task.function(pairs, mechanism="four-bar", **given).solve().delivered
    assert alone.size == pytest.approx(design.size)


@pytest.mark.parametrize(
    ("given", "ends"),
    [
        ({"input": (120, 180), "output": (200, 290)}, (120.0, 180.0)),
        ({"x": (1, 0), "input": (180, 120), "output": (290, 200)}, (180.0, 120.0)),
        ({"input": 60, "output": 90}, None),
        ({"input": -60, "output": -90}, None),
    ],
)
def test_the_file_of_a_design_is_driven_through_the_whole_range_of_its_function(
    given: dict[str, Any], ends: tuple[float, float] | None
) -> None:
    task = lw.Task.function("x^2", **{"x": (0, 1), "mechanism": "four-bar", **given})
    design = task.solve().delivered[0]
    inputs = lw.Mechanism(design.linkage).sweep().inputs["crank"]
    if ends is None:
        # the first of five precision points is 1.468 deg behind the begin
        turn = np.sign(given["input"])
        assert inputs[-1] - inputs[0] == pytest.approx(given["input"])
        assert design.inputs[0] - inputs[0] == pytest.approx(1.4683 * turn, abs=1e-4)
    else:
        assert inputs[[0, -1]] == pytest.approx(ends)


def test_a_wanted_range_holds_the_whole_range_of_a_function_that_begins_anywhere() -> None:
    spans = {"x": (1, 2), "input": 60, "output": 50, "mechanism": "four-bar"}
    (free,) = lw.Task.function("log10(x)", **spans).solve().delivered
    begin, end = free.inputs[0], free.inputs[-1]
    for low, high, kept in ((-2.0, 2.0, 1), (-1.0, 2.0, 0), (-2.0, 1.0, 0)):
        wanted = {"input": {"from": begin + low, "to": end + high}}
        designs = lw.Task.function("log10(x)", wanted=wanted, **spans).solve().designs
        assert len([d for d in designs if not d.kinds]) == kept
        told = "an end of the function's range is outside the driven range"
        assert kept or told in [defect.message for defect in designs[0].defects]


def test_an_angle_of_the_formula_in_degrees_is_remarked_on() -> None:
    ends = {"input": (97, 187), "output": (60, 150), "mechanism": "four-bar"}
    told = "; x is in radians in sin(x), and 90 are 14.3 turns"
    hundredth = lw.Task.function("sin(x*0.01)", x=(0, 90), **ends).solve()
    assert "radians" not in hundredth.message
    assert lw.Task.function("sin(x)", x=(0, 90), **ends).solve().message.endswith(told)
    for of, x in (("sin(x)", (0, 1.5)), ("x^2", (0, 90))):
        assert "radians" not in lw.Task.function(of, x=x, **ends).solve().message


def test_a_range_that_passes_a_dead_point_does_not_touch_one_besides() -> None:
    points = [(250, 0), (520, 100), (600, 250), (350, 300)]
    found = lw.Task.path(points, wanted={"input": "turns fully"}).solve()
    kind = lw.synthesis.DefectKind.RANGE
    passing = [design for design in found.designs if kind in design.kinds]
    assert passing
    assert not any("touches a dead point" in d.message for e in passing for d in e.defects)


def test_a_slider_crank_that_would_grow_without_end_is_bounded_by_its_output() -> None:
    """Ever longer cranks and rods follow these pairs ever better, by ever less."""
    pairs = [(0, 0), (30, 12), (40, 18.3), (50, 24.5), (60, 32), (70, 40)]
    found = lw.Task.function(pairs, mechanism="slider-crank", fit="minimax").solve()
    assert max(design.size for design in found.designs) == pytest.approx(800.0, rel=1e-3)
    assert "20 times the shortest and the size of the output" in found.message
    bounds = {"lengths": {"most": 1200}}
    wide = lw.Task.function(pairs, mechanism="slider-crank", fit="minimax", wanted=bounds).solve()
    assert max(design.size for design in wide.designs) == pytest.approx(1200.0, rel=1e-3)


@pytest.mark.parametrize("fit", ["least squares", "minimax"])
def test_a_slider_that_begins_far_from_the_crank_is_reached(fit: str) -> None:
    task = {"x": (0, 1), "input": (20, 110), "output": (300, 310), "mechanism": "slider-crank"}
    (best,) = lw.Task.function("x^2", fit=fit, **task).solve().delivered
    assert best.error < 5.3
