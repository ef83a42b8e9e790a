"""A mechanism as a stack of plates: constructed, layered, and proved to be free of collisions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from linkwork.export.plates.body_poses import BodyPoses, variables_of_all
from linkwork.export.plates.bridge import bridged, columns_around
from linkwork.export.plates.collisions import Collisions, Proved, prove_clear
from linkwork.export.plates.construction import Construction, check_webs
from linkwork.export.plates.layer_order import Conflict, LayerOrder, find_layers, obstacles
from linkwork.export.plates.options import PlateOptions
from linkwork.export.plates.plate import PlateStack
from linkwork.foundation.arrays import BoolArray
from linkwork.foundation.errors import InputError
from linkwork.foundation.units import LENGTHS
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.pairs import KinematicPairs
from linkwork.motion.model import Model
from linkwork.motion.motion_boxes import Boxes, boxes_of
from linkwork.motion.own_motion import check_own_motion
from linkwork.results.motion import Motion

__all__ = ["stack_of"]

_SAMPLED = 0.3  # finished fraction once the rows are compared
_MOST_WITH_BRIDGES = 500_000  # assignments of layers tried, with all choices of pins together
_OUTWARDS = 1.25  # of their distance from the middle: columns hit between the rows, once more


def stack_of(
    model: Model,
    motion: Motion,
    options: PlateOptions,
    progress: Callable[[float], None] | None = None,
) -> PlateStack:
    """Plates of a mechanism in layers in which nothing collides during a motion.

    Parameters
    ----------
    model : Model
    motion : Motion
        The positions that must be free of collisions.
    options : PlateOptions
    progress : callable, optional
        Called with the finished fraction.

    Raises
    ------
    InputError
        If the mechanism cannot be made of plates, or there is no order of layers.
    """
    check_own_motion(model, motion)
    linkage = _checked(model, motion)
    millimetres = 1000.0 * float(LENGTHS[linkage.length])
    made = Construction.of(model, motion, options, millimetres)
    notes = _notes(linkage, motion, made, millimetres * model.equations.length_scale)
    tell = progress or (lambda fraction: None)
    bodies = [plate.body for plate in made.plates]
    poses = BodyPoses(model, list(dict.fromkeys(bodies)), millimetres)
    boxes = boxes_of(model, motion, variables_of_all(model, motion))
    placed = poses.of(boxes.v)
    collisions = Collisions(made.plates, made.pins, made.meshes, made.sizes.spacer / 2.0)
    conflicts = collisions.conflicts(placed, made.sizes.gap, lambda x: tell(_SAMPLED * x))
    corners = columns_around(made, placed)
    while True:
        layered, layers = _layers(collisions, conflicts, made, corners)
        proof = prove_clear(
            model, poses, layered, layers, boxes, _in_slots(model, made, millimetres),
            lambda x: tell(_SAMPLED + (1.0 - _SAMPLED) * x),
        )  # fmt: skip
        if not proof.hit:
            break
        of_columns = {pair for pair in proof.hit if -1 - min(pair) >= len(made.pins)}
        if of_columns:
            middle = sum(corners) / len(corners)
            corners = tuple(middle + _OUTWARDS * (z - middle) for z in corners)
        conflicts |= proof.hit - of_columns
    return PlateStack(
        mechanism=linkage.name,
        plates=tuple(layered.plates),
        pins=tuple(layered.pins),
        layer={plate.name: layers[k] for k, plate in enumerate(layered.plates)},
        sizes=made.sizes,
        poses={name: (complex(z[0]), complex(turn[0])) for name, (z, turn) in placed.items()},
        checked=len(boxes.v),
        proved=not proof.open,
        contacts=tuple(made.contacts),
        open=_intervals(model, boxes.lead, proof),
        notes=tuple(notes),
    )


def _checked(model: Model, motion: Motion) -> Linkage:
    """The linkage; refuse what plates are not known for."""
    linkage = model.description
    if not isinstance(linkage, Linkage):
        raise InputError(
            f'mechanism "{linkage.name}" is given by equations: plates need points and links'
        )
    if linkage.length not in LENGTHS:
        known = ", ".join(LENGTHS)
        raise InputError(
            f'"{linkage.length}" cannot be converted to millimetres: write length = one of {known}'
        )
    if not motion.found.any():
        raise InputError(f"there is no position to make plates for: {motion.message}")
    return linkage


def _notes(linkage: Linkage, motion: Motion, made: Construction, longest: float) -> list[str]:
    """What the plates lack; refuse redundant links that are too far from fitting."""
    notes = list(made.notes)
    lost = int(np.count_nonzero(~motion.found))
    if lost:
        notes.append(f"{lost} of {len(motion)} rows of the table have no position: left out")
    nothing = KinematicPairs()
    left = [part.label for part in linkage.parts if part.pairs(linkage) == nothing]
    if left:
        notes.append(f"not made: {', '.join(left)}")
    for link, error in motion.redundant.items():
        missing = error * longest
        if missing > made.sizes.clearance / 2.0:
            raise InputError(
                f'the redundant link "{link}" misses its length by {missing:.3g} mm, more than '
                f"half the clearance of the pins, {made.sizes.clearance / 2.0:.3g} mm"
            )
        notes.append(f"{link} is redundant: it jams unless it is made to the clearance of the pins")
    return notes


def _layers(
    collisions: Collisions,
    conflicts: frozenset[Conflict],
    made: Construction,
    corners: tuple[complex, ...],
) -> tuple[Collisions, tuple[int, ...]]:
    """The parts, with a bridge only if they need one, and the layer of every plate."""
    found, ordered = _order(collisions, conflicts), sorted(conflicts)
    if found.layers is not None:
        return collisions, found.layers
    complete, left = found.complete, _MOST_WITH_BRIDGES
    for plates, pins in bridged(made, corners):
        if left <= 0:
            complete = False
            break
        with_bridge = Collisions(plates, pins, made.meshes, collisions.spacer)
        found = _order(with_bridge, conflicts, top=len(plates) - 1)
        if found.layers is not None:
            for plate in (plates[0], plates[-1]):
                check_webs(plate, made.sizes)
            return with_bridge, found.layers
        complete, left = complete and found.complete, left - found.tried
    if not complete:
        raise InputError(
            f"no order of layers was found for {len(made.plates)} plates: the search was given "
            "up; narrower bars collide less, see --width"
        )
    pairs = (
        f"{collisions.name(a)} and {collisions.name(b)}"
        for a, b in obstacles(len(made.plates), collisions.joined, ordered, collisions.together)
    )
    raise InputError(
        "no order of layers lets this mechanism move, nor with a bridge over it: these meet and "
        f"cannot all be in different layers: {'; '.join(pairs)}. Narrower bars, see --width, or a "
        "part of the table, see --from, collide less"
    )


def _order(
    collisions: Collisions, conflicts: frozenset[Conflict], top: int | None = None
) -> LayerOrder:
    count = len(collisions.plates)
    return find_layers(count, collisions.joined, sorted(conflicts), collisions.together, top=top)


def _in_slots(model: Model, made: Construction, millimetres: float) -> Callable[[Boxes], BoolArray]:
    """Whether all displacements of guides stay within their slots in boxes."""
    names = [variable.name for variable in (model.untimed or model).equations.variables]
    columns = [(names.index(way.name), *made.travel[way.name]) for way in made.ways]

    def inside(boxes: Boxes) -> BoolArray:
        held = np.ones(len(boxes.v), dtype=bool)
        for k, low, high in columns:
            value, bound = millimetres * boxes.v[:, k], millimetres * boxes.bound[:, k]
            held &= value - bound >= low - made.sizes.play
            held &= value + bound <= high + made.sizes.play
        return held

    return inside


def _intervals(model: Model, lead: int, proof: Proved) -> tuple[str, ...]:
    """Intervals of the leading input without a proof, joined, in file units."""
    variable = (model.untimed or model).equations.inputs[lead]
    scale = float((model.untimed or model).input_scale[lead])
    unit = (model.untimed or model).input_units[variable.name]
    joined: list[list[float]] = []
    for low, high in sorted(proof.open):
        if not np.isfinite([low, high]).all():
            return ()
        if joined and low <= joined[-1][1] + 1e-9 * max(1.0, abs(low)):
            joined[-1][1] = max(joined[-1][1], high)
        else:
            joined.append([low, high])
    ends = ((f"{a / scale:.6g}", f"{b / scale:.6g}") for a, b in joined)
    return tuple(f"{a} {unit}" if a == b else f"{a} to {b} {unit}" for a, b in ends)
