"""Random descriptions of all three forms, right by construction."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.mechanism.description import HIDDEN, Question
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.mechanism.part.guides import Cylinder, Slider, Slot
from linkwork.core.mechanism.part.springs import Spring

__all__ = ["descriptions", "linkages", "loop_systems", "plain_systems"]

SPELLINGS = ["θ", "theta", "a", "B", "crank", "x_", "μ", "s", "ground_", "Ω", "é", "名"]
any_text = st.text(st.characters(codec="utf-8"), max_size=12)
coordinates = st.floats(-1e6, 1e6) | st.integers(-(10**6), 10**6)
plain_numbers = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(10**30), 10**30)
units = st.sampled_from(AngleUnit)
steps = st.floats(1e-3, 1e3) | st.integers(1, 1000)


def distinct_names(least: int, most: int) -> st.SearchStrategy[list[str]]:
    """Names that stay different when Greek letters are spelled out."""
    one = st.builds("{}{}{}".format, st.sampled_from(SPELLINGS), st.integers(1, 99), primes)
    return st.lists(one, min_size=least, max_size=most, unique_by=canonical)


primes = st.sampled_from(["", "'", "''"])


questions = st.builds(
    Question,
    text=any_text.filter(str.strip),
    answer=plain_numbers | st.sampled_from(["dead points", "change points"]),
    tolerance=st.floats(1e-9, 1e9),
    hide=st.lists(st.sampled_from(HIDDEN), max_size=2).map(tuple),
)


@st.composite
def heads(draw: st.DrawFn, dimension_names: list[str]) -> dict[str, Any]:
    """What every form has; the first dimension is a number, others may be formulas of it."""
    dimensions: dict[str, float | str] = {}
    for name in dimension_names:
        formula = st.sampled_from([f"2*{first} + 1" for first in list(dimensions)[:1]] or ["1/3"])
        dimensions[name] = draw(st.floats(-1e6, 1e6) | st.integers(-999, 999) | formula)
    return {
        "name": draw(any_text),
        "length": draw(any_text),
        "source": draw(any_text),
        "family": draw(any_text),
        "configuration": draw(any_text),
        "angle": draw(units),
        "dimensions": dimensions,
        "questions": draw(st.lists(questions, max_size=2)),
    }


@st.composite
def ranges(draw: st.DrawFn) -> dict[str, Any]:
    """A range of twelve rows, in one of its spellings."""
    start = draw(st.integers(-500, 500))
    step = draw(st.sampled_from([1, 2, 0.5, -3]))
    shown = draw(st.sampled_from([start, float(start), f"{start} + 0"]))
    speed = draw(st.none() | st.floats(-1e9, 1e9) | st.just("2*3"))
    return {"from_": shown, "to": start + 11 * step, "step": step, "speed": speed}


@st.composite
def linkages(draw: st.DrawFn) -> Linkage:
    """A chain of links from ground, with parts and inputs hung on it."""
    names = draw(distinct_names(16, 24))
    dimension_names, output_names = names[11:13], names[13:14]
    p = names[:6]
    points: dict[str, tuple[float | str, float]] = {}
    for k, point in enumerate(p):
        x = k * 50.0 + draw(st.floats(0, 9))
        shown: float | str = repr(x) if draw(st.booleans()) else x
        points[point] = (shown, draw(coordinates))
    links = {
        "ground": (p[0], p[3]),
        names[6]: (p[0], p[1]),
        names[7]: (p[1], p[2], p[4]),
        names[8]: (p[5],),
    }
    inputs = [Input(link=names[6], **draw(ranges())), Input(slider=names[9], **draw(ranges()))]
    slot = Slot(name=names[14], point=p[1], on="ground", line=(p[0], p[3]))
    fields = draw(heads(dimension_names))
    return Linkage(
        **fields,
        points=points,
        links=links,
        lengths=draw(st.sampled_from([{}, {f"{p[0]} {p[1]}": draw(st.floats(0.1, 1e6))}])),
        angles=draw(st.sampled_from([{}, {f"{p[1]} {p[2]} {p[4]}": 0.5}])),
        slots=draw(st.sampled_from([(), (slot,)])),
        sliders=(
            Slider(
                name=names[9],
                link=names[8],
                points=(p[5],),
                on="ground",
                line=(p[0], p[3]),
                offset=draw(coordinates),
                angle=draw(st.none() | coordinates),
            ),
        ),
        cylinders=draw(st.sampled_from([(), (Cylinder(name=names[10], between=(p[5], p[3])),)])),
        springs=draw(st.sampled_from([(), (Spring(name=names[15], between=(p[2], p[5])),)])),
        inputs=tuple(draw(st.sampled_from([inputs[:0], inputs[:1], inputs]))),
        trace=tuple(draw(st.lists(st.sampled_from(p), max_size=3))),
        outputs={name: draw(any_text) for name in output_names},
        sketch=False,
    )


@st.composite
def guesses(draw: st.DrawFn, names: list[str]) -> dict[str, Any]:
    return {name: draw(plain_numbers) for name in names}


@st.composite
def loop_systems(draw: st.DrawFn) -> Loops:
    """Any text passes for an equation here: what it means is checked later."""
    names = draw(distinct_names(8, 12))
    points = {name: draw(any_text) for name in names[4:6]}
    return Loops(
        **draw(heads(names[2:4])),
        loops=draw(st.dictionaries(any_text, any_text, min_size=1, max_size=3)),
        guess=draw(guesses(names[:2])),
        inputs=(Input(variable=names[0], **draw(ranges())),),
        points=points,
        links=draw(st.sampled_from([{}, {names[6]: tuple(names[4:6])}])),
        trace=tuple(draw(st.lists(st.sampled_from(names[4:6]), max_size=2))),
        outputs=draw(st.sampled_from([{}, {names[7]: "1 + 1"}])),
    )


@st.composite
def plain_systems(draw: st.DrawFn) -> PlainEquations:
    names = draw(distinct_names(4, 6))
    which = Input(variable=names[0], **draw(ranges()))
    return PlainEquations(
        **draw(heads(names[2:4])),
        equations=draw(st.dictionaries(any_text, any_text, min_size=1, max_size=3)),
        guess=draw(guesses(names[:2])),
        inputs=draw(st.sampled_from([(), (which,)])),
    )


descriptions = linkages() | loop_systems() | plain_systems()
