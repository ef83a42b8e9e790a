"""Parts drawn in the canvas: what was picked becomes the edits that add the part."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping
from itertools import pairwise

from linkwork.foundation.errors import InputError, choices
from linkwork.foundation.names import GROUND
from linkwork.mechanism.draft import Draft
from linkwork.viewer.live import requests as ask
from linkwork.viewer.live.drawn_sheet import DrawnSheet
from linkwork.viewer.live.moving_points import Before
from linkwork.viewer.live.palette import Typed
from linkwork.viewer.live.part_tools import PICKS
from linkwork.viewer.live.wheel_sizes import gear_teeth, pulley_radii

__all__ = ["edits_of_drawing"]

_LAW = "-(phi + 2*atan(0.3*sin(phi)/(1 - 0.3*cos(phi))))"  # two equal ellipses


def edits_of_drawing(drawn: ask.DrawPart, before: Before) -> tuple[ask.Edit, ...]:
    """The points, links and parts that a drawn part adds.

    Raises
    ------
    InputError, UnknownNameError
        If what was picked does not make such a part; with the reason.
    """
    if drawn.table not in _DRAWN:
        raise InputError(f"this part cannot be drawn {choices('parts', _DRAWN, drawn.table)}")
    wanted = PICKS[drawn.table]
    enough = len(drawn.picks) == len(wanted) or (
        wanted[-1].repeated and len(drawn.picks) >= len(wanted)
    )
    if not enough or not drawn.span > 0:
        raise InputError(f"this part needs {len(wanted)} picks, got {len(drawn.picks)}")
    if not isinstance(before.description, Draft):
        raise InputError("the points of this file follow from its equations: edit its text")
    sheet = DrawnSheet(before, drawn.span)
    _DRAWN[drawn.table](sheet, drawn.table, *drawn.picks)
    return tuple(sheet.edits)


# One function for every table: it adds the part


def _slot(sheet: DrawnSheet, table: str, pin: ask.Picked, track: ask.Picked) -> None:
    point, at = sheet.picked(pin), complex(track.x, track.y)
    if not point:
        raise InputError("begin at the pin that runs in the slot")
    name = sheet.name("s")
    if track.point or track.link:
        on = sheet.body(track)
        if point in sheet.links[on]:
            raise InputError(
                f'"{on}" carries {point}, which cannot move in its slot: take the pin off this '
                "link first, or choose another link"
            )
        line = sheet.segment(on, at)
    else:
        start = sheet.place(point)
        sheet.distinct(start, at, "the pin and the end of the slot")
        on, line = GROUND, sheet.line(start, at - start, GROUND)
    sheet.part(table, name=name, point=point, on=on, line=line)


def _strut(sheet: DrawnSheet, table: str, first: ask.Picked, second: ask.Picked) -> None:
    sheet.distinct(complex(first.x, first.y), complex(second.x, second.y), "the two ends")
    fixed = () if table == "cylinders" else (GROUND,)  # a spring carries no point
    name = sheet.name("c" if table == "cylinders" else "spring")
    ends = (sheet.end(first, *fixed), sheet.end(second, *fixed))
    sheet.part(table, name=name, between=ends)


def _weld(sheet: DrawnSheet, table: str, first: ask.Picked, second: ask.Picked) -> None:
    sheet.part(table, links=(sheet.body(first), sheet.body(second)))


def _gears(sheet: DrawnSheet, table: str, first: ask.Picked, second: ask.Picked) -> None:
    wheels, centers, arm = sheet.wheels((first, second), "gear")
    distance = abs(sheet.place(centers[1]) - sheet.place(centers[0]))
    name = sheet.name("n" if table == "noncircular_gears" else "mesh")
    typed: dict[str, Typed] = {"wheels": wheels, "centers": centers, "arm": arm}
    if table == "noncircular_gears":
        sheet.part(table, name=name, **typed, law=_LAW)
        return
    around = bool(sheet.wheel_at(centers[1])) and wheels[1] not in sheet.turning
    teeth, internal = gear_teeth(sheet.draft, wheels, distance, (first.size, second.size), around)
    flag: dict[str, Typed] = {"internal": "true"} if internal else {}
    sheet.part(table, name=name, **typed, teeth=(", ".join(map(str, teeth)),), **flag)


def _belt(sheet: DrawnSheet, table: str, first: ask.Picked, second: ask.Picked) -> None:
    wheels, centers, arm = sheet.wheels((first, second), "pulley")
    distance = abs(sheet.place(centers[1]) - sheet.place(centers[0]))
    radii = pulley_radii(sheet.draft, wheels, distance, (first.size, second.size))
    sheet.part(
        table, name=sheet.name("belt"), wheels=wheels, centers=centers, arm=arm,
        radii=(", ".join(map(_short, radii)),),
    )  # fmt: skip


def _rack(sheet: DrawnSheet, table: str, wheel: ask.Picked, bar: ask.Picked) -> None:
    pinion, center = sheet.wheel(wheel, "pinion", GROUND)
    start, at = sheet.place(center), complex(bar.x, bar.y)
    slider = sheet.slider_at(sheet.picked(bar))
    if slider is None:
        radius = sheet.distinct(start, at, "the pinion's centre and the rack")
        name = sheet.block(bar, 1j * (at - start), sheet.frame(center, pinion), None)
    else:
        name, radius = slider.name, _away_from_line(start, *map(sheet.place, slider.line))
        if sheet.same(radius):
            raise InputError(
                f"the rack's line {' '.join(slider.line)} runs through {center}: "
                "a pinion is beside its rack"
            )
    sheet.part(
        table, name=sheet.name("rack"), pinion=pinion, center=center, slider=name,
        radius=_short(radius),
    )  # fmt: skip


def _rolling(sheet: DrawnSheet, table: str, rolls: ask.Picked, track: ask.Picked) -> None:
    wheel, center = sheet.wheel(rolls, "wheel")
    start, at = sheet.place(center), complex(track.x, track.y)
    typed: dict[str, Typed] = {"name": sheet.name("x"), "wheel": wheel, "center": center}
    if around := sheet.picked(track):
        away = sheet.distinct(start, sheet.place(around), "the two centres")
        on = next((link for link in sheet.on(around) if link != wheel), GROUND)
        half = _short(away / 2)
        sheet.part(table, **typed, radius=half, on=on, circle=around, circle_radius=half)
        return
    if track.link:
        on = sheet.body(track)
        line = sheet.segment(on, at)
        radius = _away_from_line(start, *map(sheet.place, line))
    else:
        radius = sheet.distinct(start, at, "the wheel's centre and the line")
        on, line = GROUND, sheet.line(at, 1j * (at - start), GROUND)
    if sheet.same(radius):
        raise InputError(f"the line runs through {center}: a wheel is beside its line")
    sheet.part(table, **typed, radius=_short(radius), on=on, line=line)


def _cam(sheet: DrawnSheet, table: str, disc: ask.Picked, follower: ask.Picked) -> None:
    cam, center = sheet.wheel(disc, "cam", GROUND)
    start, at = sheet.place(center), complex(follower.x, follower.y)
    base = sheet.distinct(start, at, "the cam's centre and the follower")
    frame, point = sheet.frame(center, cam), sheet.picked(follower)
    half, typed = sheet.draft.angle.turn / 2, {"name": sheet.name("lift"), "cam": cam}
    lift = sheet.draft.angle.from_radians(math.radians(20))
    arm = next((link for link in sheet.on(point) if link not in (frame, cam)), "")
    slider = sheet.slider_at(point) if point else None
    if slider is not None or not arm or len(sheet.links[arm]) < 2:
        lift = base / 2
        top = None if slider else sheet.point(at + sheet.span * (at - start) / base, frame)
        line = (center, top) if top else None
        typed["slider"] = slider.name if slider else sheet.block(follower, at - start, frame, line)
    else:
        pivots = [p for p in sheet.links[arm] if p != point and p in sheet.links[frame]]
        if not pivots:
            raise InputError(
                f'"{arm}" shares no pivot with "{frame}", on which the cam turns: fix its other '
                "end to the ground, or click a block"
            )
        typed |= {"link": arm, "pivot": pivots[0], "point": point}
    segments = [f"cycloidal, {half!r}, {sign}{_short(lift)}" for sign in ("", "-")]
    sheet.part(table, **typed, center=center, base=_short(base), segments=tuple(segments))


def _curve(sheet: DrawnSheet, table: str, pin: ask.Picked, *picks: ask.Picked) -> None:
    point = sheet.picked(pin)
    if not point:
        raise InputError("begin at the pin that runs along the curve")
    on = sheet.body(picks[0]) if picks[0].link else GROUND
    places = [sheet.place(point), *(complex(pick.x, pick.y) for pick in picks)]
    distinct = [b for a, b in pairwise(places) if not sheet.same(abs(b - a))]
    places = [places[0], *distinct]
    origin = sheet.links[on][0] if sheet.links[on] else sheet.point(places[0], on)
    turn = 0.0 if on == GROUND else sheet.draft.sketched_angle(on)
    own = [(place - sheet.place(origin)) * cmath.exp(-1j * turn) for place in places]
    through = tuple(f"{_short(z.real)}, {_short(z.imag)}" for z in own)
    sheet.part(table, name=sheet.name("u"), point=point, on=on, origin=origin, through=through)


_DRAWN: Mapping[str, Callable[..., None]] = {
    "slots": _slot,
    "cylinders": _strut,
    "springs": _strut,
    "welds": _weld,
    "gears": _gears,
    "noncircular_gears": _gears,
    "belts": _belt,
    "racks": _rack,
    "rolling": _rolling,
    "cams": _cam,
    "curves": _curve,
}


def _short(number: float) -> str:
    return f"{number:.6g}"


def _away_from_line(place: complex, start: complex, end: complex) -> float:
    """The distance of a place from a line."""
    along = end - start
    return abs(((place - start) * along.conjugate()).imag) / abs(along) if along else 0.0
