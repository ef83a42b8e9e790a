"""What can be wrong with welds, gears, belts, racks, rolling wheels, cams and curves."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from linkwork.foundation.errors import choices
from linkwork.foundation.lanes import largest, vector
from linkwork.mechanism.contacts import Belt, Cam, Curve, Gear, Rack, Rolling, Weld
from linkwork.mechanism.motion_laws import LAWS
from linkwork.mechanism.parts import Number, Slider, Slot

if TYPE_CHECKING:
    from linkwork.mechanism.description import Problems
    from linkwork.mechanism.linkage import Linkage
    from linkwork.mechanism.shape import Shapes

__all__ = ["check_contacts", "check_distances", "guide_named"]

Key = tuple[str | int, ...]
_AGREE = 1e-9  # relative: radii and the distance of centres must agree to this
_SHORTEST = 1e-6  # of a turn: parts of a cam's motion are longer
_MOST_TEETH = 1_000_000


def check_contacts(linkage: Linkage, problems: Problems) -> None:
    """Add every problem of these parts that shows without the links' shapes."""
    checker = _Checker(linkage, problems)
    for k, weld in enumerate(linkage.welds):
        checker.weld(weld, ("welds", k))
    for k, gear in enumerate(linkage.gears):
        checker.wheels(gear, ("gears", k))
    for k, belt in enumerate(linkage.belts):
        checker.wheels(belt, ("belts", k))
    for k, rack in enumerate(linkage.racks):
        checker.rack(rack, ("racks", k))
    for k, rolling in enumerate(linkage.rolling):
        checker.rolling(rolling, ("rolling", k))
    for k, cam in enumerate(linkage.cams):
        checker.cam(cam, ("cams", k))
    for k, curve in enumerate(linkage.curves):
        checker.curve(curve, ("curves", k))


def check_distances(linkage: Linkage, shapes: Shapes, problems: Problems) -> None:
    """Whether wheels fit between their centres."""
    numbers = linkage.numbers
    pairs: list[tuple[Gear | Belt, Key]] = [
        *((gear, ("gears", k)) for k, gear in enumerate(linkage.gears)),
        *((belt, ("belts", k)) for k, belt in enumerate(linkage.belts)),
    ]
    for pair, key in pairs:
        a, b = (shapes.local[pair.arm][center] for center in pair.centers)
        distance = abs(b - a)
        if pair.radii is None:
            continue
        first, second = map(numbers, pair.radii)
        if isinstance(pair, Belt):
            least = first + second if pair.crossed else abs(first - second)
            if distance <= least:
                what = "crossed " if pair.crossed else ""
                problems.add(
                    (*key, "radii"),
                    f"do not fit: a {what}belt needs centres more than {least:g} apart, "
                    f"those of {_pair(pair.centers)} are {distance:g}",
                )
            continue
        wanted = abs(first - second) if pair.internal else first + second
        if abs(distance - wanted) > _AGREE * largest((distance, wanted)):
            how = "differ by" if pair.internal else "add up to"
            problems.add(
                (*key, "radii"),
                f"{how} {wanted:.10g}, but the centres {_pair(pair.centers)} are "
                f"{distance:.10g} apart",
            )


def guide_named(linkage: Linkage, name: str | None) -> Slider | Slot | None:
    """The slider or slot of that name."""
    guides: Sequence[Slider | Slot] = (*linkage.sliders, *linkage.slots)
    return next((guide for guide in guides if guide.name == name), None)


def _pair(names: Iterable[str]) -> str:
    return " and ".join(names)


class _Checker:
    """Checks of one linkage, adding to its problems."""

    def __init__(self, linkage: Linkage, problems: Problems) -> None:
        self.linkage, self.problems = linkage, problems

    def weld(self, weld: Weld, key: Key) -> None:
        """Two different links with a common point."""
        if not self._two(weld.links, (*key, "links"), "link"):
            return
        there = [self._link(name, (*key, "links")) for name in weld.links]
        if not all(there):
            return
        first, second = (self.linkage.links[name] for name in weld.links)
        if not set(first) & set(second):
            self.problems.add(
                (*key, "links"),
                f"{_pair(weld.links)} share no point: let both carry the point at which they "
                "are welded",
            )
        for name, points in zip(weld.links, (first, second), strict=True):
            known = name == "ground" or name in self.linkage.turning_on_one_point
            if len(points) < 2 and not known:
                self.problems.add(
                    (*key, "links"),
                    f'"{name}" has only the point {points[0]}, so its direction is not known: '
                    "make one link of both",
                )
        if weld.angle is not None:
            self.linkage.numbers.check_number(self.problems.add, (*key, "angle"), weld.angle)

    def wheels(self, pair: Gear | Belt, key: Key) -> None:
        """Gears and belts: two wheels on a common arm, with their sizes."""
        links = (*pair.wheels, pair.arm)
        if not self._two(pair.wheels, (*key, "wheels"), "link"):
            return
        if not self._two(pair.centers, (*key, "centers"), "point"):
            return
        fields = ("wheels", "wheels", "arm")
        known = [self._link(n, (*key, f)) for n, f in zip(links, fields, strict=True)]
        if not all(known):
            return
        if pair.arm in pair.wheels:
            self.problems.add((*key, "arm"), f'"{pair.arm}" cannot be a wheel and the arm as well')
        for wheel, center in zip(pair.wheels, pair.centers, strict=True):
            self._on(center, wheel, (*key, "centers"))
            if self._defined(center) and center not in self.linkage.links[pair.arm]:
                self.problems.add(
                    (*key, "arm"),
                    f'"{pair.arm}" does not carry the centre {center}: name the link that '
                    f"carries both centres {_pair(pair.centers)}",
                )
        self._sizes(pair, key)
        if pair.phase is not None:
            self.linkage.numbers.check_number(self.problems.add, (*key, "phase"), pair.phase)

    def _sizes(self, pair: Gear | Belt, key: Key) -> None:
        if (pair.radii is None) == (pair.teeth is None):
            what = "both" if pair.radii is not None else "neither"
            self.problems.add(key, f"needs either radii or teeth, it has {what}")
            return
        field = "radii" if pair.radii is not None else "teeth"
        given: Sequence[Number] = pair.radii or pair.teeth or ()
        if len(given) != 2:
            self.problems.add((*key, field), f"needs two numbers, got {len(given)}")
            return
        sizes = [self._positive(number, (*key, field), field) for number in given]
        if field == "teeth" and any(size != round(size) for size in sizes if size > 0):
            self.problems.add((*key, "teeth"), "must be whole numbers")
        elif field == "teeth" and largest(sizes) > _MOST_TEETH:
            self.problems.add((*key, "teeth"), f"are too many: at most {_MOST_TEETH}")
        ring = isinstance(pair, Gear) and pair.internal
        if ring and sizes[0] == sizes[1] and sizes[0] > 0:
            message = "are equal: a wheel inside a ring is smaller than the ring"
            self.problems.add((*key, field), message)

    def rack(self, rack: Rack, key: Key) -> None:
        """A pinion on the link along which the rack slides."""
        known = self._link(rack.pinion, (*key, "pinion"))
        slider = next((s for s in self.linkage.sliders if s.name == rack.slider), None)
        if slider is None:
            names = [s.name for s in self.linkage.sliders]
            message = f'slider "{rack.slider}" is not defined {choices("sliders", names)}'
            self.problems.add((*key, "slider"), message)
        self._positive(rack.radius, (*key, "radius"), "radius")
        if not known or slider is None:
            return
        self._on(rack.center, rack.pinion, (*key, "center"))
        if rack.pinion in (slider.on, slider.link):
            self.problems.add(
                (*key, "pinion"), f'"{rack.pinion}" cannot be a part of the rack itself'
            )
        elif self._defined(rack.center) and rack.center not in self.linkage.links.get(
            slider.on, ()
        ):
            self.problems.add(
                (*key, "center"),
                f'"{slider.on}", along which the rack slides, does not carry {rack.center}: a '
                "pinion that moves against the rack's guide rolls ([[rolling]])",
            )

    def rolling(self, part: Rolling, key: Key) -> None:
        """A wheel on a line or a circle of another link."""
        known = [self._link(part.wheel, (*key, "wheel")), self._link(part.on, (*key, "on"))]
        radius = self._positive(part.radius, (*key, "radius"), "radius")
        if (part.line is None) == (part.circle is None):
            what = "both" if part.line is not None else "neither"
            self.problems.add(key, f"needs either a line or a circle to roll on, it has {what}")
            return
        if not all(known):
            return
        if part.wheel == part.on:
            self.problems.add((*key, "on"), f'"{part.on}" cannot roll on itself')
            return
        self._on(part.center, part.wheel, (*key, "center"))
        if part.center in self.linkage.links[part.on]:
            self.problems.add(
                (*key, "center"),
                f'{part.center} is fixed on "{part.on}", so the wheel cannot roll along it',
            )
        if part.line is not None:
            if self._two(part.line, (*key, "line"), "point"):
                for point in part.line:
                    self._on(point, part.on, (*key, "line"))
            if part.inside or part.circle_radius is not None:
                field = "inside" if part.inside else "circle_radius"
                self.problems.add((*key, field), "goes with circle only")
            return
        assert part.circle is not None
        self._on(part.circle, part.on, (*key, "circle"))
        if part.circle_radius is None:
            self.problems.add((*key, "circle_radius"), "is missing: the size of the circle")
            return
        both = {part.center, part.circle}
        arm = next((name for name, own in self.linkage.links.items() if both <= set(own)), None)
        if arm is not None:
            self.problems.add(
                (*key, "circle"),
                f'"{arm}" carries both centres {part.circle} and {part.center} already: two wheels '
                "on an arm are [[gears]]",
            )
        size = self._positive(part.circle_radius, (*key, "circle_radius"), "radius")
        if part.inside and radius == size:
            self.problems.add(
                (*key, "radius"), "equals circle_radius: a wheel inside a circle is smaller"
            )

    def cam(self, cam: Cam, key: Key) -> None:
        """A cam with one follower and one shape."""
        if not self._link(cam.cam, (*key, "cam")):
            return
        self._on(cam.center, cam.cam, (*key, "center"))
        self._follower(cam, key)
        words = ("knife", "roller", "flat")
        if cam.contact not in words:
            self.problems.add(
                (*key, "contact"), f"must be knife, roller or flat, got {cam.contact}"
            )
        elif cam.contact == "roller":
            self._positive(cam.radius, (*key, "radius"), "radius")
        elif cam.radius != 0:
            self.problems.add((*key, "radius"), f"goes with a roller, this is a {cam.contact}")
        if bool(cam.segments) == bool(cam.profile):
            what = "both" if cam.segments else "neither"
            message = f"needs either segments or a profile, it has {what}"
            self.problems.add(key, message)
        elif cam.segments:
            self._segments(cam, key)
        else:
            if cam.base is not None:
                self.problems.add((*key, "base"), "goes with segments: a profile has its own size")
            self._outline(cam.profile, (*key, "profile"), closed=True)

    def _follower(self, cam: Cam, key: Key) -> None:
        if (cam.slider is None) == (cam.link is None):
            what = "both" if cam.slider is not None else "neither"
            self.problems.add(
                key, f"needs a follower, either a slider or a link that swings; it has {what}"
            )
            return
        if cam.slider is not None:
            guide = guide_named(self.linkage, cam.slider)
            if guide is None:
                names = [s.name for s in self.linkage.sliders]
                names += [s.name for s in self.linkage.slots]
                message = f'slider "{cam.slider}" is not defined {choices("sliders", names)}'
                self.problems.add((*key, "slider"), message)
            elif cam.center not in self.linkage.links.get(guide.on, ()):
                self.problems.add(
                    (*key, "center"),
                    f'"{guide.on}", along which the follower slides, does not carry {cam.center}',
                )
            elif cam.contact == "flat" and isinstance(guide, Slot):
                self.problems.add(
                    (*key, "contact"),
                    f'"{guide.name}" is a slot, whose pin has no face: a flat follower needs a '
                    "slider",
                )
            for field in ("pivot", "point"):
                if getattr(cam, field) is not None:
                    self.problems.add((*key, field), "goes with link, not with slider")
            return
        assert cam.link is not None
        if not self._link(cam.link, (*key, "link")):
            return
        for field in ("pivot", "point"):
            name = getattr(cam, field)
            if name is None:
                self.problems.add((*key, field), "is missing: a follower that swings needs it")
            else:
                self._on(name, cam.link, (*key, field))
        if cam.pivot is not None and cam.pivot == cam.point:
            self.problems.add((*key, "point"), "must be another point than the pivot")
        frames = [
            name
            for name, points in self.linkage.links.items()
            if name not in (cam.cam, cam.link) and {cam.center, cam.pivot} <= set(points)
        ]
        if cam.pivot is not None and not frames:
            self.problems.add(
                (*key, "pivot"),
                f"no link carries both {cam.center} and {cam.pivot}: cam and follower turn on "
                "one frame",
            )

    def _segments(self, cam: Cam, key: Key) -> None:
        from_law = [segment.law for segment in cam.segments]
        unit = self.linkage.angle
        check = self.linkage.numbers.check_number
        if cam.base is None:
            self.problems.add((*key, "base"), "is missing: the radius of the base circle")
        else:
            self._positive(cam.base, (*key, "base"), "radius")
        check(self.problems.add, (*key, "start"), cam.start)
        overs, lifts = [], []
        for k, segment in enumerate(cam.segments):
            here = (*key, "segments", k)
            over = check(self.problems.add, (*here, "over"), segment.over)
            lift = check(self.problems.add, (*here, "lift"), segment.lift)
            if segment.law not in LAWS:
                message = f"must be one of {', '.join(LAWS)}, got {segment.law}"
                self.problems.add((*here, "law"), message)
            if over <= 0:
                message = f"must be a positive angle, got {over:g}"
                self.problems.add((*here, "over"), message)
            elif over < _SHORTEST * unit.turn:
                message = f"{over:g} is too small: at least {_SHORTEST * unit.turn:g}"
                self.problems.add((*here, "over"), message)
            if from_law[k] == "dwell" and lift:
                self.problems.add((*here, "lift"), "must be 0: a dwell moves nothing")
            overs.append(over)
            lifts.append(lift)
        total = sum(overs)
        if not math.isnan(total) and abs(total - unit.turn) > _AGREE * unit.turn:
            self.problems.add(
                (*key, "segments"),
                f"turn the cam by {total:.10g} altogether: a closed cam needs {unit.turn:.10g}",
            )
        height = sum(lifts)
        if not math.isnan(height) and abs(height) > _AGREE * max(map(abs, lifts), default=0.0):
            self.problems.add(
                (*key, "segments"),
                f"end {height:+.10g} away from where they began: a closed cam brings its "
                "follower back",
            )

    def curve(self, curve: Curve, key: Key) -> None:
        """A curve of one link and a point of another."""
        if not self._link(curve.on, (*key, "on")):
            return
        self._on(curve.origin, curve.on, (*key, "origin"))
        if not self._defined(curve.point):
            self._undefined_point(curve.point, (*key, "point"))
        elif curve.point in self.linkage.links[curve.on]:
            self.problems.add(
                (*key, "point"),
                f'{curve.point} is fixed on "{curve.on}" and cannot run along its curve',
            )
        self._outline(curve.through, (*key, "through"), closed=curve.closed)

    def _outline(self, points: Sequence[tuple[Number, Number]], key: Key, *, closed: bool) -> None:
        """Enough different points in a row."""
        least = 4 if closed else 3
        if len(points) < least:
            self.problems.add(key, f"needs at least {least} points, got {len(points)}")
            return
        places = []
        pairs: Sequence[Sequence[Number]] = points
        for k, pair in enumerate(pairs):
            if len(pair) != 2:
                self.problems.add((*key, k), f"needs two coordinates, got {len(pair)}")
                return
            x, y = (
                self.linkage.numbers.check_number(self.problems.add, (*key, k), n) for n in pair
            )
            places.append(vector(x, y))
        if closed and places[0] == places[-1]:
            self.problems.add(key, "closes by itself: leave out the last point, it is the first")
        for k in range(1, len(places)):
            if places[k] == places[k - 1]:
                self.problems.add((*key, k), "is the same point as the one before")

    # What all of them ask

    def _defined(self, point: str) -> bool:
        return point in self.linkage.points

    def _undefined_point(self, point: str, key: Key) -> None:
        known = choices("points", self.linkage.points, point)
        self.problems.add(key, f'point "{point}" is not defined {known}')

    def _link(self, link: str, key: Key) -> bool:
        if link in self.linkage.links:
            return True
        known = choices("links", self.linkage.links, link)
        self.problems.add(key, f'link "{link}" is not defined {known}')
        return False

    def _on(self, point: str, link: str, key: Key) -> None:
        """The point has to be one of the link's."""
        if not self._defined(point):
            self._undefined_point(point, key)
        elif point not in self.linkage.links[link]:
            known = choices("points", self.linkage.links[link])
            self.problems.add(key, f'point "{point}" is not on link "{link}" {known}')

    def _two(self, names: Sequence[str], key: Key, noun: str) -> bool:
        if len(names) != 2:
            self.problems.add(key, f"needs two {noun}s, got {len(names)}")
            return False
        if names[0] == names[1]:
            self.problems.add(key, f"needs two different {noun}s, got {names[0]} twice")
            return False
        return True

    def _positive(self, number: Number, key: Key, noun: str) -> float:
        amount = self.linkage.numbers.check_number(self.problems.add, key, number)
        if amount <= 0:
            what = "positive" if noun == "radii" else f"a positive {noun}"
            what = "positive whole numbers" if noun == "teeth" else what
            self.problems.add(key, f"must be {what}, got {amount:g}")
        return amount
