"""The reaction of a linear coupling: one unknown on both of its lengths and angles."""

from __future__ import annotations

import numpy as np

from linkwork.core.results.quantity import Kind
from linkwork.couplings.coupling import LinearCoupling
from linkwork.forces.reactions.free_bodies import Act, FreeBodies
from linkwork.forces.reactions.parts import acts_along, join_part, part_named, read_along


@join_part.register
def join_coupling(coupling: LinearCoupling, bodies: FreeBodies) -> None:
    """The force or moment on the second, per factor of the coupling on the others."""
    turns, slides = coupling.weights(bodies.linkage)
    acts: list[Act] = []
    nowhere = np.zeros(1, dtype=complex)
    # virtual work: a coupling of factor w exerts w times its multiplier
    for link, factor in turns:
        acts.append(Act(bodies.link(link), nowhere, nowhere, factor))
    for name, factor in slides:
        acts += [act.times(factor) for act in acts_along(part_named(bodies, name), bodies)]
    multiplier = bodies.unknown(*acts)
    for name, factor in slides:
        read_along(part_named(bodies, name), bodies, ((multiplier, factor),))
    moved = (coupling.links or coupling.lengths or ("", coupling.length))[1]
    kind = Kind.FORCE if slides else Kind.MOMENT
    about = f"{'force' if slides else 'moment'} of the coupling along {moved}"
    bodies.read(f"{coupling.name}.{'force' if slides else 'moment'}", kind, about, multiplier)
