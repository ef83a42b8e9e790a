"""Whatever is asked in whatever order: answered, never raised, and nothing lost or written."""

from __future__ import annotations

import typing
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.file_state import FileState
from linkwork.app.live.messages import encoded
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.session import Bench
from linkwork.app.live.task_requests import OpenTask
from linkwork.app.live.workbench import Workbench
from linkwork.synthesis.solvers.solving import solve_task
from tests.app.live.conftest import FOUR_BAR

NAMES = st.sampled_from(
    ["O2", "A", "B", "O4", "P", "Q", "crank", "coupler", "rocker", "ground", "bar", "s", "g", "a",
     "O2 A", "A B", "O2 O4", "A P", "B A P", "O4.x", "crossed", "link", "slider", "", "θ", "a b c"]
)  # fmt: skip
NUMBERS = st.sampled_from(
    [0.0, 1.0, -5.0, 30.0, 40.0, 60.0, 90.0, 118.0, 200.0, 1e-9, 1e12, -1e300]
)
SIMPLE = {str: NAMES, float: NUMBERS, bool: st.booleans(), int: st.integers(-1, 60)}
#: Those that may ask for long tables, write, or open another file are tried elsewhere.
_SLOW = (ask.Save, ask.SetText, ask.SetInput, ask.OpenExample, OpenTask)
QUICK = [r for r in ask.REQUESTS if r not in _SLOW]


def values(kind: Any) -> st.SearchStrategy[Any]:
    """Values of the type of a field, mostly such as mean something for the four-bar."""
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if kind in SIMPLE:
        return SIMPLE[kind]
    if kind is type(None):
        return st.none()
    if origin is tuple and parts[-1] is not Ellipsis:
        return st.tuples(*map(values, parts))
    if origin is tuple:
        return st.lists(values(parts[0]), max_size=3).map(tuple)
    if origin is dict:
        return st.dictionaries(NAMES, values(parts[1]), max_size=2)
    if parts:
        return st.one_of([values(part) for part in parts])
    return requests([kind])


def requests(kinds: list[type]) -> st.SearchStrategy[Any]:
    """Requests of these kinds."""
    made = []
    for kind in kinds:
        hints = typing.get_type_hints(kind)
        made.append(st.builds(kind, **{f.name: values(hints[f.name]) for f in fields(kind)}))
    return st.one_of(made)


@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.lists(requests(QUICK), min_size=1, max_size=8))
def test_any_requests_are_answered_and_the_file_is_left_alone(
    path: Path, asked: list[ask.Request]
) -> None:
    bench = Bench(MechanismFile(path), lw.loads, solve_task)
    for request in asked:
        for event in bench.handle(request):
            assert encoded(event)
    palette, state, *_ = bench.opened()
    assert isinstance(palette, tell.PaletteShown)
    assert isinstance(state, FileState)
    # what is kept is a mechanism, or is said not to be
    assert state.lacks or isinstance(lw.loads(state.text), lw.Mechanism)
    assert path.read_text(encoding="utf-8") == FOUR_BAR
    steps = 0
    while not isinstance(bench.handle(ask.Undo())[0], tell.Refused):
        steps += 1
    assert bench.text == FOUR_BAR  # every change can be taken back
    for _ in range(steps):
        bench.handle(ask.Redo())
    assert bench.text == state.text


@pytest.mark.parametrize("live", [False, True])
def test_a_refused_change_leaves_everything_as_it_was(bench: Workbench, live: bool) -> None:
    bench.handle(ask.SetNumber(name="A B", value=121))
    before = bench.opened()
    wrong = ask.SetNumber(name="A B", value=-1.0)
    assert not isinstance(bench.handle(replace(wrong, live=live))[0], tell.MotionFound)
    assert bench.opened() == before
