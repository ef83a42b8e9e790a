"""Names of links and pins derived from loops: those of the file where they exist."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from linkwork.equations.model import LoopEquations
from linkwork.equations.reading.joints import Joints
from linkwork.equations.reading.poses import Poses
from linkwork.equations.reading.walk import Phase, phase_of
from linkwork.foundation.names import GROUND, canonical, free_name
from linkwork.mechanism.loops import Loops

__all__ = ["PartNames"]

_CANCELLED = 1e-12  # relative to the largest vector: rounding of vectors with sum zero


@dataclass(frozen=True, kw_only=True)
class PartNames:
    """The name of every pin, in order, and of every link, ground first.

    ``begin`` is the point of the file at which the equations begin; ``taken`` are all names.
    """

    pins: tuple[str, ...]
    links: dict[int, str]
    begin: complex
    taken: set[str]

    @classmethod
    def of(cls, loops: Loops, equations: LoopEquations, joints: Joints, poses: Poses) -> PartNames:
        """Pins named by the file's points, links by its links, otherwise by their angles."""
        drawn = [*loops.points, *(name for name in loops.links if name != GROUND)]
        named = [*drawn, *loops.dimensions, *loops.outputs, GROUND]
        named += [variable.name for variable in equations.variables]
        taken = set(map(canonical, named))
        pins: list[str] = []
        begin, points = poses.named(joints)
        for name in points:
            pins.append(free_name("P1", taken) if name is None or name in pins else name)
        links = _drawn_links(loops, equations, joints, pins)
        shown = {variable.symbol: variable.name for variable in equations.variables}
        for link, phase in joints.phases.items():
            if link not in links:
                links[link] = free_name(_called(joints, link, phase, shown), taken)
        return cls(pins=tuple(pins), links=links, begin=begin, taken=taken)


def _drawn_links(
    loops: Loops, equations: LoopEquations, joints: Joints, pins: Sequence[str]
) -> dict[int, str]:
    """Links drawn by the file, in its order; most of their points are pins of the link."""
    found = {joints.ground: GROUND}
    for name, points in loops.links.items():
        if name == GROUND:
            continue
        at_pins = [
            link
            for pin, corner in zip(pins, joints.corners, strict=True)
            for link in corner.places
            if pin in points and link not in found
        ]
        along = [link for link in at_pins if joints.phases[link] == _direction(equations, points)]
        carrying = [link for link in at_pins if at_pins.count(link) > 1] or along
        if carrying:
            found[max(carrying, key=carrying.count)] = name
    return found


def _direction(equations: LoopEquations, points: Sequence[str]) -> Phase | None:
    """The direction from the first to the second point, if it is unique along the path."""
    total: dict[tuple[Phase, str | None], complex] = {}
    for sign, point in zip((-1, 1), points[:2], strict=False):
        for term in equations.points[point].terms:
            key = (phase_of(term), term.length)
            total[key] = total.get(key, 0j) + sign * term.value
    size = max(map(abs, total.values()), default=0.0)
    left = {phase for (phase, _), value in total.items() if abs(value) > _CANCELLED * size}
    return left.pop() if len(left) == 1 and len(points) > 1 else None


def _called(joints: Joints, link: int, phase: Phase, shown: dict[str, str]) -> str:
    """The name of a block from its slide, of another link from the angles of its direction."""
    pins = sum(link in corner.places for corner in joints.corners)
    slides = [s.variable for s in joints.slides if link in (s.before, s.after)]
    if slides and pins < 2:
        alone = len(joints.slides) == 1
        return "block" if alone else f"block_{shown[slides[0]]}"
    return "_".join(["link", *(shown[name] for name, _ in phase)])
