"""Plans of dimensions: what they hold, and that every chunk is made by itself."""

from __future__ import annotations

import itertools
import pickle
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import linkwork as lw
from linkwork.core.foundation.arrays import IndexArray
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.families import designs_of, from_table, grid, latin_hypercube, random, sampling
from linkwork.families.sampling import Normal, Uniform

RANGES = {"a": (30.0, 50.0), "b": (1.0, 2.0)}


@pytest.fixture
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "CHUNK", 7)


PLANS = {
    "grid": lambda: grid({"a": [1.0, 2.0, 3.0], "b": 5, "c": np.linspace(0, 1, 6)}),
    "random": lambda: random(20, {**RANGES, "c": Normal(0, 1)}, seed=4),
    "latin": lambda: latin_hypercube(20, RANGES, seed=4),
    "table": lambda: from_table({"a": np.arange(18.0), "b": np.arange(18)}),
}


@pytest.mark.parametrize("kind", PLANS)
@pytest.mark.usefixtures("small_chunks")
def test_a_chunk_needs_none_of_the_others(kind: str) -> None:
    plan = PLANS[kind]()
    last = PLANS[kind]().chunk(plan.chunks - 1)  # from a plan that has made nothing else
    assert plan.chunks == 3
    for name in plan:
        parts = [plan.chunk(k)[name] for k in range(plan.chunks)]
        assert [len(part) for part in parts] == [7, 7, plan.count - 14]
        np.testing.assert_array_equal(np.concatenate(parts), plan[name])
        np.testing.assert_array_equal(parts[-1], last[name])


@pytest.mark.parametrize("kind", PLANS)
def test_a_plan_travels_to_another_process_unchanged(kind: str) -> None:
    plan = PLANS[kind]()
    copy = pickle.loads(pickle.dumps(plan))
    for name in plan:
        np.testing.assert_array_equal(copy[name], plan[name])


def test_a_grid_holds_every_combination_once_the_last_name_fastest() -> None:
    plan = PLANS["grid"]()
    rows = list(zip(plan["a"], plan["b"], plan["c"], strict=True))
    assert rows == list(itertools.product([1.0, 2.0, 3.0], [5.0], np.linspace(0, 1, 6)))
    assert len(plan) == 3
    assert plan.count == 18


def test_a_grid_of_a_billion_makes_its_last_chunk_at_once() -> None:
    levels = {name: np.arange(1000.0) for name in "xyz"}
    plan = grid(levels)
    assert plan.count == 10**9
    chunk = plan.chunk(plan.chunks - 1)
    assert [chunk[name][-1] for name in "xyz"] == [999.0, 999.0, 999.0]
    assert chunk["z"][-1001] == 999.0
    assert chunk["y"][-1001] == 998.0


def test_random_values_follow_seed_column_and_chunk_and_nothing_else() -> None:
    plan = random(100_000, RANGES, seed=11)
    again = random(70_000, RANGES, seed=11)
    np.testing.assert_array_equal(plan["a"][: len(again["a"])], again["a"])
    assert not np.array_equal(plan["a"], random(100_000, RANGES, seed=12)["a"])
    unit = {name: (plan[name] - low) / (high - low) for name, (low, high) in RANGES.items()}
    assert abs(np.corrcoef(unit["a"], unit["b"])[0, 1]) < 0.02
    first, second = unit["a"][: sampling.CHUNK], unit["a"][sampling.CHUNK :]
    assert not np.array_equal(first[: len(second)], second)
    for values in unit.values():
        assert 0.0 <= values.min() < 1e-3 < 0.999 < values.max() <= 1.0
        assert abs(values.mean() - 0.5) < 0.005


def test_random_values_stay_what_they_were() -> None:
    """Published figures of a study would change with them."""
    np.testing.assert_array_equal(random(3, {"a": (0.0, 1.0)}, seed=1)["a"], PUBLISHED_RANDOM)
    latin = latin_hypercube(3, {"a": (0.0, 3.0)}, seed=1)["a"]
    np.testing.assert_array_equal(latin, PUBLISHED_LATIN)


PUBLISHED_RANDOM = [0.0668020093396563, 0.07901298235490295, 0.005777118030780293]
PUBLISHED_LATIN = [1.0668020093396562, 2.079012982354903, 0.005777118030780293]


def test_distributions_are_drawn_as_they_are() -> None:
    plan = random(
        50_000,
        {"n": Normal(40.0, 0.1), "u": Uniform(-1.0, 1.0), "e": lambda g, n: g.exponential(2.0, n)},
        seed=3,
    )
    assert abs(plan["n"].mean() - 40.0) < 0.002
    assert abs(plan["n"].std() - 0.1) < 0.002
    assert abs(plan["e"].mean() - 2.0) < 0.05
    assert abs(plan["u"].mean()) < 0.02


@pytest.mark.parametrize("count", [1, 2, 3, 5, 64, 65, 1000, 70_001])
def test_a_latin_hypercube_has_one_design_in_every_part_of_every_range(count: int) -> None:
    plan = latin_hypercube(count, RANGES, seed=count)
    orders: list[IndexArray] = []
    for name, (low, high) in RANGES.items():
        part = np.floor((plan[name] - low) / (high - low) * count).astype(int)
        assert np.array_equal(np.sort(part), np.arange(count))
        orders.append(part)
    if count >= 1000:
        assert abs(np.corrcoef(orders[0], orders[1])[0, 1]) < 0.1
        assert abs(np.corrcoef(orders[0], np.arange(count))[0, 1]) < 0.1


def test_a_latin_hypercube_of_a_billion_makes_any_chunk() -> None:
    plan = latin_hypercube(10**9, RANGES, seed=1)
    chunk = plan.chunk(9_999)
    assert len(chunk["a"]) == sampling.CHUNK
    assert abs(chunk["a"].mean() - 40.0) < 0.2


def test_tables_of_every_kind_give_the_same_plan(tmp_path: Path) -> None:
    frame = pd.DataFrame({"a": [1.0, 2.5], "O2 A": [3, 4]})
    path = tmp_path / "designs.csv"
    path.write_text('\ufeffa,"O2 A"\n1,3\n2.5,4\n\n', encoding="utf-8")
    structured = np.array([(1.0, 3), (2.5, 4)], dtype=[("a", float), ("O2 A", int)])
    for table in (frame, path, str(path), structured, {"a": [1.0, 2.5], "O2 A": [3, 4]}):
        plan = from_table(table)
        assert {name: values.tolist() for name, values in plan.items()} == {
            "a": [1.0, 2.5],
            "O2 A": [3.0, 4.0],
        }
        assert list(from_table(table, columns=["a"])) == ["a"]
        with pytest.raises(UnknownNameError, match=r'no column "b" \(columns: '):
            from_table(table, columns=["b"])


def test_a_plan_makes_a_family() -> None:
    plan = grid({"O2 A": [38.0, 40.0], "O4 B": [79.0, 80.0, 81.0]})
    designs = designs_of(lw.example("four-bar"), plan)
    assert len(designs) == 6
    assert not designs.problem.any()
    np.testing.assert_array_equal(designs.dimensions["O4 B"], [79.0, 80.0, 81.0] * 2)


def test_an_empty_plan_has_no_chunks() -> None:
    plan = random(0, RANGES, seed=1)
    assert plan.chunks == 0
    assert plan["a"].shape == (0,)
    with pytest.raises(InputError, match="there is no chunk 0: this plan has 0"):
        plan.chunk(0)


@pytest.mark.parametrize(
    ("make", "told"),
    [  # what types refuse is refused without them, too
        (lambda: grid({}), "this plan varies no numbers: give a dimension and its values"),
        (lambda: grid({"a": []}), '"a" needs at least one value'),
        (lambda: grid({"a": ["x"]}), '"a" needs a row of numbers, got'),
        (lambda: random(-1, RANGES, 1), "count must be a whole number, 0 or more, got -1"),
        (lambda: random(1.5, RANGES, 1), "count must be a whole number"),  # type: ignore[arg-type]
        (lambda: random(True, RANGES, 1), "count must be a whole number"),
        (lambda: random(3, RANGES, -1), "seed must be a whole number"),
        (lambda: random(3, {"a": (2.0, 1.0)}, 1), 'range from low to high, got 2 to 1'),
        (lambda: random(3, {"a": (0.0, np.inf)}, 1), "range from low to high"),
        (lambda: random(3, {"a": 5.0}, 1), r'"a" needs a range \(low, high\), got 5'),  # type: ignore[dict-item]
        (lambda: random(3, {"a": lambda g, n: 1.0}, 1)["a"], 'drew one values, not 65536'),  # type: ignore[dict-item, return-value]
        (lambda: latin_hypercube(3, {"a": Normal(0, 1)}, 1), 'needs a range'),  # type: ignore[dict-item]
        (lambda: Normal(0.0, -1.0), "deviation of 0 or more"),
        (lambda: Uniform(1.0, 0.0), "range from low to high"),
        (lambda: from_table({"a": [1.0], "b": [1.0, 2.0]}), "equal lengths, got a: 1, b: 2"),
        (lambda: from_table({}), "this plan varies no numbers: give a dimension and its values"),
        (lambda: from_table(5), "a table is a DataFrame"),
        (lambda: from_table({1: [1.0]}, ["a"]), r'no column "a" \(columns: 1\)'),
        (lambda: from_table({"a": ["x"]}), '"a" needs a row of numbers, got'),
        (lambda: from_table("no such file.csv"), "cannot be read: No such file"),
    ],
)  # fmt: skip
def test_plans_that_are_none_are_refused(make: Callable[[], object], told: str) -> None:
    with pytest.raises(InputError, match=told):
        make()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("a,b\n1,2\n3,x\n", 'line 3: "b" needs a number, got "x"'),
        ("a,b\n1,2,3\n", "line 2 has 3 cells, the header 2"),
        ("", "this plan varies no numbers: give a dimension and its values"),
    ],
)
def test_csv_files_are_refused_with_the_line(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "designs.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=told):
        from_table(path)


def test_a_deviation_of_minus_zero_is_none() -> None:
    plan = random(4, {"a": Normal(2.0, -0.0)}, seed=1)
    np.testing.assert_array_equal(plan.chunk(0)["a"], 2.0)


def test_a_range_wider_than_numbers_are_is_refused() -> None:
    for draw in (random, latin_hypercube):
        with pytest.raises(InputError, match='"a" needs a range from low to high'):
            draw(4, {"a": (-1e308, 1e308)}, seed=1)
