"""Every mechanism as points and links, for its classification."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from linkwork.equations.reading.joints import NotRead
from linkwork.equations.reading.linkage_of_loops import read_linkage
from linkwork.foundation.errors import MechanismError
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.loops import Loops
from linkwork.motion.model import Model, model_of

__all__ = ["NotSeen", "Seen", "as_linkage"]


@dataclass(frozen=True, kw_only=True)
class Seen:
    """The points and links of a mechanism.

    Parameters
    ----------
    model : Model
        Of the linkage: the mechanism's own, unless it is given by loops.
    turning : Mapping[str, tuple of str]
        The variables of the mechanism's own equations that give the direction of every link.
    loose : tuple of str
        Links some of whose lengths the loops do not determine; the chain does not depend on them.
    """

    model: Model
    linkage: Linkage
    turning: Mapping[str, tuple[str, ...]]
    loose: tuple[str, ...] = ()


@dataclass(frozen=True)
class NotSeen:
    """Why a mechanism has no points and links."""

    why: str


def as_linkage(model: Model) -> Seen | NotSeen:
    """The points and links of a mechanism; those of loops are read off its equations.

    Notes
    -----
    They are sketched at the guess, from Newton-Raphson's position there if it finds one.
    """
    description, equations = model.description, model.equations
    if isinstance(description, Linkage):
        turning = {
            link: () if angle.variable is None else (angle.variable,)
            for link, angle in equations.links.items()
        }
        for cylinder in description.cylinders:
            turning |= dict.fromkeys(cylinder.ends, (cylinder.angle_name,))
        return Seen(model=model, linkage=description, turning=turning)
    if not isinstance(description, Loops):
        return NotSeen("plain equations do not determine links and joints")
    done = model.compiled.solver.solve(equations.start[None, :])
    v = equations.start if done.failed_block[0] >= 0 else done.v[0]
    try:
        read = read_linkage(description, equations, v)
        seen = model_of(read.linkage)
    except NotRead as error:
        return NotSeen(str(error))
    except MechanismError as error:
        return NotSeen(error.problems[0].message)
    return Seen(model=seen, linkage=read.linkage, turning=read.turning, loose=read.loose)
