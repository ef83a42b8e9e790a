"""Inversions of a mechanism, and other inputs."""

from __future__ import annotations

from dataclasses import replace

from linkwork.circuits.chain import Chain, orbits
from linkwork.circuits.classification import NotSeen, as_linkage, classify
from linkwork.circuits.inverted_linkage import inverted, settled
from linkwork.circuits.reading_loops import Seen
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND, as_name
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.mechanism.skeleton import directed
from linkwork.core.motion.model import Model, model_of
from linkwork.core.motion.solving import solve
from linkwork.core.results.check import Inversion


def inversion(model: Model, link: str, which: Input | None = None) -> Linkage:
    """The mechanism with another link as ground, from the position at its guess.

    Raises
    ------
    InputError
        If equations cannot be read as links, or the mechanism cannot be written with this ground.
    UnknownNameError
        If there is no such link.
    """
    seen = _seen(model)
    if seen.loose:
        raise InputError(
            f"the loops of {model.description.name} do not determine where on "
            f"{' and '.join(seen.loose)} they are joined: write it as points and links to invert it"
        )
    linkage = seen.linkage
    if as_name(link) != GROUND:
        linkage = directed(linkage, _sketched_angles(seen.model))
    return inverted(linkage, link, _places(seen.model, linkage), which)


def _seen(model: Model) -> Seen:
    """The mechanism as points and links."""
    seen = as_linkage(model)
    if isinstance(seen, NotSeen):
        raise InputError(
            f"{model.description.name} is given by equations, and cannot be inverted without links "
            f"and joints: {seen.why}"
        )
    return seen


def _sketched_angles(model: Model) -> dict[str, float]:
    """The angles of all links in the sketch [rad]."""
    equations = model.equations
    start = {v.name: float(x) for v, x in zip(equations.variables, equations.start, strict=True)}
    return {
        link: angle.constant + (0.0 if angle.variable is None else start[angle.variable])
        for link, angle in equations.links.items()
    }


def _places(model: Model, linkage: Linkage) -> dict[str, complex]:
    """All points of the linkage, which may have more of them than the model, at the guess.

    Where nothing can be assembled they are those of the sketch.
    """
    same = model if linkage is model.description else model_of(linkage)
    position = solve(same, certify=False)
    if not position.status.ok:
        return {point: linkage.sketched(point) for point in linkage.points}
    return {name: complex(x, y) for name, (x, y) in position.points.items()}


def inversions(model: Model) -> tuple[Inversion, ...]:
    """Every link as ground, the present one first, with the type of the inversion."""
    seen = _seen(model)
    model = seen.model
    linkage = directed(seen.linkage, _sketched_angles(model))
    chain = Chain.of(linkage)
    alike = {link: group[0] for group in orbits(chain.with_blocks()) for link in group}
    places = _places(model, linkage)
    found = []
    for link in sorted(chain.links, key=lambda name: name != GROUND):
        kind, problem = "", ""
        try:
            if link not in linkage.links:
                raise InputError(
                    f"{link} is part of a cylinder: write it as two links with a slider"
                )
            other = as_linkage(model_of(inverted(linkage, link, places)))
            kind = classify(other).type if isinstance(other, Seen) else ""
        except InputError as error:
            problem = str(error)
        found.append(Inversion(ground=link, type=kind, like=alike[link], problem=problem))
    return tuple(found)


def driven_otherwise(model: Model, which: Input) -> Description:
    """The description with another input.

    A description that starts from a named configuration, whose name belongs to the old input,
    starts from the position itself instead.
    """
    description = model.description
    if not description.configuration:
        return replace(description, inputs=(which,))
    if isinstance(description, Linkage):
        description = settled(description, _places(model, description))
    elif isinstance(description, Loops | PlainEquations):
        position = solve(model, certify=False)
        guess = {**description.guess, **position.unknowns, **position.input}
        description = replace(description, guess=guess, configuration="")
    return replace(description, inputs=(which,))
