"""Copies with some entries of tables changed keep the others."""

from typing import Any

import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, UnknownNameError
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops
from tests.described import described_as


def test_entries_of_every_table_join_those_that_exist() -> None:
    bar = lw.example("four-bar").changed(
        dimensions={"r1": 3, "r2": 4},
        masses={"crank": lw.Mass(mass=1.0, shape="rod"), "rocker": lw.Mass(mass=2.0, shape="rod")},
        tolerances={"O2 A": 0.1, "O4 B": 0.2},
        friction={"A": lw.Friction(mu=0.1, radius=1), "B": lw.Friction(mu=0.2, radius=1)},
        clearances={"A": 0.1, "B": 0.2},
        outputs={"s": "2*r1", "t": "3*r1"},
    )
    old = bar.description
    new: dict[str, dict[str, Any]] = {
        "points": {"A": (36, 19)},
        "links": {"coupler": ("B", "A")},
        "lengths": {"A O2": 38},
        "dimensions": {"r2": 5},
        "masses": {"rocker": lw.Mass(mass=3.0, shape="rod")},
        "tolerances": {"B O4": 0.3},
        "friction": {"B": lw.Friction(mu=0.3, radius=1)},
        "clearances": {"B": 0.3},
        "outputs": {"t": "4*r1"},
    }
    changed = bar.changed(**new).description
    for table, entries in new.items():
        before, after = getattr(old, table), getattr(changed, table)
        assert list(after) == list(before), table
        moved = {key for key in after if after[key] != before[key]}
        assert {frozenset(key.split()) for key in moved} == {frozenset(k.split()) for k in entries}


def test_guesses_and_loops_join_those_that_exist() -> None:
    rapier = lw.example("rapier-drive")
    old = described_as(Loops, rapier).guess
    name = next(iter(old))
    assert described_as(Loops, rapier.changed(guess={name: 41})).guess == {**old, name: 41}


def test_none_removes_an_entry_and_an_empty_table_all() -> None:
    bar = lw.example("four-bar")
    kept = described_as(Linkage, bar.changed(lengths={"B A": None})).lengths
    assert list(kept) == ["O2 A", "O4 B", "O2 O4"]
    assert described_as(Linkage, bar.changed(lengths={})).lengths == {}
    with pytest.raises(UnknownNameError, match=r'lengths has no "A Q" \(lengths: A B, '):
        bar.changed(lengths={"A Q": None})
    with pytest.raises(InputError, match=r"two values under one name: O2 A, A O2"):
        bar.changed(lengths={"O2 A": 38, "A O2": 39})
