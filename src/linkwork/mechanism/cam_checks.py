"""What can be wrong with cams, their followers, and curves."""

from __future__ import annotations

import math
from collections.abc import Sequence

from linkwork.foundation.errors import choices
from linkwork.foundation.lanes import vector
from linkwork.mechanism.contacts import Cam, Curve
from linkwork.mechanism.followers import guide_named, swinging_frames
from linkwork.mechanism.motion_laws import LAWS
from linkwork.mechanism.part_checks import AGREE, Key, PartChecks
from linkwork.mechanism.parts import Number, Slot

__all__ = ["CamChecks"]

_SHORTEST = 1e-6  # of a turn: parts of a cam's motion are longer


class CamChecks(PartChecks):
    """Checks of cams and curves, adding to a linkage's problems."""

    def cam(self, cam: Cam, key: Key) -> None:
        """A cam with one follower and one shape."""
        if not self.link(cam.cam, (*key, "cam")):
            return
        self.on(cam.center, cam.cam, (*key, "center"))
        self._follower(cam, key)
        words = ("knife", "roller", "flat")
        if cam.contact not in words:
            self.problems.add(
                (*key, "contact"), f"must be knife, roller or flat, got {cam.contact}"
            )
        elif cam.contact == "roller":
            self.positive(cam.radius, (*key, "radius"), "radius")
        elif cam.radius != 0:
            self.problems.add(
                (*key, "radius"), f"is used with a roller only, the contact is {cam.contact}"
            )
        if bool(cam.segments) == bool(cam.profile):
            what = "both" if cam.segments else "neither"
            message = f"needs either segments or a profile, it has {what}"
            self.problems.add(key, message)
        elif cam.segments:
            self._segments(cam, key)
        else:
            if cam.base is not None:
                self.problems.add(
                    (*key, "base"), "is used with segments only: a profile contains its own size"
                )
            self._outline(cam.profile, (*key, "profile"), closed=True)

    def _follower(self, cam: Cam, key: Key) -> None:
        if (cam.slider is None) == (cam.link is None):
            what = "both" if cam.slider is not None else "neither"
            self.problems.add(
                key, f"needs a follower, either a slider or an oscillating link; it has {what}"
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
                    self.problems.add((*key, field), "is used with link, not with slider")
            return
        assert cam.link is not None
        if not self.link(cam.link, (*key, "link")):
            return
        for field in ("pivot", "point"):
            name = getattr(cam, field)
            if name is None:
                self.problems.add((*key, field), "is missing: an oscillating follower needs it")
            else:
                self.on(name, cam.link, (*key, field))
        if cam.pivot is not None and cam.pivot == cam.point:
            self.problems.add((*key, "point"), "must be another point than the pivot")
        if cam.pivot is not None and not any(swinging_frames(self.linkage, cam)):
            self.problems.add(
                (*key, "pivot"),
                f"no link carries both {cam.center} and {cam.pivot}: cam and follower need "
                "one frame",
            )

    def _segments(self, cam: Cam, key: Key) -> None:
        from_law = [segment.law for segment in cam.segments]
        unit = self.linkage.angle
        check = self.linkage.numbers.check_number
        if cam.base is None:
            self.problems.add((*key, "base"), "is missing: the radius of the base circle")
        else:
            self.positive(cam.base, (*key, "base"), "radius")
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
                self.problems.add((*here, "lift"), "must be 0: a dwell has no rise")
            overs.append(over)
            lifts.append(lift)
        total = sum(overs)
        if not math.isnan(total) and abs(total - unit.turn) > AGREE * unit.turn:
            self.problems.add(
                (*key, "segments"),
                f"turn the cam by {total:.10g} altogether: a closed cam needs {unit.turn:.10g}",
            )
        height = sum(lifts)
        if not math.isnan(height) and abs(height) > AGREE * max(map(abs, lifts), default=0.0):
            self.problems.add(
                (*key, "segments"),
                f"end {height:+.10g} away from their start: on a closed cam the "
                "follower returns to its start",
            )

    def curve(self, curve: Curve, key: Key) -> None:
        """A curve of one link and a point of another."""
        if not self.link(curve.on, (*key, "on")):
            return
        self.on(curve.origin, curve.on, (*key, "origin"))
        if not self.defined(curve.point):
            self.undefined_point(curve.point, (*key, "point"))
        elif curve.point in self.linkage.links[curve.on]:
            self.problems.add(
                (*key, "point"),
                f'{curve.point} is fixed on "{curve.on}" and cannot move along its curve',
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
            self.problems.add(key, "is closed automatically: leave out the repeated last point")
        for k in range(1, len(places)):
            if places[k] == places[k - 1]:
                self.problems.add((*key, k), "is the same point as the one before")
