"""Outlines of gears with involute teeth of 20° on their pitch circles."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

import numpy as np

from linkwork.drawing.pose import Pose
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.elementwise import phase as phase_of
from linkwork.mechanism.figures import Disc, Mesh

__all__ = ["ADDENDUM", "DEDENDUM", "mesh_phases", "tooth_outline", "tooth_phases"]

#: Distances of tips and roots from the pitch circle, in modules (ISO 53).
ADDENDUM, DEDENDUM = 1.0, 1.25

_PRESSURE = math.radians(20.0)
_FLANK = 4  # points along a flank


def tooth_outline(disc: Disc) -> ComplexArray:
    """The outline of a gear about its centre, the first tooth on the real axis.

    The outline of a ring is that of the gear that fills it: its first gap is on the real axis.

    Notes
    -----
    The half width of a tooth at radius ρ is π/(2z) + inv 20° - inv α, cos α = r cos 20°/ρ,
    inv α = tan α - α.

    References
    ----------
    R. L. Norton, Design of Machinery, section 9.3 (involute tooth form).
    """
    assert disc.teeth is not None
    module = 2.0 * disc.radius / disc.teeth
    # a ring is the complement of its gear: tips and roots are exchanged
    up, down = (DEDENDUM, ADDENDUM) if disc.ring else (ADDENDUM, DEDENDUM)
    root, tip = disc.radius - down * module, disc.radius + up * module
    base = disc.radius * math.cos(_PRESSURE)
    radii = np.linspace(max(root, base), tip, _FLANK)
    half = math.pi / (2 * disc.teeth) + _involute(np.array(_PRESSURE))
    # flanks of few teeth would cross above the pointed tip
    half = np.maximum(half - _involute(np.arccos(base / radii)), 0.0)
    # Below the base circle there is no involute: the flank is straight towards the centre.
    if root < base:
        radii, half = np.append(root, radii), np.append(half[0], half)
    flank = radii * np.exp(1j * half)
    tooth = np.concatenate((flank.conj(), flank[::-1]))
    steps = np.exp(2j * math.pi * np.arange(disc.teeth) / disc.teeth)
    outline: ComplexArray = (steps[:, None] * tooth).ravel()
    return outline


def _involute(angle: Array) -> Array:
    found: Array = np.tan(angle) - angle
    return found


def tooth_phases(pose: Pose) -> dict[Disc, float]:
    """The direction [rad] of the first tooth (of a ring: gap) of every gear with known teeth."""
    meshes = [m.discs for m in pose.skeleton.of(Mesh) if all(d.teeth for d in m.discs)]
    return mesh_phases(meshes, pose.angle, pose.points)


def mesh_phases(
    meshes: Iterable[tuple[Disc, Disc]],
    angle: Callable[[str], float],
    points: Mapping[str, complex],
) -> dict[Disc, float]:
    """The direction [rad] of the first tooth (of a ring: gap) of gears in mesh.

    The teeth of the first wheel of a train rotate with its link; those of the following wheels are
    placed in mesh. Since the wheels roll on each other, they rotate with their links too.
    """
    phases: dict[Disc, float] = {}
    left = list(meshes)
    while left:
        # Meshes with a wheel of known phase come first.
        one, other = min(left, key=lambda pair: not phases.keys() & set(pair))
        left.remove((one, other))
        if other in phases:
            one, other = other, one
        phases.setdefault(one, angle(one.link))
        line = phase_of(points[other.center] - points[one.center])
        phases.setdefault(other, _meshing(line, one, phases[one], other))
    return phases


def _meshing(line: float, one: Disc, phase: float, other: Disc) -> float:
    """The phase of a wheel in mesh with one of known phase; ``line``: that of the centres [rad]."""
    assert one.teeth is not None
    assert other.teeth is not None
    if one.ring or other.ring:
        # The point of contact lies beyond the smaller wheel; its teeth are in the ring's gaps.
        line = line if one.ring else line + math.pi
        return line - (line - phase) * one.teeth / other.teeth
    passed = (line - phase) * one.teeth / math.tau
    # at the contact, one gear has a tooth and the other a gap
    return line + math.pi - (0.5 - passed) * math.tau / other.teeth
