"""Texts whose entries are of wrong kinds: drawn, listed with remedies, and edited like others."""

from __future__ import annotations

from pathlib import Path

import pytest

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.file_state import FileState
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.requests import Duplicate, Mirror
from linkwork.app.live.workbench import Workbench
from tests.app.live.conftest import FOUR_BAR

WRONG = {
    "a link": '[links]\nx = 1\ncrank = ["O2", "A"]',
    "a trace": '[trace]\npoints = 5\n[links]\ncrank = ["O2", "A"]',
    "a part": 'sliders = [1]\n[links]\ncrank = ["O2", "A"]',
    "a mass": '[masses]\ncrank = 1\n[links]\ncrank = ["O2", "A"]',
    "a friction": '[friction]\nA = 1\n[links]\ncrank = ["O2", "A"]',
    "an angle": '[angles]\n"O2 A B" = []\n[links]\ncrank = ["O2", "A"]',
    "a name": 'purpose = {x = 1}\n[links]\ncrank = ["O2", "A"]',
    "a missing point": '[links]\ncrank = ["O2", "A", "Q"]',
}
EDITS = (
    Duplicate(names={"A": "B", "crank": "bar"}, places={"A": (5.0, 5.0)}, mirrored=True),
    Mirror(places={"A": (-4.0, 3.0), "O2": (0.0, 0.0)}),
    ask.RemovePart(name="s", whole=True),
    ask.TracePoint(point="A", on=True),
    ask.RemovePoint(name="O2"),
)


def opened(text: str, folder: Path) -> Workbench:
    """A text that is under edit."""
    path = folder / "wrong.toml"
    path.write_text(text, encoding="utf-8")
    return Workbench(MechanismFile(path), lw.loads)


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG)
@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: type(edit).__name__)
def test_what_is_wrong_stays_and_the_rest_is_edited_or_the_edit_is_refused(
    wrong: str, edit: ask.Edit, tmp_path: Path
) -> None:
    bench = opened(f"format = 1\npoints = {{O2 = [0, 0], A = [4, 3]}}\n{wrong}\n", tmp_path)
    begun = bench.text
    kinds = set(map(type, bench.handle(edit)))  # raises nothing
    assert bool(kinds & {tell.Refused, tell.ProblemsFound}) == (bench.text == begun)
    bench.handle(ask.Undo())
    assert bench.text == begun


def test_a_link_that_cannot_be_drawn_is_removed_by_its_remedy(tmp_path: Path) -> None:
    bench = opened(FOUR_BAR.replace("[links]", "[links]\nx = 1"), tmp_path)
    state = next(e for e in bench.opened() if isinstance(e, FileState))
    (lack,) = state.lacks
    assert (lack.key, lack.kind) == ("links.x", "")  # nothing to go to
    bench.handle(ask.Together(edits=lack.remedies[0].edits))
    assert bench.text == FOUR_BAR


@pytest.mark.parametrize("edit", [*EDITS, ask.AddPoint(name="P", x=1.0, y=1.0)])
def test_a_text_that_is_not_toml_is_not_edited(edit: ask.Edit, tmp_path: Path) -> None:
    bench = opened("format = 1\n[points]\nA = [0, 0\n", tmp_path)
    begun = bench.text
    (refused, *_) = bench.handle(edit)
    assert isinstance(refused, tell.Refused)
    assert refused.message.startswith("correct the text first: line 3 is not TOML")
    assert bench.text == begun
