"""A design of an atlas, moved, turned, enlarged and if need be mirrored onto a curve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwork.design.atlas.path_atlas import Nearest
from linkwork.design.atlas.path_shape import (
    HARMONICS,
    WAYS,
    coefficients,
    distances,
    in_ways,
)
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.errors import InputError
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.slider import Slider
from linkwork.mechanism.varied_number import number_named, with_numbers
from linkwork.motion.model import model_of
from linkwork.motion.sweeping import sweep
from linkwork.textfile.reader import read_text

__all__ = ["placed_on_curve"]


def placed_on_curve(near: Nearest, curve: ComplexArray, name: str) -> tuple[Linkage, float]:
    """The mechanism whose path lies on a closed curve (N,) as well as possible, and the root of the
    mean square of the gaps [length].

    Raises
    ------
    InputError
        If its file has other things than points, links, lengths, angles, sliders and one crank.
    """
    described = read_text(near.family.mechanism, name).description
    if not isinstance(described, Linkage) or len(described.inputs) != 1:
        raise InputError("an atlas can place mechanisms of points and links with one input only")
    others = sorted({type(part).title for part in described.parts if not isinstance(part, Slider)})
    if others:
        told = "an atlas can place mechanisms of links and sliders only, not with parts of the kind"
        raise InputError(f"{told} {', '.join(others)}")
    numbers = {number_named(described, key): value for key, value in near.numbers.items()}
    design = with_numbers(described, numbers)
    assert isinstance(design, Linkage)
    motion = sweep(model_of(design), certify=False)
    mirrored = near.is_mirrored
    path = motion.trace(near.family.point)[:-1]
    shape, centre, size = coefficients((path.conj() if mirrored else path)[None])
    wanted, goal, extent = coefficients(curve[None])
    back = WAYS[near.way][0]
    travelled = in_ways(wanted[0])[1 if back else 0]
    _, shift_along, turn = distances(shape, travelled)
    # a distance from the agreement of shapes would be exact to the root of rounding only
    fitted = shape[0] * np.exp(1j * (HARMONICS * shift_along[0] + turn[0]))
    gap = float(np.linalg.norm(fitted - travelled) * extent[0])
    factor = complex(extent[0] / size[0] * np.exp(1j * turn[0]))
    shift = complex(goal[0] - factor * centre[0])
    places = {point: motion.trace(point)[0] for point in design.points}
    if mirrored:
        places = {point: z.conjugate() for point, z in places.items()}
    moved = {point: shift + factor * z for point, z in places.items()}
    value, sense = design.numbers, -1.0 if mirrored else 1.0
    (drive,) = design.inputs
    begin = design.angle.from_radians(float(np.angle(factor)))
    start, stop, step = (float(value(x or 0.0)) for x in (drive.start, drive.stop, drive.step))
    crank = replace(
        drive, start=begin + sense * start, stop=begin + sense * stop, step=sense * step
    )
    placed = replace(
        design,
        name=name,
        points={point: (z.real, z.imag) for point, z in moved.items()},
        lengths={key: float(value(x)) * abs(factor) for key, x in design.lengths.items()},
        angles={key: sense * float(value(x)) for key, x in design.angles.items()},
        sliders=tuple(
            replace(
                slider,
                offset=sense * float(value(slider.offset)) * abs(factor),
                angle=None if slider.angle is None else sense * float(value(slider.angle)),
            )
            for slider in design.sliders
        ),
        inputs=(crank,),
    )
    return placed, gap
