"""The extent of a picture: all drawn parts of a mechanism, now and over a motion."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

import numpy as np

from linkwork.drawing.box import Box
from linkwork.drawing.coupling_symbols import couplings
from linkwork.drawing.follower_stems import stems
from linkwork.drawing.measures import Measures
from linkwork.drawing.part.slot import rounds
from linkwork.drawing.pose import Pose
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.mechanism.figures import Contour, Disc
from linkwork.mechanism.part.slot import GenevaWheel
from linkwork.results.motion import Motion

__all__ = ["drawn_box", "reach_of"]

_OF_OUTLINE = 90  # points of an outline that are tracked over a motion


def drawn_box(pose: Pose, traces: tuple[str, ...], others: Sequence[Pose]) -> Box:
    """The box of all drawn parts: points and round parts in all poses, traces, fixed guides."""
    poses = [pose, *others]
    drawn = [name for name in pose.points if name not in pose.construction]
    places = (one.points[name] for one in poses for name in drawn)
    along = {guide.point for guide in pose.skeleton.guides if pose.on_ground(guide)}
    along |= {point for rail in pose.skeleton.rails for point in rail.points}
    along |= {point for figure in pose.skeleton.figures for point in figure.travelling}
    paths = [pose.paths[name] for name in (*traces, *along) if name in pose.paths]
    travelled = chain.from_iterable(path[np.isfinite(path)] for path in paths)
    rounds = chain.from_iterable(map(_round_parts, poses))
    box = Box.around((float(z.real), float(z.imag)) for z in chain(places, travelled, rounds))
    # Blocks on stems are further out, by some symbol sizes.
    ends = (
        one.points[name] + stem
        for one in poses
        for name, stem in stems(one, Measures.of(box, pose.gaps)).items()
    )
    return Box.around([*box.corners, *((float(z.real), float(z.imag)) for z in ends)])


def _round_parts(pose: Pose) -> Iterator[complex]:
    """Outermost points of wheels, cams and curves, and of rolling lines without a motion."""
    if not pose.paths:
        for figure in pose.skeleton.figures:
            yield from (pose.points[name] for name in figure.extent)
    for center, radius in _discs(pose):
        yield from (pose.points[center] + radius * 1j**k for k in range(4))
    for contour in pose.skeleton.of(Contour):
        yield from map(complex, pose.placed(contour))


def _discs(pose: Pose) -> Iterator[tuple[str, float]]:
    """Centres and radii of wheels, Geneva wheels, locking discs and coupling discs."""
    yield from ((disc.center, disc.radius) for disc in pose.skeleton.of(Disc))
    for wheel in pose.skeleton.of(GenevaWheel):
        yield from rounds(wheel, pose)
    for coupling in couplings(pose.skeleton):
        yield from ((coupling.discs[k][1], coupling.radius(pose, k)) for k in range(2))


def reach_of(motion: Motion) -> Box:
    """The box of every point, wheel and cam of a mechanism over a whole motion.

    Raises
    ------
    InputError
        If the motion has no points, or no position was found.
    """
    rows = motion.found
    if not rows.any() or not motion.points:
        raise InputError(
            f'the motion of "{motion.mechanism}" has nothing to draw: '
            f"{int(rows.sum())} positions, {len(motion.points)} points"
        )
    skeleton = motion.skeleton
    places = [motion.trace(name)[rows] for name in motion.points]
    for name, radius in _discs(Pose.at_row(motion, int(np.flatnonzero(rows)[0]))):
        centre = motion.trace(name)[rows]
        places += [centre + radius * 1j**k for k in range(4)]
    for contour in skeleton.of(Contour):
        points = np.array(contour.points)
        points = points[:: max(1, len(points) // _OF_OUTLINE)]
        turned: ComplexArray = np.ones(int(rows.sum()), dtype=complex)
        if contour.link != GROUND:
            degrees = motion.links[contour.link].value[rows]
            turned = np.exp(1j * degrees * motion.units.angle.radians)
        centre = motion.trace(contour.center)[rows]
        places.append((centre[:, None] + turned[:, None] * points).ravel())
    everything = np.concatenate(places)
    x, y = everything.real, everything.imag
    return Box(float(x.min()), float(y.min()), float(x.max()), float(y.max()))
