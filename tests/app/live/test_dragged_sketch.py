"""While a sketch is dragged, its names stay in place, and only the paths of the motion are told."""

from __future__ import annotations

import numpy as np

from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.workbench import Workbench
from linkwork.app.pages.page_data import PageData


def _drag(bench: Workbench, x: float, *, live: bool = True) -> list[tell.Event]:
    return bench.handle(ask.MovePoint(point="A", x=x, y=20.0, live=live))


def _sketch(events: list[tell.Event]) -> PageData:
    return next(event for event in events if isinstance(event, tell.SketchShown)).page


def _motion(events: list[tell.Event]) -> tell.MotionFound:
    return next(event for event in events if isinstance(event, tell.MotionFound))


def _places(page: PageData) -> dict[str, tuple[int, ...]]:
    """The sides of their points on which names are."""
    parts = page.motions[0].parts
    return {p.of: (p.align, *np.sign(p.offset).astype(int)) for p in parts if p.role == "label"}


def test_only_paths_are_told_while_a_sketch_is_dragged(bench: Workbench) -> None:
    bench.opened()
    bench.handle(ask.SetSheet(width=200.0, edited=True))
    page = _motion(_drag(bench, 36.0)).page
    assert page is not None
    assert {part.role for part in page.motions[0].parts} == {"trace"}
    assert not page.motions[0].columns
    ended = _motion(_drag(bench, 36.0, live=False)).page
    assert ended is not None
    assert ended.motions[0].columns


def test_names_and_arrows_keep_their_places_during_a_drag(bench: Workbench) -> None:
    bench.opened()
    bench.handle(ask.SetSheet(width=200.0, edited=True))
    first = _sketch(_drag(bench, 36.0))
    later = _sketch(_drag(bench, -44.0))
    assert _places(first) == _places(later)
    assert [part.kind for part in first.motions[0].parts if part.role == "input"] == [
        part.kind for part in later.motions[0].parts if part.role == "input"
    ]
    assert _places(_sketch(_drag(bench, -44.0, live=False))) != _places(later)


def test_the_whole_motion_is_told_when_editing_ends_in_a_drag(bench: Workbench) -> None:
    bench.opened()
    bench.handle(ask.SetSheet(width=200.0, edited=True))
    _drag(bench, 36.0)
    page = _motion(bench.handle(ask.SetSheet(width=200.0, edited=False))).page
    assert page is not None
    assert page.motions[0].columns
