"""Mechanisms given as a list of joints, each with the links that it connects: PMKS, Pyslvs."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass

from linkwork.exchange.assembly import Assembly
from linkwork.foundation.names import GROUND
from linkwork.mechanism.driven_input import Input

__all__ = ["JointRow", "add_joints", "drive_joint"]


@dataclass(frozen=True, kw_only=True)
class JointRow:
    """A joint: ``kind`` R (pin), P (slider) or RP (pin in slot), where the first link has the line.

    ``angle`` is that of the line [rad]; ``input``: the joint is driven, with ``speed``.
    """

    place: str
    kind: str
    at: complex
    links: tuple[str, ...]
    angle: float = 0.0
    input: bool = False
    name: str = ""
    speed: str | None = None


def add_joints(assembly: Assembly, rows: Sequence[JointRow]) -> None:
    """Add joints in the file's order, and the links that they name."""
    links = {GROUND: GROUND}
    for row in rows:
        for wanted in row.links:
            if wanted not in links:
                links[wanted] = assembly.add_link(wanted)
    driven: list[tuple[JointRow, list[str]]] = []
    # pins first: sliders reuse a pin of their link at the same place
    for row in sorted(rows, key=lambda row: row.kind != "R"):
        own = [links[wanted] for wanted in dict.fromkeys(row.links)]
        if row.kind == "R":
            point = assembly.add_point(row.name, row.at)
            for link in own:
                assembly.put_on(link, point)
            if row.input:
                driven.append((row, own))
        elif len(own) < 2:
            assembly.source.leave_out(row.place, f"joint of type {row.kind} with one link")
        else:
            _add_slide(assembly, row, own)
    # only now do links have all their points
    for row, own in driven:
        drive_joint(assembly, row.place, own, row.speed)


def _add_slide(assembly: Assembly, row: JointRow, own: list[str]) -> None:
    on, *moving = own
    point = _point_at(assembly, row, moving)
    for link in moving:
        assembly.put_on(link, point)
    if point in assembly.carries(on):
        assembly.source.leave_out(row.place, f'slide on "{on}", which carries the point itself')
        return
    line = assembly.guide(on, point, cmath.rect(1.0, row.angle))
    if row.kind == "RP":
        name = assembly.add_slot(f"s_{point}", point, on, line)
    else:
        name = assembly.add_slider(f"s_{point}", moving[0], point, on, line)
    if row.input:
        assembly.source.leave_out(row.place, "range of the driven slide: it is set to ± a quarter")
        size = abs(assembly.points[line[1]] - assembly.points[line[0]]) / 4.0
        assembly.inputs.append(Input(slider=name, start=-size, stop=size, step=size / 50.0))


def _point_at(assembly: Assembly, row: JointRow, moving: list[str]) -> str:
    """A point of a moving link at the place of a slide, or a new one."""
    for link in moving:
        for point in sorted(assembly.carries(link)):
            if assembly.points[point] == row.at:
                return point
    return assembly.add_point(row.name, row.at)


def drive_joint(
    assembly: Assembly, place: str, links: Sequence[str], speed: str | None = None
) -> None:
    """Drive the angle between the two links at a pin; all points must be on their links before."""
    moving = [name for name in links if not assembly.carries(name) <= assembly.fixed]
    # links whose points are all fixed are part of ground
    fixed = len(moving) < len(links)
    if len(moving) + fixed != 2:
        message = f"input at a pin of {len(moving) + fixed} links: name two of them"
        assembly.source.leave_out(place, message)
        return
    against = None if fixed else moving[0]
    assembly.inputs.append(Input(link=moving[-1], relative_to=against, speed=speed))
