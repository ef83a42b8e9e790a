"""Offline pages that solve: the printed solver is Python's, and the page shows what it solved."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import linkwork as lw
from linkwork.app.pages.animation import solving_page
from linkwork.core.commands.main import linkwork
from linkwork.core.foundation.errors import InputError
from linkwork.core.mechanism.varied_numbers import varied_numbers, with_numbers
from linkwork.core.record.printing import PYTHON, C
from linkwork.families.printed_solver import print_solver
from linkwork.families.recorded_design import record_design
from tests.app.printed_march import PlainMarch, imported

CASES = {
    "four-bar": (["O2 A", "A B"], [[41.0, 117.0], [40.0, 45.0]]),
    "slider-crank": (["O2 A", "B A"], [[45.0, 125.0], [60.0, 76.0], [60.0, 70.0]]),
    "jansen-leg": (["O A", "A B", "P B"], [[15.5, 51.0, 41.0], [15.0, 60.0, 41.5]]),
    "stephenson-far-crank": (["O2 A", "A B"], []),
    "double-four-bar": (["beta"], []),
    "whitworth": (["r", "d"], [[110.0, 62.0]]),
    "ackermann-steering": (["arm"], []),
    "scissor-lift": (["l"], []),
    "five-bar-robot": (["O1 E1", "O2 E2"], []),
    "excavator": (["O B", "O N"], []),
    "kempe-translator": (["A C", "B D"], []),
    "three-rpr": (["B1 B2", "B2 B3"], []),
}


@pytest.fixture
def open_solving(browser: Any, tmp_path: Path) -> Iterator[Callable[..., Any]]:
    """Opens a page with sliders from a file; fails on any message of the console."""
    said: list[str] = []
    contexts = []

    def opened(name: str, sliders: list[str], **options: Any) -> Any:
        target = tmp_path / f"{name}.html"
        lw.example(name).animate(target, sliders=sliders)
        context = browser.new_context(offline=True, reduced_motion="reduce", **options)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda r: None if r.url.startswith("file:") else said.append(r.url))
        page.goto(target.as_uri())
        page.wait_for_selector(".lw-sliders")
        return page

    yield opened
    for context in contexts:
        context.close()
    assert said == []


def values_near(mechanism: lw.Mechanism, names: list[str], given: list[list[float]]) -> Any:
    own = record_design(mechanism.model, names)
    base = [float(q.of(mechanism.model.description)) for q in own.quantities]
    return [base, [1.004 * value for value in base], *given]


def found_in(page: Any, numbers: list[float]) -> dict[str, Any]:
    script = """x => { const f = linkworkSolver.found(x); return {fits: f.fits, t: [...f.t],
        v: [...f.v], radius: [...f.radius], ends: f.ends, d: [...f.d]}; }"""
    found: dict[str, Any] = page.evaluate(script, numbers)
    return found


def some(names: Iterable[str], *first: str) -> list[Any]:
    """The same names, all but some for the extended tests."""
    extended = pytest.mark.extended
    return [name if name in first else pytest.param(name, marks=extended) for name in names]


@pytest.mark.parametrize("name", some(CASES, "four-bar", "slider-crank", "five-bar-robot"))
def test_the_page_solves_designs_as_python_does(name: str, open_solving: Any) -> None:
    names, given = CASES[name]
    mechanism = lw.example(name)
    page = open_solving(name, names)
    several = values_near(mechanism, names, given)
    family = mechanism.family(dict(zip(names, np.array(several).T, strict=True))).sweep()
    size, unknowns = family.designs.length_scale.max(), len(family.rows.v)
    for k, numbers in enumerate(several):
        found = found_in(page, numbers)
        assert found["fits"]
        there, rows = family.found[k], len(family.inputs)
        rising = -1 if mechanism.model.rows[-1, 0] < mechanism.model.rows[0, 0] else 1
        v = np.array(found["v"]).reshape(rows, unknowns)[::rising]
        radius = np.array(found["radius"])[::rising]
        assert np.isfinite(v).all(axis=1).tolist() == there.tolist()
        near = np.abs(v - family.rows.v[:, :, k].T)[there]
        # both are proved: each is within its radius of the true position
        reach = (radius + family.radius[k])[there] * max(1.0, float(size))
        assert (near <= 2.0 * reach[:, None] + 1e-14 * size).all()
        assert (radius[there] < 1e-10).all()


@pytest.mark.parametrize(
    "name",
    some(["four-bar", "slider-crank", "jansen-leg", "stephenson-far-crank"], "four-bar"),
)
def test_a_cycle_in_the_page_is_that_of_python_bit_by_bit(
    name: str, open_solving: Any, tmp_path: Path
) -> None:
    names, given = CASES[name]
    mechanism = lw.example(name)
    page = open_solving(name, names)
    motion = mechanism.sweep()
    design = record_design(mechanism.model, names)
    data = solving_page(mechanism, names, motion).data
    printed = print_solver(
        design, PYTHON, points=list(motion.points), columns=data.columns, turns=[]
    )
    march = PlainMarch(imported(printed, tmp_path), printed, data)
    rows = np.sort(mechanism.model.rows[:, 0])
    for numbers in values_near(mechanism, names, given)[1:]:
        expected = march.solve(numbers, rows)
        found = found_in(page, numbers)
        v = np.array(found["v"]).reshape(len(rows), -1)
        straight = np.isfinite(expected[:, 0])
        assert straight.any() == np.isfinite(v).any()
        assert np.array_equal(v[straight], expected[straight, :-1])
        assert np.array_equal(np.array(found["radius"])[straight], expected[straight, -1])


@pytest.mark.parametrize(
    "name", some(["four-bar", "slider-crank", "jansen-leg", "whitworth"], "whitworth")
)
def test_the_page_shows_points_columns_and_rates_of_the_changed_mechanism(
    name: str, open_solving: Any
) -> None:
    names, _ = CASES[name]
    mechanism = lw.example(name)
    page = open_solving(name, names)
    description, quantities = (
        mechanism.description,
        record_design(mechanism.model, names).quantities,
    )
    numbers = [1.01 * float(q.of(description)) for q in quantities]
    changed = lw.Mechanism(with_numbers(description, dict(zip(quantities, numbers, strict=True))))
    motion = changed.sweep()
    fields = page.locator(".lw-slider input[type=number]").all()
    for field, number in zip(fields, numbers, strict=True):
        field.fill(repr(number))
        field.press("Tab")
    page.wait_for_timeout(100)
    for row in (0, 77, 200):
        page.evaluate("row => linkwork.goToRow(row)", row)
        page.wait_for_timeout(60)
        shown = page.evaluate("() => ({...linkwork.values})")
        for column, value in shown.items():
            expected = motion.inputs[column] if column in motion.inputs else motion[column]
            near = pytest.approx(expected[row], rel=1e-9, abs=1e-9 * max(numbers), nan_ok=True)
            assert value == near
    drawn = page.evaluate(
        """x => { const { page } = linkworkSolver.at(x);
        return page.motions[0].points.map(p => [p.name, ...["x", "dx", "ddx", "y", "dy", "ddy"]
            .map(k => linkworkSolver.numbers(p[k])[77])]); }""",
        numbers,
    )
    for point, *values in drawn:
        x, y = motion.points[point]
        own = [c[77] for one in (x, y) for c in (one.value, one.first, one.second)]
        assert values == pytest.approx(own, rel=1e-8, abs=1e-9 * max(numbers))


def test_lengths_are_dragged_and_the_whole_cycle_is_drawn_again(open_solving: Any) -> None:
    page = open_solving("four-bar", ["O2 A", "A B"])
    row = page.locator('[data-number="A B"]')
    before = page.locator(".lw-shapes").inner_html()
    row.locator("input[type=range]").focus()
    for _ in range(4):
        page.keyboard.press("ArrowRight")
    page.wait_for_timeout(200)
    assert page.locator(".lw-shapes").inner_html() != before
    assert float(row.locator("input[type=number]").input_value()) > 120.0
    assert page.locator(".lw-summary").inner_text() == "361 positions found, each proved"
    page.get_by_role("button", name="Reset").click()
    page.wait_for_timeout(200)
    assert float(row.locator("input[type=number]").input_value()) == 120.0
    assert page.locator(".lw-shapes").inner_html() == before


def test_the_page_says_where_the_branch_ends_and_where_nothing_is(open_solving: Any) -> None:
    page = open_solving("four-bar", ["A B"], viewport={"width": 390, "height": 844})
    field = page.locator('[data-number="A B"] input[type=number]')
    field.fill("45")
    field.press("Enter")
    page.wait_for_timeout(200)
    family = lw.example("four-bar").family({"A B": [45.0]}).sweep()
    told = page.locator(".lw-ends").inner_text().replace("−", "-")
    ends = sorted(float(x) for x in re.findall(r"-?\d+\.\d+", told))
    limits = [family.limits.lower[0], family.limits.upper[0]]
    assert ends == pytest.approx(limits, abs=1e-3)
    assert page.locator(".lw-chart .lw-limit, .lw-chart circle").count() > 2
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    field.fill("1")
    field.press("Enter")
    page.wait_for_timeout(200)
    assert "no position" in page.locator(".lw-ends").inner_text()
    assert page.locator(".lw-nothing").count() == 1
    page.get_by_role("button", name="Reset").click()
    page.wait_for_timeout(200)
    assert page.locator(".lw-nothing").count() == 0
    assert page.locator(".lw-ends").inner_text() == ""


def test_numbers_without_a_mechanism_are_refused_by_the_page(open_solving: Any) -> None:
    page = open_solving("jansen-leg", ["P B"])
    for number in ("-3", "0", "1e300", "700"):
        field = page.locator('[data-number="P B"] input[type=number]')
        field.fill(number)
        field.press("Enter")
        page.wait_for_timeout(100)
        assert page.locator(".lw-ends").inner_text() != ""
        assert page.locator(".lw-nothing").count() == 1


def test_a_page_that_solves_is_small(tmp_path: Path) -> None:
    leg = lw.example("jansen-leg")
    leg.animate(tmp_path / "plain.html", motion=leg.sweep())
    leg.animate(tmp_path / "solving.html", sliders=["O A", "A B", "P B"])
    more = (tmp_path / "solving.html").stat().st_size - (tmp_path / "plain.html").stat().st_size
    assert more < 60_000


@pytest.mark.parametrize(
    ("name", "sliders", "words"),
    [
        ("four-bar", ["O2 C"], "is not a number of"),
        ("four-bar", ["O2 A", "A O2"], "is named twice"),
        ("eccentric-cam", ["F.x"], "has cams"),
        ("geared-five-bar", ["f"], "changes the form of the equations"),
    ],
)
def test_what_cannot_have_a_slider_says_why(
    name: str, sliders: list[str], words: str, tmp_path: Path
) -> None:
    mechanism = lw.example(name)
    with pytest.raises(lw.InputError, match=words):
        mechanism.animate(tmp_path / "page.html", sliders=sliders)
    assert not (tmp_path / "page.html").exists()


@pytest.mark.parametrize("options", [{"all_circuits": True}, {"motion": "own"}, {"suffix": "gif"}])
def test_sliders_are_for_pages_of_one_sweep(options: dict[str, Any], tmp_path: Path) -> None:
    mechanism = lw.example("four-bar")
    suffix = options.pop("suffix", "html")
    if "motion" in options:
        options["motion"] = mechanism.sweep()
    with pytest.raises(lw.InputError, match="sliders are for a page of one sweep"):
        mechanism.animate(tmp_path / f"page.{suffix}", sliders=["O2 A"], **options)


def test_an_output_that_cannot_be_recorded_is_left_out(tmp_path: Path) -> None:
    file = tmp_path / "four-bar.toml"
    lw.example("four-bar").save(file)
    text = file.read_text("utf-8")
    mechanism = lw.loads(text.replace("[outputs]", '[outputs]\ngrowth = "exp(rocker / 100)"'))
    motion = mechanism.sweep()
    assert "growth" in motion.outputs
    columns = solving_page(mechanism, ["A B"], motion).data.columns
    assert "mu" in columns
    assert "growth" not in columns


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_the_same_solver_printed_in_c_gives_the_same_bits(tmp_path: Path) -> None:
    mechanism = lw.example("jansen-leg")
    design = record_design(mechanism.model, ["O A"])
    asked = {"points": ["F"], "columns": ["B.transmission"], "turns": []}
    in_c, in_python = (print_solver(design, own, **asked) for own in (C, PYTHON))
    functions = imported(in_python, tmp_path)
    sine = "void sin_cos(double x, double *s, double *c) { *s = 0.25 * x; *c = 1.0 - 0.5 * x; }"
    text = f"#include <math.h>\n{sine}\n{in_c.source.replace('static void', 'void')}"
    (tmp_path / "solver.c").write_text(text, "utf-8")
    library = tmp_path / "solver.so"
    flags = ["-O2", "-ffp-contract=off", "-shared", "-fPIC", "-lm"]
    subprocess.run(["cc", "solver.c", *flags, "-o", str(library)], cwd=tmp_path, check=True)
    functions.sin_cos = lambda x: (0.25 * x, 1.0 - 0.5 * x)
    rng = np.random.default_rng(3)
    compiled = ctypes.CDLL(str(library))
    for name in ("design", "reach", "given", "begin0", "damped1", "iterate2", "prove0", "agree"):
        sizes = [1, in_c.design] if name == "design" else [in_c.state]
        given = [rng.normal(1.0, 0.3, size) for size in sizes]
        lists = [array.tolist() for array in given]
        getattr(functions, name)(*lists)
        pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in given]
        getattr(compiled, name)(*pointers)
        for array, own in zip(given, lists, strict=True):
            assert array.tolist() == own


def test_the_command_writes_a_page_with_sliders(tmp_path: Path) -> None:
    target = tmp_path / "page.html"
    file = tmp_path / "four-bar.toml"
    lw.example("four-bar").save(file)
    command = ["animate", str(file), "-o", str(target), "--sliders", "O2 A", "--sliders", "A B"]
    done = CliRunner().invoke(linkwork, command, prog_name="linkwork")
    assert done.exit_code == 0, done.output
    assert "linkworkProgram=" in target.read_text("utf-8")
    for more, words in ((["--all"], "--sliders needs a page"), (["--sliders", "X Y"], "X Y")):
        done = CliRunner().invoke(linkwork, [*command, *more], prog_name="linkwork")
        assert done.exit_code != 0
        assert words in done.output


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("cam-roller-follower", "has cams, curves or formulas among its equations"),
        ("scissor-three-bars", "has redundant links"),
    ],
)
def test_a_page_that_cannot_solve_says_why(name: str, reason: str) -> None:
    mechanism = lw.example(name)
    own = next(iter(varied_numbers(mechanism.description))).name
    with pytest.raises(InputError, match=reason):
        record_design(mechanism.model, [own])
