"""A draft to which picks in the drawing add points, links and parts."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise

from linkwork.app.live.file_state import Pick
from linkwork.app.live.moving_points import Before, gear_teeth, pulley_radii
from linkwork.app.live.requests import (
    AddLink,
    AddPart,
    AddPoint,
    DrawPart,
    Edit,
    Picked,
    SetGround,
    Typed,
)
from linkwork.core.foundation.errors import InputError, choices
from linkwork.core.foundation.names import GROUND, canonical, find_spelling
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.part.gears import ArmPair
from linkwork.core.mechanism.part.guides import Slider
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.mechanism.part.part import turning_links

_LETTERS = "ABCDFGHJKLMNPQRSTUVWXYZ"  # as of points drawn on the page
#: Of the span: places nearer to each other are the same.
_LEAST = 1e-9


class DrawnSheet:
    """A draft to which points, links and parts are added."""

    def __init__(self, before: Before, drawn: DrawPart) -> None:
        assert isinstance(before.description, Draft)
        self.draft = before.description.drawable
        self.span, self._table, self._before = drawn.span, drawn.table, before
        self.links = {name: list(points) for name, points in before.description.links.items()}
        self.links.setdefault(GROUND, [])
        self.turning = set(turning_links(self.draft))
        self.edits: list[Edit] = []
        self._new: dict[str, complex] = {}
        names = [*before.description.points, *self.links]
        names += [name for part in before.description.parts for name in (part.label, *part.names)]
        self._taken = set(map(canonical, names))

    # Places and names

    def place(self, point: str) -> complex:
        """The coordinates of a point."""
        return self._new[point] if point in self._new else self._before.place(point)

    def on(self, point: str) -> list[str]:
        """The links at a point, ground first."""
        links = [link for link, points in self.links.items() if point in points]
        return sorted(links, key=lambda link: link != GROUND)

    def name(self, base: str) -> str:
        """A free name: gear1, gear2, …"""
        return self._free(f"{base}{k}" for k in range(1, len(self._taken) + 2))

    def _free(self, names: Iterator[str]) -> str:
        free = next(name for name in names if canonical(name) not in self._taken)
        self._taken.add(canonical(free))
        return free

    # What is added

    def point(self, place: complex, *links: str) -> str:
        """A new point on links."""
        rounds = range(len(self._taken) + 1)
        name = self._free(f"{letter}{k or ''}" for k in rounds for letter in _LETTERS)
        self._new[name] = place
        moving = tuple(link for link in links if link != GROUND)
        self.edits.append(AddPoint(name=name, x=place.real, y=place.imag, links=moving))
        if GROUND in links:
            self.edits.append(SetGround(points=(name,)))
        for link in links:
            self.links[link].append(name)
        return name

    def link(self, base: str, *points: str) -> str:
        """A new link through points."""
        name = self.name(base)
        self.links[name] = list(points)
        self.edits.append(AddLink(name=name, points=points))
        return name

    def finish(self, **typed: Typed) -> None:
        """The part that is drawn."""
        self.edits.append(AddPart(table=self._table, typed=typed))

    def line(self, through: complex, along: complex, on: str) -> tuple[str, str]:
        """Two new points on a link, on both sides of a place."""
        step = self.span * along / abs(along)
        return self.point(through - step, on), self.point(through + step, on)

    # What was picked

    def picked(self, pick: Picked) -> str:
        """The point that was picked, as it is spelled in the file; "" if none was."""
        if not pick.point:
            return ""
        name = find_spelling(pick.point, self.draft.points)
        if name not in self.draft.points:
            known = choices("points", self.draft.points, pick.point)
            raise InputError(f'there is no point "{pick.point}" {known}')
        return name

    def body(self, pick: Picked) -> str:
        """The link that was picked, itself or by one of its points; a fixed point is the ground."""
        if pick.link:
            name = find_spelling(pick.link, self.links)
            if name not in self.links:
                raise InputError(
                    f'there is no link "{pick.link}" {choices("links", self.links, pick.link)}'
                )
            return name
        point = self.picked(pick)
        links = self.on(point) if point else [GROUND]
        if not links or (len(links) > 1 and links[0] != GROUND):
            raise InputError(f"{point} is on {_listed(links)}: click one link beside its pins")
        return links[0]

    def end(self, pick: Picked, *links: str) -> str:
        """The point that was picked, or a new one on the link there, otherwise on ``links``."""
        on = (self.body(pick),) if pick.link else links
        return self.picked(pick) or self.point(complex(pick.x, pick.y), *on)

    def same(self, away: float) -> bool:
        """Whether a distance is practically zero."""
        return not away > _LEAST * self.span

    def distinct(self, first: complex, second: complex, what: str) -> float:
        """The distance of two places, which may not be zero."""
        away = abs(second - first)
        if self.same(away):
            raise InputError(f"{what} are at the same place: pick two different places")
        return away

    def segment(self, link: str, at: complex) -> tuple[str, str]:
        """The two neighbouring points of a link that are nearest to a place."""
        points = self.links[link]
        pairs = [*pairwise(points), *([(points[0], points[-1])] if len(points) > 2 else [])]
        if not pairs:
            raise InputError(f'"{link}" has one point and no line: pick a link with two points')
        return min(pairs, key=lambda pair: _away(at, *map(self.place, pair)))

    # Wheels

    def wheel_at(self, point: str, apart: str | None = None) -> str:
        """The wheel about a point, if it is not yet paired with the wheel ``apart``; or ""."""
        paired = {frozenset(part.wheels) for part in self.draft.of(ArmPair) if apart in part.wheels}
        for link in self.on(point):
            if link != GROUND and link in self.turning and {link, apart} not in paired:
                return link
        return ""

    def wheel(self, pick: Picked, base: str, *links: str) -> tuple[str, str]:
        """A wheel with its centre: the link that was picked, or a new one about the place."""
        if pick.link:
            link, at = self.body(pick), complex(pick.x, pick.y)
            shared = [point for point in self.links[link] if len(self.on(point)) > 1]
            near = sorted(shared or self.links[link], key=lambda p: abs(self.place(p) - at))
            fixed = [point for point in near if point in self.links[GROUND]]
            return link, (fixed or near)[0]
        center = self.end(pick, *links)
        wheel = self.wheel_at(center)
        return wheel or self.link(base, center), center

    def wheels(
        self, picks: tuple[Picked, Picked], base: str
    ) -> tuple[tuple[str, str], tuple[str, str], str]:
        """Two wheels, their centres and their arm."""
        bodies = [self.body(pick) if pick.link else "" for pick in picks]
        points = [self.picked(pick) for pick in picks]
        arm = self._arm(bodies, points)
        centers = []
        for link, point, pick in zip(bodies, points, picks, strict=True):
            shared = next((p for p in self.links.get(link, ()) if p in self.links[arm]), "")
            place = complex(pick.x, pick.y)
            centers.append(point or shared or self.point(place, arm))
        if not bodies[0]:
            bodies[0] = self.wheel_at(centers[0]) or self.link(base, centers[0])
        if not bodies[1]:
            bodies[1] = self.wheel_at(centers[1], bodies[0]) or self.link(base, centers[1])
        first, second = centers
        self.distinct(self.place(first), self.place(second), "the two centres")
        return (bodies[0], bodies[1]), (first, second), arm

    def _arm(self, links: list[str], points: list[str]) -> str:
        """The link that carries both centres, ground first; new centres can be on any link."""
        arms = sorted((link for link in self.links if link not in links), key=lambda k: k != GROUND)
        if not any((*links, *points)):
            return GROUND
        for arm in arms:
            on_arm = set(self.links[arm])
            held = [
                bool(on_arm & set(self.links[link])) if link else not point or point in on_arm
                for link, point in zip(links, points, strict=True)
            ]
            if all(held) and not (arm in self.turning and len(on_arm) == 1):
                return arm
        names = [body or point for body, point in zip(links, points, strict=True)]
        raise InputError(
            f"no link carries both {_listed(names)}:"
            " draw the arm between the centres first, or fix both centres to the ground"
        )

    def frame(self, center: str, wheel: str) -> str:
        """The link on which a wheel turns: ground if its centre is fixed."""
        return next((link for link in self.on(center) if link != wheel), GROUND)

    def slider_at(self, point: str) -> Slider | None:
        """The block pinned at a point."""
        return next((s for s in self.draft.of(Slider) if point in s.points), None)

    def block(self, pick: Picked, along: complex, on: str, line: tuple[str, str] | None) -> str:
        """A new block on a line of a link; the name of its displacement."""
        point = self.picked(pick) or self.point(complex(pick.x, pick.y))
        line = line or self.line(self.place(point), along, on)
        block, name = self.link("block", point), self.name("s")
        typed: dict[str, Typed] = {
            "name": name,
            "link": block,
            "points": (point,),
            "on": on,
            "line": line,
        }
        self.edits.append(AddPart(table="sliders", typed=typed))
        return name


def _away(place: complex, start: complex, end: complex) -> float:
    """The distance of a place from a segment."""
    along = end - start
    square = abs(along) ** 2
    share = ((place - start) * along.conjugate()).real / square if square else 0.0
    return abs(place - start - min(1.0, max(0.0, share)) * along)


def _listed(names: list[str]) -> str:
    return " and ".join(names) or "no link"


def short(number: float) -> str:
    """A typed number."""
    return f"{number:.6g}"


def away_from_line(place: complex, start: complex, end: complex) -> float:
    """The distance of a place from a line."""
    along = end - start
    return abs(((place - start) * along.conjugate()).imag) / abs(along) if along else 0.0


# ----------------------------------------------------------------------
# What is picked for a part, and the part drawn from it.


# ----------------------------------------------------------------------
# Picks of drawing tools: the things or places that a part needs, each with its prompt.


ANYWHERE = ("point", "link", "place")


def pick(prompt: str, *takes: str, sized: bool = False, repeated: bool = False) -> Pick:
    """A pick of a point, a link or a place."""
    return Pick(prompt=prompt, takes=takes, sized=sized, repeated=repeated)


def end(prompt: str) -> Pick:
    """A point, a place on a link or a free place."""
    return pick(prompt, *ANYWHERE)


def wheel(prompt: str) -> Pick:
    """The centre of a wheel or a link; a drag from it sets its radius."""
    return pick(prompt, *ANYWHERE, sized=True)


# ----------------------------------------------------------------------
# What is picked for a belt, and the belt drawn from it.


BELT_PICKS = (
    wheel("Click the first pulley's centre or link; drag from it to set its radius."),
    wheel("Click the second pulley's centre or link; drag from it to set its radius."),
)


def draw_belt(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add the belt around two pulleys."""
    wheels, centers, arm = sheet.wheels((first, second), "pulley")
    distance = abs(sheet.place(centers[1]) - sheet.place(centers[0]))
    radii = pulley_radii(sheet.draft, wheels, distance, (first.size, second.size))
    sheet.finish(
        name=sheet.name("belt"), wheels=wheels, centers=centers, arm=arm,
        radii=(", ".join(map(short, radii)),),
    )  # fmt: skip


# ----------------------------------------------------------------------
# What is picked for a cam, and the cam drawn from it.


CAM_PICKS = (
    end("Click the cam's centre, or the link that is the cam."),
    pick("Click the follower: a block, the end of a link, or a place.", "point", "place"),
)


def draw_cam(sheet: DrawnSheet, disc: Picked, follower: Picked) -> None:
    """Add the cam with a follower that exists, or a new block."""
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
    segments = [f"cycloidal, {half!r}, {sign}{short(lift)}" for sign in ("", "-")]
    sheet.finish(**typed, center=center, base=short(base), segments=tuple(segments))


# ----------------------------------------------------------------------
# What is picked for a curve, and the curve drawn from it.


CURVE_PICKS = (
    pick("Click the pin that runs along the curve.", "point"),
    pick(
        "Click places along the curve; Enter, or a click on the last place, ends it.",
        *ANYWHERE,
        repeated=True,
    ),
)


def draw_curve(sheet: DrawnSheet, pin: Picked, *picks: Picked) -> None:
    """Add the curve through the pin and the places."""
    point = sheet.picked(pin)
    if not point:
        raise InputError("begin at the pin that runs along the curve")
    on = sheet.body(picks[0]) if picks[0].link else GROUND
    places = [sheet.place(point), *(complex(pick.x, pick.y) for pick in picks)]
    distinct = [b for a, b in pairwise(places) if not sheet.same(abs(b - a))]
    places = [places[0], *distinct]
    origin = sheet.links[on][0] if sheet.links[on] else sheet.point(places[0], on)
    turn = 0.0 if on == GROUND else sheet.draft.sketched_angle(on)
    local = [(place - sheet.place(origin)) * cmath.exp(-1j * turn) for place in places]
    through = tuple(f"{short(z.real)}, {short(z.imag)}" for z in local)
    sheet.finish(name=sheet.name("u"), point=point, on=on, origin=origin, through=through)


# ----------------------------------------------------------------------
# What is picked for a cylinder, and the cylinder drawn from it.


CYLINDER_PICKS = (
    end("Drag from one end of the cylinder to the other."),
    end("Click the other end of the cylinder."),
)


def draw_cylinder(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add the cylinder between two points."""
    sheet.distinct(complex(first.x, first.y), complex(second.x, second.y), "the two ends")
    name = sheet.name("c")
    ends = (sheet.end(first), sheet.end(second))
    sheet.finish(name=name, between=ends)


# ----------------------------------------------------------------------
# What is picked for a gear pair, and the gears drawn from it.


GEAR_PICKS = (
    wheel("Click the first gear's centre, or the link that is the gear."),
    wheel("Click the second gear's centre or link; drag from it to set its radius."),
)


def draw_gear(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add the two gears; teeth fit any distance of the centres."""
    wheels, centers, arm = sheet.wheels((first, second), "gear")
    distance = abs(sheet.place(centers[1]) - sheet.place(centers[0]))
    around = bool(sheet.wheel_at(centers[1])) and wheels[1] not in sheet.turning
    teeth, internal = gear_teeth(sheet.draft, wheels, distance, (first.size, second.size), around)
    flag = {"internal": "true"} if internal else {}
    sheet.finish(
        name=sheet.name("mesh"), wheels=wheels, centers=centers, arm=arm,
        teeth=(", ".join(map(str, teeth)),), **flag,
    )  # fmt: skip


# ----------------------------------------------------------------------
# What is picked for a load, and the force drawn from it.


LOAD_PICKS = (
    pick("Drag from a point in the direction of its force.", "point"),
    pick("Click the tip of the force: a unit of length is a unit of force.", "place"),
)


def draw_load(sheet: DrawnSheet, start: Picked, tip: Picked) -> None:
    """Add the force on a point; its length in the drawing is its size."""
    point = sheet.picked(start)
    if not point:
        raise InputError("a force acts on a point: pick one")
    place = sheet.place(point)
    force = complex(tip.x, tip.y) - place
    sheet.distinct(place, place + force, "the point and the tip")
    components = ", ".join(map(short, (force.real, force.imag)))
    sheet.finish(point=point, force=(components,))


# ----------------------------------------------------------------------
# What is picked for non-circular gears, and the gears drawn from it.


_LAW = "-(phi + 2*atan(0.3*sin(phi)/(1 - 0.3*cos(phi))))"

NONCIRCULAR_GEAR_PICKS = (
    end("Click the first gear's centre, or the link that is the gear."),
    end("Click the second gear's centre or link."),
)


def draw_noncircular_gear(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add two equal ellipses."""
    wheels, centers, arm = sheet.wheels((first, second), "gear")
    sheet.finish(name=sheet.name("n"), wheels=wheels, centers=centers, arm=arm, law=_LAW)


# ----------------------------------------------------------------------
# What is picked for a rack and pinion, and the rack drawn from it.


RACK_PICKS = (
    end("Click the pinion's centre, or the link that is the pinion."),
    pick("Click the block that is the rack, or where the rack runs.", "point", "place"),
)


def draw_rack(sheet: DrawnSheet, wheel: Picked, bar: Picked) -> None:
    """Add the pinion at a rack that exists, or at a new block."""
    pinion, center = sheet.wheel(wheel, "pinion", GROUND)
    start, at = sheet.place(center), complex(bar.x, bar.y)
    slider = sheet.slider_at(sheet.picked(bar))
    if slider is None:
        radius = sheet.distinct(start, at, "the pinion's centre and the rack")
        name = sheet.block(bar, 1j * (at - start), sheet.frame(center, pinion), None)
    else:
        name, radius = slider.name, away_from_line(start, *map(sheet.place, slider.line))
        if sheet.same(radius):
            raise InputError(
                f"the rack's line {' '.join(slider.line)} runs through {center}: "
                "a pinion is beside its rack"
            )
    sheet.finish(
        name=sheet.name("rack"), pinion=pinion, center=center, slider=name,
        radius=short(radius),
    )  # fmt: skip


# ----------------------------------------------------------------------
# What is picked for a rolling wheel, and the wheel drawn from it.


ROLLING_PICKS = (
    end("Click the wheel's centre, or the link that is the wheel."),
    end("Click the link on which it rolls, the centre of a circle, or a place of the ground."),
)


def draw_rolling(sheet: DrawnSheet, rolls: Picked, track: Picked) -> None:
    """Add the wheel on a line or circle."""
    wheel, center = sheet.wheel(rolls, "wheel")
    start, at = sheet.place(center), complex(track.x, track.y)
    typed: dict[str, Typed] = {"name": sheet.name("x"), "wheel": wheel, "center": center}
    if around := sheet.picked(track):
        away = sheet.distinct(start, sheet.place(around), "the two centres")
        on = next((link for link in sheet.on(around) if link != wheel), GROUND)
        half = short(away / 2)
        sheet.finish(**typed, radius=half, on=on, circle=around, circle_radius=half)
        return
    if track.link:
        on = sheet.body(track)
        line = sheet.segment(on, at)
        radius = away_from_line(start, *map(sheet.place, line))
    else:
        radius = sheet.distinct(start, at, "the wheel's centre and the line")
        on, line = GROUND, sheet.line(at, 1j * (at - start), GROUND)
    if sheet.same(radius):
        raise InputError(f"the line runs through {center}: a wheel is beside its line")
    sheet.finish(**typed, radius=short(radius), on=on, line=line)


# ----------------------------------------------------------------------
# What is picked for a pin in a slot, and the slot drawn from it.


SLOT_PICKS = (
    pick("Click the pin that runs in the slot.", "point"),
    end("Click the link with the slot; or drag from the pin along a fixed slot."),
)


def draw_slot(sheet: DrawnSheet, pin: Picked, track: Picked) -> None:
    """Add the slot on a link, or on two new fixed points."""
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
    sheet.finish(name=name, point=point, on=on, line=line)


# ----------------------------------------------------------------------
# What is picked for a spring, and the spring drawn from it.


SPRING_PICKS = (
    end("Drag from one end of the spring to the other."),
    end("Click the other end of the spring."),
)


def draw_spring(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add the spring between two points; a new one is fixed, as springs carry none."""
    sheet.distinct(complex(first.x, first.y), complex(second.x, second.y), "the two ends")
    name = sheet.name("spring")
    ends = (sheet.end(first, GROUND), sheet.end(second, GROUND))
    sheet.finish(name=name, between=ends)


# ----------------------------------------------------------------------
# What is picked for a weld, and the weld drawn from it.


WELD_PICKS = (
    pick("Click the first link; a fixed pin is the ground.", "point", "link"),
    pick("Click the link that is welded to it.", "point", "link"),
)


def draw_weld(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add the weld of two links."""
    sheet.finish(links=(sheet.body(first), sheet.body(second)))


# ----------------------------------------------------------------------
# The index of drawn parts, but for those with other tools.


#: By table of the file: the picks, and the function that draws the part from them.
_TOOLS: Mapping[str, tuple[tuple[Pick, ...], Callable[..., None]]] = {
    "belts": (BELT_PICKS, draw_belt),
    "cams": (CAM_PICKS, draw_cam),
    "curves": (CURVE_PICKS, draw_curve),
    "cylinders": (CYLINDER_PICKS, draw_cylinder),
    "gears": (GEAR_PICKS, draw_gear),
    "loads": (LOAD_PICKS, draw_load),
    "noncircular_gears": (NONCIRCULAR_GEAR_PICKS, draw_noncircular_gear),
    "racks": (RACK_PICKS, draw_rack),
    "rolling": (ROLLING_PICKS, draw_rolling),
    "slots": (SLOT_PICKS, draw_slot),
    "springs": (SPRING_PICKS, draw_spring),
    "welds": (WELD_PICKS, draw_weld),
}


def picks_of(table: str) -> tuple[Pick, ...]:
    """What the tool of a kind of part lets a person pick; nothing if it has another tool."""
    return _TOOLS[table][0] if table in _TOOLS else ()


def edits_of_drawing(drawn: DrawPart, before: Before) -> tuple[Edit, ...]:
    """The points, links and parts that a drawn part adds.

    Raises
    ------
    InputError, UnknownNameError
        If the picks do not make such a part; with the reason.
    """
    needed, count = picks_of(drawn.table), len(drawn.picks)
    if not needed:
        tables = [table for table in PARTS if picks_of(table)]
        raise InputError(f"this part cannot be drawn {choices('parts', tables, drawn.table)}")
    if not (count == len(needed) or (needed[-1].repeated and count > len(needed))):
        raise InputError(f"this part needs {len(needed)} picks, got {count}")
    if not drawn.span > 0:
        raise InputError(f"span: must be positive, got {drawn.span:g}")
    if not isinstance(before.description, Draft):
        raise InputError("the points of this file follow from its equations: edit its text")
    sheet = DrawnSheet(before, drawn)
    _TOOLS[drawn.table][1](sheet, *drawn.picks)
    return tuple(sheet.edits)
