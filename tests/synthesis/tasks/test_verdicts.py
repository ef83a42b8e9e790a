"""Defects of four-bars and slider-cranks, against circuits and closely spaced positions."""

from __future__ import annotations

import numpy as np
import pytest

from linkwork.synthesis.defects.verdicts import DefectKind, judge
from linkwork.synthesis.loops.driven_loop import NOWHERE, Range, pivots_at
from linkwork.synthesis.loops.limits import Candidates, Drive, LoopKind, cross, driven_loops
from linkwork.synthesis.tasks.conditions import Wishes, distances_to_segments
from tests.campaigns.defects import defect_campaign, random_designs

_POSSIBLE = [
    (LoopKind.FOUR_BAR, Drive.A0),
    (LoopKind.FOUR_BAR, Drive.B0),
    (LoopKind.SLIDER_CRANK, Drive.A0),
    (LoopKind.SLIDER_CRANK, Drive.SLIDER),
    (LoopKind.INVERTED, Drive.A0),
    (LoopKind.INVERTED, Drive.B0),
    (LoopKind.DOUBLE_SLIDER, Drive.SLIDER_A),
    (LoopKind.DOUBLE_SLIDER, Drive.SLIDER),
    (LoopKind.RAPSON, Drive.SLIDER_A),
    (LoopKind.RAPSON, Drive.B0),
    (LoopKind.OLDHAM, Drive.A0),
    (LoopKind.OLDHAM, Drive.B0),
]


def test_verdicts_are_those_of_circuits() -> None:
    _, false = defect_campaign(0, 12)
    assert not false


@pytest.mark.extended
def test_verdicts_are_those_of_circuits_often() -> None:
    _, false = defect_campaign(1, 40)
    assert not false


def test_a_side_that_is_exchanged_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The comparison with circuits is able to find a wrong verdict."""
    import tests.campaigns.defects as campaign

    monkeypatch.setattr(campaign, "verdict_by_circuits", lambda *given: DefectKind.CIRCUIT)
    _, false = campaign.defect_campaign(0, 12)
    assert false


@pytest.mark.parametrize("factor", [1e-6, 1e6])
@pytest.mark.parametrize(("kind", "drive"), _POSSIBLE)
def test_doubts_are_those_of_the_same_mechanism_in_other_units(
    kind: LoopKind, drive: Drive, factor: float
) -> None:
    given = random_designs(kind, 40, 8)
    here, there = (judge(g, drive, Wishes()) for g in (given, given.moved(0.0, factor)))
    for name in ("side", "half"):
        shares = [
            v.loops.sign_error[:, None] / np.abs(getattr(v.loops, name)) for v in (here, there)
        ]
        # a few roundings more: the designs were multiplied
        assert (shares[1] <= 3.0 * shares[0]).all()
        assert (shares[1] >= shares[0] / 3.0).all()
    assert all(np.array_equal(own, there.defects[kind]) for kind, own in here.defects.items())
    assert there.transmission == pytest.approx(here.transmission, abs=1e-6, nan_ok=True)


@pytest.mark.parametrize(("kind", "drive"), _POSSIBLE)
def test_positions_in_closed_form_are_those_given(kind: LoopKind, drive: Drive) -> None:
    given = random_designs(kind, 60, 4)
    loops = driven_loops(given, drive)
    same = (np.sign(loops.side) == np.sign(loops.side[:, :1])).all(axis=1)
    given, loops = given.take(np.flatnonzero(same)), loops.take(np.flatnonzero(same))
    a, b, p = pivots_at(given, drive, loops, loops.input - loops.origin[:, None])
    for found, expected in ((a, given.moving_a), (b, given.moving_b), (p, given.guided)):
        # to rounding, magnified where a loop is nearly closed up
        assert np.abs(found - expected).max() < 1e-6


@pytest.mark.parametrize(("kind", "drive"), _POSSIBLE)
def test_transmission_is_that_of_close_positions(kind: LoopKind, drive: Drive) -> None:
    given = random_designs(kind, 200, 5)
    verdicts = judge(given, drive, Wishes())
    sound = np.flatnonzero(verdicts.sound)
    assert len(sound) > 3
    some, loops = given.take(sound), verdicts.loops.take(sound)
    share = np.linspace(0.0, 1.0, 4001)
    first, last = verdicts.travel.first[sound], verdicts.travel.last[sound]
    a, b, _ = pivots_at(some, drive, loops, first[:, None] + (last - first)[:, None] * share)
    if kind is LoopKind.SLIDER_CRANK and drive is Drive.A0:
        other = 1j * some.direction[:, None]
    elif kind is LoopKind.OLDHAM:
        other = 1j * some.direction_a[:, None] * (b - a)
    elif kind is LoopKind.RAPSON and drive is Drive.B0:
        other = 1j * some.direction_a[:, None]
    elif kind is LoopKind.DOUBLE_SLIDER:
        line = some.direction if drive is Drive.SLIDER_A else some.direction_a
        other = 1j * line[:, None]
    elif drive is not Drive.B0 and kind in (LoopKind.INVERTED, LoopKind.RAPSON):
        other = a - some.fixed_b[:, None]
    elif drive is Drive.A0:
        other = b - some.fixed_b[:, None]
    else:
        other = a - some.fixed_a[:, None]
    arm = b - a
    if kind.body_line:
        # the force of the block is across the line
        arm = 1j * some.direction[:, None] * arm
    cosine = np.abs((arm * other.conj()).real) / (np.abs(arm) * np.abs(other))
    least = np.arccos(np.clip(cosine.max(axis=1), 0.0, 1.0))
    bound = verdicts.transmission[sound]
    assert (bound <= least + 1e-7).all()
    # 4000 steps: the extreme lies within one of them
    assert (bound >= least - 2e-3).all()


def _crank_rocker(degrees: list[float]) -> Candidates:
    """Ground 4, crank 1, coupler 3.5, rocker 3, open."""
    crank = np.exp(1j * np.radians(degrees))
    base = 4.0 - crank
    along = 0.5 * (np.abs(base) ** 2 + 3.5**2 - 9.0)
    across = np.sqrt(np.abs(base) ** 2 * 3.5**2 - along**2)
    moving = crank + base * (along + 1j * across) / np.abs(base) ** 2
    return Candidates(
        kind=LoopKind.FOUR_BAR,
        fixed_a=np.array([0j]),
        fixed_b=np.array([4 + 0j]),
        direction=np.array([0j]),
        moving_a=crank[None],
        moving_b=moving[None],
        guided=0.5 * (crank + moving)[None],
        error=np.array([1e-14]),
        miss=np.zeros(1),
    )


@pytest.mark.parametrize(
    ("degrees", "in_order"),
    [
        ([0.0, 90.0, 200.0], True),
        ([200.0, 90.0, 0.0], True),
        ([300.0, 20.0, 100.0], True),
        ([0.0, 200.0, 90.0, 300.0], False),
        ([10.0, 20.0, 15.0, 30.0], False),
    ],
)
def test_a_turning_crank_passes_positions_in_cyclic_order(
    degrees: list[float], in_order: bool
) -> None:
    verdicts = judge(_crank_rocker(degrees), Drive.A0, Wishes())
    assert verdicts.loops.is_free[0]
    assert bool(verdicts.defects[DefectKind.ORDER][0]) is not in_order
    anyway = judge(_crank_rocker(degrees), Drive.A0, Wishes(ordered=False))
    assert anyway.sound[0]


def test_the_driven_range_turns_or_ends_as_wanted() -> None:
    given = _crank_rocker([10.0, 60.0, 100.0])
    turn = judge(given, Drive.A0, Wishes(range=Range(turn=True)))
    assert turn.sound[0]
    assert turn.travel.last[0] - turn.travel.first[0] == pytest.approx(2.0 * np.pi)
    # in the direction in which the positions are passed
    back = judge(_crank_rocker([100.0, 60.0, 10.0]), Drive.A0, Wishes(range=Range(turn=True)))
    assert back.travel.last[0] - back.travel.first[0] == pytest.approx(-2.0 * np.pi)
    rocker = judge(_crank_rocker([60.0, 90.0, 120.0]), Drive.B0, Wishes(range=Range(turn=True)))
    assert rocker.defects[DefectKind.RANGE][0]
    small = judge(given, Drive.A0, Wishes(range=Range(start=0.0, stop=np.radians(80))))
    assert small.travel.unreached[0] == 2
    wide = judge(given, Drive.A0, Wishes(range=Range(start=-1.0, stop=2.0)))
    assert wide.travel.unreached[0] == NOWHERE
    # an absolute range belongs to any turn
    later = judge(given, Drive.A0, Wishes(range=Range(start=-1.0 + 4 * np.pi, stop=2 + 4 * np.pi)))
    assert later.travel.first[0] == pytest.approx(wide.travel.first[0])


def test_a_dead_point_and_a_change_point_are_decided_for_no_side() -> None:
    # coupler and rocker in line at the second position
    crank = np.array([[1.0 + 0j, 1.0j]])
    reach = abs(3.0 - 1.0j)
    moving = np.array([[0j, 1.0j + (3.0 - 1.0j) * (0.6 * reach / reach)]])
    moving[0, 0] = 1.0 + 0.6 * reach * np.exp(0.3j)
    given = Candidates(
        kind=LoopKind.FOUR_BAR,
        fixed_a=np.array([0j]),
        fixed_b=np.array([3.0 + 0j]),
        direction=np.array([0j]),
        moving_a=crank,
        moving_b=moving,
        guided=crank,
        error=np.array([1e-14]),
        miss=np.zeros(1),
    )
    assert judge(given, Drive.A0, Wishes()).defects[DefectKind.NOT_PROVED][0]
    unproved = _crank_rocker([0.0, 50.0])
    unproved.error[:] = np.inf
    assert judge(unproved, Drive.A0, Wishes()).defects[DefectKind.NOT_PROVED][0]


def test_lengths_regions_and_transmission_refuse_what_they_exclude() -> None:
    given = _crank_rocker([0.0, 50.0])

    def kinds(wishes: Wishes) -> set[DefectKind]:
        found = judge(given, Drive.A0, wishes).defects
        return {kind for kind, wrong in found.items() if wrong[0]}

    square = np.array([-1 - 1j, 5 - 1j, 5 + 1j, -1 + 1j])
    assert kinds(Wishes(region=square, shortest=1.0 - 1e-12, longest=4.0, ratio=4.0)) == set()
    assert kinds(Wishes(region=square - 2)) == {DefectKind.PIVOTS}
    # pivots on the border are inside
    assert kinds(Wishes(region=np.array([0j, 4 + 0j, 2 + 3j]))) == set()
    assert kinds(Wishes(shortest=1.01)) == {DefectKind.LENGTHS}
    assert kinds(Wishes(longest=3.99)) == {DefectKind.LENGTHS}
    assert kinds(Wishes(ratio=3.99)) == {DefectKind.LENGTHS}
    assert kinds(Wishes(transmission=np.radians(80))) == {DefectKind.TRANSMISSION}


@pytest.mark.parametrize(("kind", "drive"), _POSSIBLE)
def test_obstacles_are_met_where_close_positions_meet_them(kind: LoopKind, drive: Drive) -> None:
    given = random_designs(kind, 150, 6)
    verdicts = judge(given, drive, Wishes(transmission=np.radians(10)))
    sound = np.flatnonzero(verdicts.sound)
    circle = np.array([[0.9, 1.1, 0.25]])
    met = judge(given, drive, Wishes(obstacles=circle)).defects[DefectKind.OBSTACLE][sound]
    some, loops = given.take(sound), verdicts.loops.take(sound)
    first, last = verdicts.travel.first[sound], verdicts.travel.last[sound]
    places = first[:, None] + (last - first)[:, None] * np.linspace(0.0, 1.0, 1500)
    a, b, p = pivots_at(some, drive, loops, places)
    one, other = (np.broadcast_to(z[:, None], a.shape) for z in (some.fixed_a, some.fixed_b))
    bars = [(a, b), (a, p), (b, p)]
    bars += [(one, a)] if "A0" in kind.pivots else []
    bars += [(other, b)] if "B0" in kind.pivots else []
    if kind.body_line:
        # the body's lines through its blocks end in one corner
        line = some.direction[:, None] * (b - a) / np.abs(b - a)
        corner = a + 1j * cross(line, b - a) * line
        if kind is LoopKind.OLDHAM:
            own = some.direction_a[:, None] * (b - a) / np.abs(b - a)
            corner = a + own * cross(b - a, line) / cross(own, line)
            bars += [(corner, one)]
        bars += [(corner, a), (corner, b), (corner, other)]
    centre = np.asarray(0.9 + 1.1j)
    gap = np.min([distances_to_segments(centre, *bar) for bar in bars], axis=0).min(axis=1) - 0.25
    assert 0 < met.sum() < len(met)
    assert met[gap < 0].all()
    # 1500 steps of a range of at most a turn miss a contact by less than this
    assert not met[gap > 5e-3].any()
