"""The loops of a linkage as a person would write them: vector by vector, along each loop."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import Any

import linkwork as lw
from linkwork.core.equations.frames import Frames
from linkwork.core.equations.model import LoopEquations, Term
from linkwork.core.equations.writing import rows_of_parts
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.description import Problems
from linkwork.core.mechanism.linkage import Linkage

__all__ = ["as_loops"]


def as_loops(
    mechanism: lw.Mechanism, *, seed: int | None = None, drawn: bool = False
) -> lw.Mechanism:
    """The mechanism given by its loop equations.

    Every loop begins at ground, where it touches it. With a ``seed``, some of it is written on the
    other side, loops run either way round and come in any order. ``drawn``: with the points and
    links of the linkage.
    """
    linkage, equations = mechanism.description, mechanism.loop_equations
    assert isinstance(linkage, Linkage)
    assert not equations.linear
    rng = random.Random(seed)
    loops = {}
    for loop in equations.loops:
        terms = list(_along(linkage, loop.label.split()))
        cut = len(terms)
        if seed is not None:
            if rng.random() < 0.5:
                terms = [term.negated() for term in reversed(terms)]
            cut = rng.randint(1, len(terms))
        left = " + ".join(map(_text, terms[:cut]))
        right = " + ".join(_text(term.negated()) for term in reversed(terms[cut:])) or "0"
        loops[loop.label.replace(" ", "_")] = f"{left} = {right}"
    if seed is not None:
        loops = dict(rng.sample(list(loops.items()), len(loops)))
    scales = {"angle": linkage.angle.from_radians(1.0), "length": 1.0}
    guess = {
        variable.name: float(start) * scales[variable.kind]
        for variable, start in zip(equations.variables, equations.start, strict=True)
    }
    inputs = [
        replace(
            which,
            link=None,
            slider=None,
            cylinder=None,
            variable=which.drives[1],
            step=which.step if which.from_ != which.to else 1,
        )
        for which in linkage.inputs
    ]
    drawing: dict[str, Any] = {}
    if drawn:
        points = dict(_points(equations))
        drawing = {"points": points, "links": {f"{n}_": p for n, p in linkage.links.items()}}
        drawing["links"][GROUND] = drawing["links"].pop(f"{GROUND}_")
    return lw.loops(
        name=linkage.name, length=linkage.length, angle=linkage.angle,
        dimensions=linkage.dimensions, loops=loops, guess=guess,
        inputs=inputs, **drawing,
    )  # fmt: skip


def _along(linkage: Linkage, around: list[str]) -> Iterator[Term]:
    """The vectors of a loop from point to point, beginning behind ground if it touches it."""
    frames = Frames.of(linkage, Problems())
    rows_of_parts(frames, Problems())  # places what slides
    bodies: list[str] = []
    steps = list(pairwise([*around, around[0]]))
    for one, other in steps:
        carrying = [b for b in frames.bodies if {one, other} <= frames.places[b].keys()]
        carrying = [b for b in carrying if b not in bodies]
        bodies.append(carrying[-1] if len(around) == 2 and len(bodies) else carrying[0])
    first = bodies.index(GROUND) if GROUND in bodies else 0
    order = [(first + k) % len(steps) for k in range(len(steps))]
    if GROUND in bodies:
        order = order[1:]
        yield from frames.places[GROUND][steps[first][1]].sliding
    for k in order:
        start, end = (frames.places[bodies[k]][point] for point in steps[k])
        yield from (term.negated() for term in reversed(start.sliding))
        if end.fixed != start.fixed:
            yield frames.vector_term(end.fixed - start.fixed, None, bodies[k])
        yield from end.sliding
    if GROUND in bodies:
        start, end = (frames.places[GROUND][point] for point in steps[first])
        yield from (term.negated() for term in reversed(start.sliding))
        if end.fixed != start.fixed:
            yield Term.vector(end.fixed - start.fixed, None)


def _text(term: Term) -> str:
    factors = [f"({term.value.real!r} + i*({term.value.imag!r}))"]
    factors += [] if term.length is None else [term.length]
    angle = " + ".join(f"({weight!r})*{name}" for name, weight in term.phase)
    return "*".join([*factors, *([f"e^(i*({angle}))"] if angle else [])])


def _points(equations: LoopEquations) -> Iterator[tuple[str, str]]:
    for name, path in equations.points.items():
        parent = [] if path.parent is None else [path.parent]
        yield name, " + ".join([*parent, *map(_text, path.terms)])
