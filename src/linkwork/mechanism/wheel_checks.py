"""What can be wrong with gears, belts, racks and rolling wheels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from linkwork.foundation.errors import choices
from linkwork.foundation.lanes import largest
from linkwork.mechanism.contacts import Belt, Gear, Rack, Rolling
from linkwork.mechanism.part_checks import AGREE, Key, PartChecks
from linkwork.mechanism.parts import Number

if TYPE_CHECKING:
    from linkwork.mechanism.description import Problems
    from linkwork.mechanism.linkage import Linkage
    from linkwork.mechanism.shape import Shapes

__all__ = ["WheelChecks", "check_distances"]

_MOST_TEETH = 1_000_000


class WheelChecks(PartChecks):
    """Checks of wheels, adding to a linkage's problems."""

    def wheels(self, pair: Gear | Belt, key: Key) -> None:
        """Gears and belts: two wheels on a common arm, with their sizes."""
        links = (*pair.wheels, pair.arm)
        if not self.two(pair.wheels, (*key, "wheels"), "link"):
            return
        if not self.two(pair.centers, (*key, "centers"), "point"):
            return
        fields = ("wheels", "wheels", "arm")
        known = [self.link(n, (*key, f)) for n, f in zip(links, fields, strict=True)]
        if not all(known):
            return
        if pair.arm in pair.wheels:
            self.problems.add((*key, "arm"), f'"{pair.arm}" cannot be a wheel and the arm as well')
        for wheel, center in zip(pair.wheels, pair.centers, strict=True):
            self.on(center, wheel, (*key, "centers"))
            if self.defined(center) and center not in self.linkage.links[pair.arm]:
                self.problems.add(
                    (*key, "arm"),
                    f'"{pair.arm}" does not carry the centre {center}: name the link that '
                    f"carries both centres {' and '.join(pair.centers)}",
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
        sizes = [self.positive(number, (*key, field), field) for number in given]
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
        known = self.link(rack.pinion, (*key, "pinion"))
        slider = next((s for s in self.linkage.sliders if s.name == rack.slider), None)
        if slider is None:
            names = [s.name for s in self.linkage.sliders]
            message = f'slider "{rack.slider}" is not defined {choices("sliders", names)}'
            self.problems.add((*key, "slider"), message)
        self.positive(rack.radius, (*key, "radius"), "radius")
        if not known or slider is None:
            return
        self.on(rack.center, rack.pinion, (*key, "center"))
        if rack.pinion in (slider.on, slider.link):
            self.problems.add(
                (*key, "pinion"), f'"{rack.pinion}" cannot be a part of the rack itself'
            )
        elif self.defined(rack.center) and rack.center not in self.linkage.links.get(slider.on, ()):
            self.problems.add(
                (*key, "center"),
                f'"{slider.on}", along which the rack slides, does not carry {rack.center}: a '
                "pinion that moves against the rack's guide rolls ([[rolling]])",
            )

    def rolling(self, part: Rolling, key: Key) -> None:
        """A wheel on a line or a circle of another link."""
        known = [self.link(part.wheel, (*key, "wheel")), self.link(part.on, (*key, "on"))]
        radius = self.positive(part.radius, (*key, "radius"), "radius")
        if (part.line is None) == (part.circle is None):
            what = "both" if part.line is not None else "neither"
            self.problems.add(key, f"needs either a line or a circle to roll on, it has {what}")
            return
        if not all(known):
            return
        if part.wheel == part.on:
            self.problems.add((*key, "on"), f'"{part.on}" cannot roll on itself')
            return
        self.on(part.center, part.wheel, (*key, "center"))
        if part.center in self.linkage.links[part.on]:
            self.problems.add(
                (*key, "center"),
                f'{part.center} is fixed on "{part.on}", so the wheel cannot roll along it',
            )
        if part.line is not None:
            if self.two(part.line, (*key, "line"), "point"):
                for point in part.line:
                    self.on(point, part.on, (*key, "line"))
            if part.inside or part.circle_radius is not None:
                field = "inside" if part.inside else "circle_radius"
                self.problems.add((*key, field), "is used with circle only")
            return
        assert part.circle is not None
        self.on(part.circle, part.on, (*key, "circle"))
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
        size = self.positive(part.circle_radius, (*key, "circle_radius"), "radius")
        if part.inside and radius == size:
            self.problems.add(
                (*key, "radius"), "equals circle_radius: a wheel inside a circle must be smaller"
            )


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
                    f"those of {' and '.join(pair.centers)} are {distance:g}",
                )
            continue
        wanted = abs(first - second) if pair.internal else first + second
        if abs(distance - wanted) > AGREE * largest((distance, wanted)):
            how = "differ by" if pair.internal else "add up to"
            problems.add(
                (*key, "radii"),
                f"{how} {wanted:.10g}, but the centres {' and '.join(pair.centers)} are "
                f"{distance:.10g} apart",
            )
