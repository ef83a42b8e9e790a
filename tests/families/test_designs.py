"""Families: every design has the equations that it has by itself."""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import linkwork as lw
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, MechanismError, UnknownNameError
from linkwork.core.mechanism import link_shape as nearest_shape
from linkwork.core.mechanism.varied_numbers import VariedNumber, varied_numbers
from linkwork.families import building
from linkwork.families.building import designs_of
from tests.families.single_design import agree
from tests.thinned import thinned

FOUR_BAR = {
    "points": {"O2": (0, 0), "A": (20, 35), "B": (120, 70), "O4": ("d", 0), "P": (60, 90)},
    "links": {
        "ground": ("O2", "O4"),
        "crank": ("O2", "A"),
        "coupler": ("A", "B", "P"),
        "rocker": ("O4", "B"),
    },
    "lengths": {"O2 A": "a", "A B": "2*b", "O4 B": 80, "A P": 70, "B P": "sqrt(b)*8"},
    "dimensions": {"a": 40, "b": 55, "d": "a + 60"},
    "inputs": lw.Input(link="crank"),
}


def _four_bar(**changed: object) -> lw.Mechanism:
    return lw.linkage(**{**FOUR_BAR, **changed})


def _slider_crank(offset: float | str = 0) -> lw.Mechanism:
    return lw.linkage(
        points={"O": (0, 0), "A": (10, 30), "B": (120, 0), "S": (-1, 0), "T": (1, 0)},
        links={
            "ground": ("O", "S", "T"),
            "crank": ("O", "A"),
            "rod": ("A", "B"),
            "piston": ("B",),
        },
        lengths={"O A": 32, "A B": 115},
        sliders=[
            lw.Slider(
                name="s", link="piston", points=("B",), on="ground", line=("S", "T"), offset=offset
            )
        ],
        inputs=lw.Input(link="crank"),
    )  # fmt: skip


def _varied(
    mechanism: lw.Mechanism,
    chosen: list[VariedNumber],
    spread: float,
    rng: np.random.Generator,
    count: int = 3,
) -> dict[str, Array]:
    size = mechanism.model.equations.length_scale
    found = {}
    for quantity in chosen:
        value = quantity.of(mechanism.description)
        factor = rng.uniform(1.0 - spread, 1.0 + spread, count)
        found[quantity.name] = value * factor if value else 0.1 * size * (factor - 1.0)
    return found


@pytest.mark.parametrize("name", thinned(lw.examples()))
def test_every_kind_of_number_of_every_library_mechanism_varies_as_by_itself(name: str) -> None:
    mechanism, rng = lw.example(name), np.random.default_rng(7)
    tables: dict[str, list[VariedNumber]] = {}
    for quantity in varied_numbers(mechanism.description):
        tables.setdefault(quantity.table, []).append(quantity)
    for chosen in tables.values():
        agree(designs_of(mechanism, _varied(mechanism, chosen, 1e-3, rng)), 1e-13)
        one = [chosen[rng.integers(len(chosen))]]
        agree(designs_of(mechanism, _varied(mechanism, one, 0.2, rng)), 1e-13)


def test_the_mechanism_itself_is_the_base_and_the_order_is_its_own() -> None:
    mechanism = _four_bar()
    designs = designs_of(mechanism, {"a": [40.0, 41.0]})
    assert designs.base is mechanism.model
    table = mechanism.model.compiled.table
    np.testing.assert_allclose(designs.loops[0], table.loops.coefficient, rtol=0, atol=1e-13)
    np.testing.assert_allclose(designs.start[0], mechanism.model.equations.start, rtol=1e-15)


def test_keys_of_every_kind_are_found_in_any_spelling() -> None:
    designs = designs_of(
        _four_bar(angles={"P A B": 300.0}, lengths={"O2 A": 40, "A B": 110, "O4 B": 80, "A P": 70}),
        {"A O2": [38.0, 41.0], "P A B": [301.0, 305.0], "O4.x": 99.0, "O4.y": [0.0, 3.0], "b": 5.0},
    )
    assert [q.table for q in designs.quantities] == [
        "lengths", "angles", "points", "points", "dimensions",
    ]  # fmt: skip
    assert not designs.problem.any()
    agree(designs)


def test_formulas_of_what_varies_follow_it() -> None:
    rng = np.random.default_rng(3)
    designs = designs_of(_four_bar(), {"a": rng.uniform(35, 45, 20), "b": rng.uniform(50, 60, 20)})
    assert not designs.problem.any()
    names = list(designs.base.equations.dimensions)
    np.testing.assert_allclose(
        designs.numbers[:, names.index("d")], designs.dimensions["a"] + 60, rtol=1e-15
    )
    agree(designs)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.floats(1e-3, 300) | st.sampled_from([0.0, -40.0, np.nan, np.inf, -np.inf, 1e200]),
            st.floats(1e-3, 300) | st.sampled_from([55.0, -1.0, 0.0]),
            st.floats(-300, 300),
        ),
        min_size=1,
        max_size=6,
    )
)  # fmt: skip
def test_any_numbers_give_a_design_or_the_problem_that_it_has_by_itself(
    rows: list[tuple[float, float, float]],
) -> None:
    a, b, y = (np.array(column) for column in zip(*rows, strict=True))
    agree(designs_of(_four_bar(), {"a": a, "b": b, "P.y": y}))


def test_one_bad_design_leaves_the_others_alone() -> None:
    a = np.full(50, 40.0)
    a[[3, 17, 31]] = [-5.0, np.nan, np.inf]
    designs = designs_of(_four_bar(), {"a": a})
    assert np.flatnonzero(designs.problem).tolist() == [3, 17, 31]
    assert designs.message(3).endswith('lengths."O2 A"  must be a positive length, got -5')
    assert "must be a finite number, got nan" in designs.message(17)
    assert "must be a finite number, got inf" in designs.message(31)
    assert designs.message(4) == ""
    agree(designs)


def test_no_triangle_is_told_with_the_design_s_own_lengths() -> None:
    designs = designs_of(_four_bar(), {"A P": [70.0, 400.0, 500.0, 71.0]})
    assert designs.problem.tolist() == [0, 1, 1, 0]
    assert "no triangle has |AB| = 110, |AP| = … and |BP| = 59.3" in designs.problems[1]
    assert "|AP| = 500" in designs.message(2)
    agree(designs)


def test_mirror_images_follow_the_sketch_of_each_design() -> None:
    designs = designs_of(_four_bar(), {"P.y": [90.0, -90.0, 20.0, 80.0], "P.x": 60.0})
    assert not designs.problem.any()
    agree(designs)
    above, below = designs.points[0], designs.points[1]
    assert np.abs(above - below).max() > 10.0


def test_an_offset_of_zero_keeps_its_term_where_it_varies() -> None:
    mechanism = _slider_crank()
    terms = len(mechanism.model.compiled.table.loops.row)
    designs = designs_of(mechanism, {"s.offset": [-7.0, 0.0, 12.0]})
    assert not designs.problem.any()
    assert designs.loops.shape == (3, terms + 1)
    assert len(designs.base.compiled.table.loops.row) == terms + 1
    agree(designs)
    alike = designs_of(_slider_crank(5), {"s.offset": [-7.0, 0.0, 12.0]})
    assert len(alike.base.compiled.table.loops.row) == terms + 1
    agree(alike)


def test_gears_of_another_ratio_have_another_structure_and_scaled_ones_do_not() -> None:
    mechanism = lw.example("geared-five-bar")
    factor = np.array([1.0, 1.1, 1.3, 1.0])
    numbers = {q.name: q.of(mechanism.description) for q in varied_numbers(mechanism.description)}
    dimensions = [q.name for q in varied_numbers(mechanism.description) if q.table == "dimensions"]
    scaled = {name: numbers[name] * factor for name in dimensions}
    agree(designs_of(mechanism, scaled))


def test_gear_ratios_of_designs_stand_apart() -> None:
    mechanism = lw.linkage(
        points={"O": (0, 0), "P": (30, 0), "A": (0, 5), "B": (30, 5)},
        links={"ground": ("O", "P"), "one": ("O", "A"), "two": ("P", "B")},
        dimensions={"r": 10, "x": 30},
        lengths={"O A": 5},
        gears=[lw.Gear(name="g", wheels=("one", "two"), centers=("O", "P"), radii=("r", "30 - r"))],
        inputs=lw.Input(link="one"),
    )
    designs = designs_of(mechanism, {"r": [10.0, 12.0, 10.0, -1.0], "O A": [5.0, 6.0, 7.0, 8.0]})
    agree(designs)
    assert [bool(p) for p in designs.problem] == [False, True, False, True]
    assert "another structure" in designs.message(1)
    assert "must be positive" in designs.message(3)


def test_a_term_that_a_design_does_not_have_is_zero() -> None:
    loops = lw.loops(
        dimensions={"a": 2.0, "b": 4.0, "e0": 0.0},
        loops={"one": "a*e^(i*t) + b*e^(i*u) + i*e0 = s"},
        guess={"u": -30, "s": 4, "t": 60},
        inputs=lw.Input(variable="t"),
    )
    designs = designs_of(loops, {"e0": [0.0, 0.5, -0.5, 0.0]})
    assert not designs.problem.any()
    assert designs.loops.shape == (4, len(loops.model.compiled.table.loops.row) + 1)
    assert (designs.loops == 0).any(axis=1).tolist() == [True, False, False, True]
    agree(designs)


def test_textbook_loops_and_plain_equations_vary_too() -> None:
    loops = lw.loops(
        dimensions={"a": 2.0, "b": 4.0, "c": "b - 1", "d": 5.0, "delta": 10.0},
        loops={"one": "a*e^(i*t) + b*e^(i*u) = d + c^2/3*e^(i*(v + delta)) + sqrt(a)*i"},
        guess={"u": 30, "v": 80, "t": 60},
        inputs=lw.Input(variable="t"),
    )
    designs = designs_of(
        loops,
        {"a": [2.0, 2.2, -1.0, 0.0], "b": [4.0, 1.0, 4.1, 4.0], "delta": [0.0, 3.0, 1.0, 2.0]},
    )
    assert [bool(p) for p in designs.problem] == [False, True, True, True]
    assert '"t" occurs in no loop equation' in designs.message(3)
    agree(designs)
    agree(designs_of(loops, {"u": [20.0, 25.0], "d": 6.0}))
    plain = lw.plain_equations(
        dimensions={"k": 2.0, "m": "ln(k)"},
        equations={"f": "x^3 - k*x + m = t"},
        guess={"x": 1.0, "t": 0.0},
        inputs=lw.Input(variable="t", from_=0, to=1, step=0.1),
    )
    found = designs_of(plain, {"k": [1.0, 2.0, -1.0], "x": [0.5, 1.0, 1.0]})
    assert [bool(p) for p in found.problem] == [False, False, True]
    agree(found)


def test_results_do_not_depend_on_how_designs_are_cut_into_blocks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rng = np.random.default_rng(5)
    asked = {
        "a": rng.normal(40, 60, 40),
        "A P": rng.uniform(20, 300, 40),
        "P.y": rng.normal(0, 9, 40),
    }
    whole = designs_of(_four_bar(), asked)
    monkeypatch.setattr(building, "_BLOCK", 7)
    pieces = designs_of(_four_bar(), asked)
    assert len(whole.problems) > 2
    for name in ("loops", "points", "start", "linear", "length_scale"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(pieces, name))
    assert [whole.message(k) for k in range(40)] == [pieces.message(k) for k in range(40)]


def test_designs_are_built_alone_where_passes_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(building, "_MOST_PASSES", 1)
    designs = designs_of(_four_bar(), {"a": [40.0, -1.0, 41.0, np.nan], "A P": [70.0, 70, 900, 70]})
    agree(designs)
    assert np.count_nonzero(designs.problem) == 3


def test_taking_some_designs_keeps_their_numbers_together() -> None:
    designs = designs_of(_four_bar(), {"a": [38.0, -1.0, 42.0], "b": 55.0})
    some = designs.take(np.array([2, 1]))
    assert len(some) == 2
    agree(some)
    np.testing.assert_array_equal(some.loops[0], designs.loops[2])
    assert some.dimensions["a"].tolist() == [42.0, -1.0]
    assert some.message(1) == designs.message(1)
    assert len(designs.take(slice(0, 0))) == 0


def test_scalars_hold_for_all_designs_and_no_designs_are_fine() -> None:
    assert len(designs_of(_four_bar(), {"a": 41, "b": 54})) == 1
    assert len(designs_of(_four_bar(), {"a": [], "b": 54})) == 0
    assert designs_of(_four_bar(), {"a": 41, "b": [54, 55]}).dimensions["a"].tolist() == [41, 41]


def test_names_that_mean_nothing_are_refused_with_what_exists() -> None:
    with pytest.raises(
        UnknownNameError, match=r'"O2 B" is not a number of .* \(numbers: O4 B, O2 A, '
    ):
        designs_of(_four_bar(), {"O2 B": [1.0]})
    for name in ("zz", "O4.z", "s16.offset", "", "A B P"):
        with pytest.raises(UnknownNameError):
            designs_of(_four_bar(), {name: [1.0]})


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({}, "this family varies no numbers: give a dimension and its values"),
        ({"a": [1.0, 2.0], "b": [1.0, 2.0, 3.0]}, "equal lengths, got a: 2, b: 3"),
        ({"a": [1.0], "b": [1.0, 2.0]}, "equal lengths, got a: 1, b: 2"),
        ({"a": [[1.0, 2.0]]}, "an array of one axis, got 1 × 2 numbers"),
        ({"a": "2*b"}, r"needs a number or an array of numbers, got '2\*b'"),
        ({"a": [1.0, "x"]}, "needs a number or an array of numbers"),
        ({"a": [True]}, "needs a number or an array of numbers"),
        ({"a": [[1.0], [1.0, 2.0]]}, "needs a number or an array of numbers, got rows"),
        ({"O2 A": 1.0, "A O2": 2.0}, '"O2 A" and "A O2" are the same number'),
    ],
)
def test_arrays_of_no_use_are_refused(asked: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        designs_of(_four_bar(), asked)


def test_a_design_by_itself_is_an_ordinary_mechanism() -> None:
    designs = designs_of(_four_bar(), {"a": [38.0, -1.0]})
    assert designs.description(0) == _four_bar().with_dimensions(a=38.0).description
    assert lw.Mechanism(designs.description(0)).solve(at=60).status.ok
    with pytest.raises(MechanismError):
        designs.design(1)


@pytest.fixture
def never_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(self: building.Builder, k: int) -> NoReturn:
        raise AssertionError(f"design {k} was built alone")

    monkeypatch.setattr(building.Builder, "_alone", refuse)


@pytest.mark.usefixtures("never_alone")
def test_sides_of_the_sketch_need_no_pass_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(building, "_MOST_PASSES", 1)
    rng = np.random.default_rng(2)
    designs_of(_four_bar(), {"P.y": rng.normal(0, 90, 50), "A P": rng.uniform(60, 80, 50)})
    designs_of(_slider_crank(5), {"s.offset": [3.0, -4.0], "A.y": [30.0, -30.0]})


def test_shapes_that_do_not_converge_stop_no_others() -> None:
    mechanism, rng = lw.example("rapier-drive-links"), np.random.default_rng(6)
    chosen = [q for q in varied_numbers(mechanism.description) if q.table == "lengths"]
    designs = designs_of(mechanism, _varied(mechanism, chosen, 0.4, rng, 80))
    assert 0 < np.count_nonzero(designs.problem) < 40
    agree(designs, 1e-12)


def test_shapes_that_go_on_by_themselves_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(nearest_shape._gauss_newton, "__defaults__", (1,))
    mechanism, rng = lw.example("watt-linkage"), np.random.default_rng(6)
    chosen = [q for q in varied_numbers(mechanism.description) if q.table == "lengths"]
    agree(designs_of(mechanism, _varied(mechanism, chosen, 0.1, rng, 20)), 1e-13)


def test_coefficients_beyond_every_number_are_a_problem() -> None:
    loops = lw.loops(
        dimensions={"a": 2.0, "b": 4.0},
        loops={"one": "a*b*e^(i*t) + 9*e^(i*u) = s"},
        guess={"u": -30, "s": 4, "t": 60},
        inputs=lw.Input(variable="t"),
    )
    designs = designs_of(loops, {"a": [2.0, 1e200], "b": [4.0, 1e200]})
    assert designs.message(0) == ""
    assert designs.message(1) == (
        '1 problem in mechanism "mechanism"\n'
        "  loops.one  column 13: a coefficient here is not a finite number\n"
        "        a*b*e^(i*t) + 9*e^(i*u) = s\n"
        "                    ^"
    )
    assert np.isnan(designs.loops[1]).all()


def test_a_term_more_than_the_base_has_is_another_structure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        "linkwork.families.building.family_base", lambda model, varied: (model, False)
    )
    designs = designs_of(_slider_crank(), {"s.offset": [0.0, 3.0]})
    assert [bool(p) for p in designs.problem] == [False, True]
    agree(designs)


@pytest.mark.usefixtures("never_alone")
def test_ordinary_designs_are_not_built_one_at_a_time() -> None:
    rng = np.random.default_rng(2)
    mechanism = lw.example("jansen-leg")
    chosen = [q for q in varied_numbers(mechanism.description) if q.table == "lengths"]
    designs = designs_of(mechanism, _varied(mechanism, chosen, 0.3, rng, 3000))
    assert 0 < np.count_nonzero(designs.problem) < 3000
