"""A draft to which picks in the drawing add points, links and parts."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from linkwork.app.live.moving_points import Before
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
