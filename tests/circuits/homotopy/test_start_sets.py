"""Start sets that are kept: those of a topology serve it in any order, and nothing else does."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.circuits.homotopy import isolated_roots, parameter_roots as start_sets
from linkwork.circuits.homotopy.dead_point_family import DeadPointFamily
from linkwork.circuits.homotopy.dead_points import Topology
from linkwork.circuits.homotopy.isolated_roots import Solved, Structure, random_member
from linkwork.circuits.homotopy.parameter_roots import StartSet, own_sets, read_sets, write_set
from linkwork.core.numerics.bilinear import Columns, columns_of, random_closures
from tests.campaigns.circuits import dead_inputs_of
from tests.library_mechanisms import read_example
from tests.thinned import thinned

#: Dead points of four loops solved together are not shipped: they are not sure to be all.
DRIVEN = [n for n in lw.examples() if read_example(n).model.equations.inputs and n != "dixon-two"]


def shipped() -> list[StartSet]:
    with np.load(start_sets.SHIPPED) as stored:
        names = sorted({name.rpartition(".")[0] for name in stored.files})
        return [
            StartSet.of_arrays({f: stored[f"{name}.{f}"] for f in StartSet.__annotations__})
            for name in names
        ]


SETS = shipped()


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cache of the test's own, and nothing known from earlier tests."""
    monkeypatch.setenv("LINKWORK_CACHE", str(tmp_path))
    monkeypatch.setattr(isolated_roots, "_KNOWN", {})


@pytest.fixture
def nothing_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(family: object) -> None:
        raise AssertionError(f"no set is shipped for {family}")

    monkeypatch.setattr(isolated_roots, "solve_random_member", refuse)


@pytest.mark.parametrize("name", thinned(DRIVEN, 6))
def test_the_library_needs_no_set_that_is_not_shipped(name: str, nothing_is_solved: None) -> None:
    mechanism = lw.example(name)
    dead_inputs_of(mechanism)
    mechanism.configurations()


def family_of(topology: Topology) -> Structure | DeadPointFamily:
    rows, columns = topology.rows, topology.columns
    if not topology.own:
        return Structure(rows=rows, columns=columns)
    return DeadPointFamily(rows=rows, columns=columns, own=topology.own, slots=topology.slots)


def reordered(topology: Topology, rng: np.random.Generator) -> Topology:
    """The same topology with its unknowns, products and rates in another order."""
    last = topology.unknowns
    order = np.append(rng.permutation(last), last)
    place = np.argsort(order)
    products = list(zip(*topology.rows, strict=True))
    shuffled = [products[int(k)] for k in rng.permutation(len(products))]
    rates = rng.permutation(2 * topology.own)
    return Topology(
        rows=tuple(tuple(int(place[k]) for k in row) for row in zip(*shuffled, strict=True)),
        columns=_other_loops([topology.columns[k] for k in order], rng),
        own=topology.own,
        slots=tuple(
            (int(place[column]), int(place[factor]), int(rates[number]), weight, mirrored)
            for column, factor, number, weight, mirrored in topology.slots
        ),
    )


def _other_loops(columns: list[tuple[tuple[int, ...], ...]], rng: np.random.Generator) -> Columns:
    """Columns of closures after one loop was added to another one, where that gives loops."""
    count = len(columns[0])
    closures = random_closures(tuple(columns), rng)
    for _ in range(20):
        added = np.eye(count)
        one, other = rng.choice(count, 2, replace=False) if count > 1 else (0, 0)
        added[one, other] = rng.choice([-1.0, 1.0])
        found = columns_of(added @ closures)
        # sums with other weights than -1, 0 and 1 are not those of loops
        if all(len(a[0]) == len(b[0]) for a, b in zip(found, columns, strict=True)):
            return found
    return columns_of(closures)


@pytest.mark.parametrize("number", range(0, len(SETS), 5))
def test_a_set_serves_its_topology_in_any_order(number: int, nothing_is_solved: None) -> None:
    kept, rng = SETS[number], np.random.default_rng(number)
    family = family_of(reordered(kept.topology, rng))
    assert family.topology != kept.topology
    assert family.topology.signature == kept.topology.signature
    found: Solved[Any] = random_member(family)
    assert found.sure
    assert len(found.x) == len(kept.x)
    if len(found.x):
        value, _ = found.system.residual_and_jacobian(found.x)
        assert np.abs(value).max() < 1e-9 * (1.0 + np.abs(found.x).max()) ** 2
    # a member of this family, not of the other one
    assert columns_of(found.system.left) == family.columns


def test_families_that_are_not_the_same_are_not_taken_for_it() -> None:
    whole = [kept.topology for kept in SETS if len(kept.topology.columns[0]) == 3]
    for topology in whole[::4]:
        near = [other for other in whole if other.signature == topology.signature]
        assert near == [topology]
        free = tuple(tuple(int(j == k) for k in range(3)) for j in range(3))
        place = next(k for k, column in enumerate(topology.columns) if len(column[0]) < 3)
        columns = (*topology.columns[:place], free, *topology.columns[place + 1 :])
        changed = replace(topology, columns=columns)
        assert changed.renaming(topology) is None


@pytest.fixture
def four_bar() -> DeadPointFamily:
    (kept,) = (k for k in SETS if k.topology.unknowns == 3 and _plain(k.topology))
    family = family_of(kept.topology)
    assert isinstance(family, DeadPointFamily)
    return family


def _plain(topology: Topology) -> bool:
    """Angles only, and two of them unknown."""
    return topology.rows[0] == topology.rows[1] and len(topology.slots) == 2 and topology.own == 1


def test_sets_that_are_not_shipped_are_solved_once_and_kept(
    four_bar: DeadPointFamily, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(start_sets, "SHIPPED", tmp_path / "none.npz")
    first = random_member(four_bar)
    assert len(first.x) == 4
    (kept,) = own_sets()
    monkeypatch.setattr(isolated_roots, "_KNOWN", {})
    monkeypatch.setattr(isolated_roots, "solve_random_member", None)  # is not called
    again = random_member(four_bar)
    np.testing.assert_allclose(again.x, first.x, rtol=1e-12)
    assert kept.stat().st_size < 4096


@pytest.mark.parametrize("damage", ["cut", "noise", "wrong", "twice", "narrow", "other"])
def test_damaged_sets_are_solved_again(
    damage: str, four_bar: DeadPointFamily, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(start_sets, "SHIPPED", tmp_path / "none.npz")
    right = random_member(four_bar)
    (path,) = own_sets()
    if damage == "cut":
        path.write_bytes(path.read_bytes()[:300])
    elif damage == "noise":
        path.write_bytes(b"no archive at all")
    else:
        (kept,) = read_sets(four_bar.topology)
        changed = {
            "twice": replace(kept, x=kept.x[[0, 0, 1, 2]]),
            "wrong": replace(kept, x=kept.x * np.nan),
            "narrow": replace(kept, x=kept.x[:, :-1]),
            "other": replace(kept, left=kept.left[:, :-1]),
        }
        write_set(changed[damage])
    monkeypatch.setattr(isolated_roots, "_KNOWN", {})
    found = random_member(four_bar)
    np.testing.assert_allclose(found.x, right.x, rtol=1e-12)
    (mended,) = read_sets(four_bar.topology)
    assert len(np.unique(mended.x.round(4), axis=0)) == 4


def test_a_cache_that_cannot_be_written_to_costs_time_only(
    four_bar: DeadPointFamily, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    taken = tmp_path / "file"
    taken.write_text("a file where the folder should be")
    monkeypatch.setenv("LINKWORK_CACHE", str(taken))
    monkeypatch.setattr(start_sets, "SHIPPED", tmp_path / "none.npz")
    assert len(random_member(four_bar).x) == 4
