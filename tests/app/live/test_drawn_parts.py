"""Parts drawn in the canvas: what is picked gives mechanisms that move, and nothing is lost."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.file_state import FileState
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.palette import PALETTE
from linkwork.app.live.workbench import Workbench
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.textfile.reader import blank_sheet

Place = tuple[float, float]


class Drawing:
    """A blank sheet on which is drawn as a page does, by requests."""

    def __init__(self, path: Path) -> None:
        self.bench = Workbench(MechanismFile(path, blank_sheet("drawn")), lw.loads)

    def change(self, *edits: ask.Edit) -> FileState:
        """The state after edits that are accepted."""
        request = edits[0] if len(edits) == 1 else ask.Together(edits=edits)
        events = self.bench.handle(request)
        assert isinstance(events[0], FileState), events
        return events[0]

    def link(self, name: str, *ends: tuple[str, float, float] | str, fixed: str = "") -> None:
        """A link through new and existing points; ``fixed`` are those on ground."""
        placed = [end for end in ends if not isinstance(end, str)]
        new = [ask.AddPoint(name=name, x=x, y=y) for name, x, y in placed]
        points = tuple(end if isinstance(end, str) else end[0] for end in ends)
        fixing = [ask.SetGround(points=(point,)) for point in fixed]
        self.change(*new, ask.AddLink(name=name, points=points), *fixing)

    def request(self, table: str, *picks: ask.Picked | Place | str) -> ask.DrawPart:
        """Places, points and links; ``~name`` is a link."""
        return ask.DrawPart(table=table, picks=tuple(map(self._picked, picks)), span=20.0)

    def draw(self, table: str, *picks: ask.Picked | Place | str) -> FileState:
        return self.change(self.request(table, *picks))

    def _picked(self, pick: ask.Picked | Place | str) -> ask.Picked:
        if isinstance(pick, ask.Picked):
            return pick
        if isinstance(pick, tuple):
            return ask.Picked(x=pick[0], y=pick[1])
        if pick.startswith("~"):
            return ask.Picked(x=0.0, y=0.0, link=pick[1:])
        place = self.bench.cycle.subject.description.sketched(pick)  # type: ignore[attr-defined]
        return ask.Picked(x=place.real, y=place.imag, point=pick)

    def refused(self, request: ask.Request) -> str:
        """The message of a request that changes nothing."""
        before = self.bench.text
        (event,) = self.bench.handle(request)
        assert self.bench.text == before
        if isinstance(event, tell.ProblemsFound):
            return " ".join(problem.message for problem in event.problems)
        assert isinstance(event, tell.Refused)
        return event.message

    def moves(self, drive: str, name: str, rows: int) -> lw.Motion:
        """The motion, with all rows proved."""
        self.change(ask.SetInput(drive=drive, name=name))
        motion = lw.loads(self.bench.text).sweep()
        assert int(motion.certified.sum()) == rows
        return motion


@pytest.fixture
def drawing(tmp_path: Path) -> Drawing:
    """A blank sheet."""
    return Drawing(tmp_path / "drawn.toml")


def _gears(drawing: Drawing) -> None:
    drawing.draw("gears", (0, 0), ask.Picked(x=60, y=0, size=20))
    motion = drawing.moves("link", "gear1", 361)
    assert abs(motion["gear2"][-1] - motion["gear2"][0]) == pytest.approx(720)


def _ovals(drawing: Drawing) -> None:
    drawing.draw("noncircular_gears", (0, 0), (60, 0))
    drawing.moves("link", "gear1", 361)


def _belt(drawing: Drawing) -> None:
    drawing.draw("belts", ask.Picked(x=0, y=0, size=10), ask.Picked(x=60, y=0, size=20))
    motion = drawing.moves("link", "pulley1", 361)
    assert motion["pulley2"][-1] - motion["pulley2"][0] == pytest.approx(180)


def _rack(drawing: Drawing) -> None:
    drawing.draw("racks", (0, 0), (0, -20))
    motion = drawing.moves("link", "pinion1", 361)
    assert abs(motion["s1"][90] - motion["s1"][0]) == pytest.approx(20 * 1.5707963267948966)


def _rack_of_a_block(drawing: Drawing) -> None:
    drawing.draw("racks", (0, 0), (0, -20))
    pinion = drawing.draw("racks", (0, -50), "B")  # another pinion at the same block
    assert pinion.parts == ("s1", "rack1", "rack2")
    assert pinion.part_entries[2].typed["radius"] == "30"
    drawing.moves("link", "pinion1", 361)


def _cam(drawing: Drawing) -> None:
    drawing.draw("cams", (0, 0), (0, 40))
    motion = drawing.moves("link", "cam1", 361)
    assert (motion["s1"].min(), motion["s1"].max()) == pytest.approx((40, 60))


def _swinging_cam(drawing: Drawing) -> None:
    drawing.link("arm", ("P", 60, 0), ("Q", 10, 40), fixed="P")
    drawing.draw("cams", (0, 0), "Q")
    motion = drawing.moves("link", "cam1", 361)
    assert motion["arm"].max() - motion["arm"].min() == pytest.approx(20)


def _rolling(drawing: Drawing) -> None:
    drawing.draw("rolling", (0, 20), (0, 0))
    drawing.moves("link", "wheel1", 361)


def _rolling_on_a_circle(drawing: Drawing) -> None:
    drawing.change(ask.AddPoint(name="O", x=0, y=0), ask.SetGround(points=("O",)))
    drawing.draw("rolling", (60, 0), "O")
    motion = drawing.moves("link", "wheel1", 361)
    assert motion["x1"][-1] - motion["x1"][0] == pytest.approx(180)  # circles of equal size


def _slot(drawing: Drawing) -> None:
    drawing.link("crank", ("O", 0, 60), ("P", 20, 70), fixed="O")
    drawing.link("lever", ("Q", 0, 0), ("R", 30, 120), fixed="Q")
    drawing.draw("slots", "P", "~lever")
    drawing.moves("link", "crank", 361)


def _fixed_slot(drawing: Drawing) -> None:
    drawing.link("crank", ("O", 0, 0), ("P", 20, 10), fixed="O")
    drawing.link("rod", "P", ("Q", 80, 0))
    drawing.draw("slots", "Q", (110, 0))
    drawing.moves("link", "crank", 361)


def _cylinder(drawing: Drawing) -> None:
    drawing.link("boom", ("O", 0, 0), ("P", 50, 10), fixed="O")
    state = drawing.draw("cylinders", (20, -40), ask.Picked(x=30, y=6, link="boom"))
    fix = next(r for lack in state.lacks for r in lack.remedies if r.label.startswith("Fix"))
    assert fix.label == "Fix A"  # its free end, not that of the boom
    drawing.change(*fix.edits)
    drawing.moves("cylinder", "c1", 101)


def _weld(drawing: Drawing) -> None:
    drawing.link("crank", ("O", 0, 0), ("P", 20, 10), fixed="O")
    drawing.link("rod", "P", ("Q", 80, 40))
    drawing.link("rocker", "Q", ("R", 80, -20), fixed="R")
    drawing.link("hand", "P", ("S", -10, 40))
    drawing.draw("welds", "~crank", "~hand")
    motion = drawing.moves("link", "crank", 361)
    turned = motion["hand"] - motion["crank"]
    assert turned == pytest.approx(turned[0])


def _spring(drawing: Drawing) -> None:
    drawing.link("crank", ("O", 0, 0), ("P", 20, 10), fixed="O")
    state = drawing.draw("springs", "P", (0, 40))
    assert state.links[1].points == ("O", "A")  # a spring needs a fixed end
    drawing.moves("link", "crank", 361)


def _curve(drawing: Drawing) -> None:
    drawing.link("crank", ("O", 0, 0), ("P", 20, 10), fixed="O")
    drawing.link("rod", "P", ("Q", 80, 0))
    state = drawing.draw("curves", "Q", (90, 10), (100, 15), (110, 10), (115, 5))
    assert len(state.part_entries[0].typed["through"]) == 5  # the pin is on it
    drawing.change(ask.SetInput(drive="link", name="crank", start=0, stop=10, step=1))
    assert lw.loads(drawing.bench.text).sweep().found.any()


def _load(drawing: Drawing) -> None:
    drawing.link("arm", ("O", 0, 0), ("P", 50, 0), fixed="O")
    drawing.draw("loads", "P", (60, -8))
    drawing.change(ask.SetInput(drive="link", name="arm"))
    effort = lw.loads(drawing.bench.text).forces(at=0)["arm.effort"]
    assert effort == pytest.approx(8.0 * 50.0)


DRAWN: dict[str, tuple[Callable[[Drawing], None], ...]] = {
    "slots": (_slot, _fixed_slot),
    "cylinders": (_cylinder,),
    "welds": (_weld,),
    "gears": (_gears,),
    "noncircular_gears": (_ovals,),
    "belts": (_belt,),
    "racks": (_rack, _rack_of_a_block),
    "rolling": (_rolling, _rolling_on_a_circle),
    "cams": (_cam, _swinging_cam),
    "curves": (_curve,),
    "springs": (_spring,),
    "loads": (_load,),
}


@pytest.mark.parametrize("moved", [one for tests in DRAWN.values() for one in tests])
def test_a_drawn_part_moves(moved: Callable[[Drawing], None], drawing: Drawing) -> None:
    moved(drawing)


def test_every_kind_of_part_can_be_drawn() -> None:
    otherwise = {"sliders", "couplings"}  # they have another tool, or a form
    assert {part.table for part in PALETTE if part.picks} == set(PARTS) - otherwise
    assert set(DRAWN) == set(PARTS) - otherwise


def test_gears_on_an_arm_are_held_by_a_remedy(drawing: Drawing) -> None:
    drawing.link("arm", ("O", 0, 0), ("P", 50, 0), fixed="O")
    state = drawing.draw("gears", "O", "P")
    remedies = {remedy.label: remedy for lack in state.lacks for remedy in lack.remedies}
    assert list(remedies) == ["Drive arm", "Drive gear1", "Hold gear1"]
    drawing.change(*remedies["Hold gear1"].edits)
    motion = drawing.moves("link", "arm", 361)
    assert motion["gear2"][-1] - motion["gear2"][0] == pytest.approx(720)


def test_a_gear_is_shared_by_several_pairs_and_a_ring_goes_around_it(drawing: Drawing) -> None:
    drawing.link("arm", ("O", 0, 0), ("P", 50, 0), fixed="O")
    drawing.draw("gears", "O", ask.Picked(x=50, y=0, point="P", size=20))
    state = drawing.draw("gears", "P", "O")
    sun, ring = state.part_entries
    assert sun.typed["wheels"] == ("gear1", "gear2")
    assert ring.typed["wheels"] == ("gear2", "gear3")
    assert sun.typed["teeth"] == ("30, 20",)
    assert ring.typed["teeth"] == ("20, 70",)  # 30 + 2·20: sun and planet fit in the ring
    assert ring.typed["internal"] == "true"


def test_a_part_is_one_step_and_goes_with_what_served_it_alone(drawing: Drawing) -> None:
    blank = drawing.bench.text
    state = drawing.draw("gears", (0, 0), (60, 0))
    assert state.undo == "add gear pair"
    drawing.change(ask.SetInput(drive="link", name="gear1"))
    state = drawing.change(ask.RemovePart(name="mesh1", whole=True))
    assert (state.points, state.parts) == ({}, ())
    assert [link.name for link in state.links] == []
    drawing.bench.handle(ask.Undo())
    drawing.bench.handle(ask.Undo())
    drawing.bench.handle(ask.Undo())
    assert drawing.bench.text == blank


def test_what_other_parts_use_stays(drawing: Drawing) -> None:
    drawing.draw("gears", (0, 0), (60, 0))
    drawing.draw("belts", "B", (60, 90))
    state = drawing.change(ask.RemovePart(name="mesh1", whole=True))
    assert [link.name for link in state.links] == ["ground", "gear2", "pulley1"]
    assert list(state.points) == ["B", "C"]


def test_entries_of_a_part_are_typed(drawing: Drawing) -> None:
    drawing.draw("gears", (0, 0), (60, 0))
    drawing.change(ask.SetPart(name="mesh1", key="teeth", typed=("20, 40",)))
    drawing.moves("link", "gear1", 361)
    state = drawing.change(ask.SetPart(name="mesh1", key="radii", typed=("20, 40",)))
    assert "teeth" not in state.part_entries[0].typed
    message = drawing.refused(ask.SetPart(name="mesh1", key="radii", typed=("20, 41",)))
    assert message == "add up to 61, but the centres A and B are 60 apart"
    message = drawing.refused(ask.SetPart(name="mesh1", key="internal", typed="true"))
    assert message.startswith("the radii of a ring and the gear in it differ by")
    drawing.change(ask.SetPart(name="mesh1", key="teeth", typed=("20, 20",)))
    state = drawing.change(ask.SetPart(name="mesh1", key="internal", typed="true"))
    assert state.part_entries[0].typed["teeth"] == ("20, 40",)
    state = drawing.change(ask.SetPart(name="mesh1", key="internal", typed=""))
    assert "internal" not in state.part_entries[0].typed
    message = drawing.refused(ask.SetPart(name="mesh9", key="teeth", typed=("1, 2",)))
    assert message == 'there is no "mesh9" (parts: mesh1)'


@pytest.mark.parametrize(
    ("table", "picks", "message"),
    [
        ("wheels", (), "this part cannot be drawn (parts: "),
        ("gears", ((0, 0),), "this part needs 2 picks, got 1"),
        ("gears", ("O", "O"), "the two centres are at the same place"),
        ("gears", ("P", "R"), "no link carries both P and R: draw the arm"),
        ("gears", ("~nothing", "O"), 'there is no link "nothing" (links: '),
        ("welds", ("~crank", "Q"), "Q is on rod and rocker: click one link beside its pins"),
        ("welds", ("~crank", "~rocker"), "crank and rocker share no point"),
        ("slots", ((0, 0), (5, 5)), "begin at the pin that runs in the slot"),
        ("slots", ("P", "~crank"), '"crank" carries P, which cannot move in its slot'),
        ("cylinders", ((5, 5), (5, 5)), "the two ends are at the same place"),
        ("cams", ((0, 50), "Q"), '"rod" shares no pivot with "ground"'),
        ("rolling", ("O", (0, 0)), "the wheel's centre and the line are at the same place"),
        ("curves", ("Q", (90, 0)), "needs at least three points, got 2"),
    ],
)
def test_picks_that_make_no_part_are_refused_with_the_reason(
    table: str, picks: tuple[Place | str, ...], message: str, drawing: Drawing
) -> None:
    drawing.link("crank", ("O", 0, 0), ("P", 20, 10), fixed="O")
    drawing.link("rod", "P", ("Q", 80, 40))
    drawing.link("rocker", "Q", ("R", 90, 0))
    found = drawing.refused(drawing.request(table, *picks))
    assert message in found, found


def test_a_part_that_lost_its_points_is_removed_by_a_remedy(drawing: Drawing) -> None:
    drawing.draw("springs", (0, 0), (40, 0))
    drawing.draw("gears", (0, 50), (60, 50))
    state = drawing.change(ask.RemovePoint(name="D"))
    remedies = [remedy for lack in state.lacks for remedy in lack.remedies]
    assert "Remove mesh1" in [remedy.label for remedy in remedies]
    state = drawing.change(*remedies[0].edits)
    assert state.parts == ("spring1",)


@pytest.mark.parametrize(
    ("table", "second", "role"),
    [("cams", (0, 40), "wheel"), ("noncircular_gears", (60, 0), "wheel")],
)
def test_outlines_are_drawn_before_the_part_moves(
    table: str, second: Place, role: str, drawing: Drawing
) -> None:
    drawing.bench.handle(ask.SetSheet(width=240, edited=True))
    events = drawing.bench.handle(drawing.request(table, (0, 0), second))
    sketch = next(event for event in events if isinstance(event, tell.SketchShown))
    assert role in {part.role for part in sketch.page.motions[0].parts}
