"""The mechanisms of a snapshot by name: the library, and random ones of every kind of joint.

A name is a kind and a number, as in ``contact rack 17``, or ``library four-bar``: the same name is
the same mechanism in every run. A variant of the library is its file with other numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import tomlkit

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage
from tests.campaigns.motion import FAMILIES, random_case
from tests.core.equations.linkages import LINKAGES
from tests.core.laws.contacts import KINDS as CONTACTS, contact
from tests.core.laws.mechanisms import mechanism_of as law_mechanism
from tests.core.motion.dyad_linkages import dyad_linkage
from tests.core.motion.written_loops import as_loops
from tests.described import described_as
from tests.oracles.cranked import cranked_truss
from tests.oracles.trusses import FIVE_LINKS, NINE_LINKS, SEVEN_LINKS, truss

__all__ = ["FAMILY_DESIGNS", "KINDS", "designs_of", "mechanism_of", "names_of", "wants_circuits"]

Rng = np.random.Generator

#: How many designs the family of a kind's first and second mechanism has, and the library's own.
FAMILY_DESIGNS = {0: 5, 1: 20}

_STEPS = (5, 30, 5, 1, 5, 30, 5, 5)  # degrees between rows of random loops, in turn
_ROWS = (5, 12, 30, 5, 1)  # of how many rows of a library file's table a variant keeps one


@dataclass(frozen=True)
class Kind:
    """How one kind is made by number, its share of all, and of which ones circuits are listed:
    every first of so many; 0 for none.
    """

    make: Callable[[int], lw.Mechanism]
    share: float
    circuits: int


def names_of(count: int) -> tuple[str, ...]:
    """The library, then so many random mechanisms; a smaller count has the first of each kind."""
    whole = sum(kind.share for kind in KINDS.values())
    names, done, passed = [f"library {name}" for name in lw.examples()], 0, 0.0
    for name, kind in KINDS.items():
        passed += kind.share
        here = round(count * passed / whole)
        names += [f"{name} {number}" for number in range(here - done)]
        done = here
    return tuple(names)


def mechanism_of(name: str) -> lw.Mechanism:
    """The mechanism of this name."""
    kind, number = _parted(name)
    return lw.example(number) if kind == "library" else KINDS[kind].make(int(number))


def wants_circuits(name: str) -> bool:
    """Whether its circuits are listed: they take seconds for some kinds."""
    kind, number = _parted(name)
    if kind == "library":
        return True
    every = KINDS[kind].circuits
    return every > 0 and int(number) % every == 0


def designs_of(name: str, mechanism: lw.Mechanism) -> dict[str, np.ndarray]:
    """What varies in its family, up to three numbers by 3 %; nothing if it has no family here.

    The first design is the mechanism itself.
    """
    kind, number = _parted(name)
    count = FAMILY_DESIGNS[0] if kind == "library" else FAMILY_DESIGNS.get(int(number), 0)
    numbers = _numbers(mechanism.description) if count else {}
    rng = _rng(32, name)
    chosen = rng.permutation(sorted(numbers))[:3].tolist()
    factors = 1.0 + rng.uniform(-0.03, 0.03, (len(chosen), count))
    factors[:, :1] = 1.0
    return {which: numbers[which] * factors[k] for k, which in enumerate(chosen)}


def _parted(name: str) -> tuple[str, str]:
    kind, _, number = name.rpartition(" ")
    return kind, number


def _rng(seed: int, name: str, number: int = 0) -> Rng:
    return np.random.default_rng([seed, number, *name.encode()])


def _numbers(description: Any) -> dict[str, float]:
    """Plain numbers that can vary: dimensions and lengths, or coordinates if there are none."""
    found: dict[str, float] = {}
    for table in ("dimensions", "lengths"):
        found |= _plain(getattr(description, table, {}))
    if not found and not hasattr(description, "guess"):
        for point, place in description.points.items():
            found |= _plain({f"{point}.{axis}": x for axis, x in zip("xy", place, strict=True)})
    return found


def _plain(table: Mapping[str, Any]) -> dict[str, float]:
    return {name: float(x) for name, x in table.items() if isinstance(x, int | float) and x}


# ------------------------------------------------------------------ kinds made elsewhere


def _loops(family: str, number: int) -> lw.Mechanism:
    """One of the six families with a closed form; one in eight is close to a change point."""
    rng = _rng(30, family, number)
    near = 10 ** rng.uniform(-9, -3) if rng.random() < 0.12 and family != "triad" else None
    return random_case(rng, family, near, _STEPS[number % len(_STEPS)]).mechanism


def _guided(name: str, number: int) -> lw.Mechanism:
    """A small linkage of the tests, every length and coordinate up to a tenth larger or smaller."""
    mechanism, rng = LINKAGES[name](), _rng(33, name, number)
    description = described_as(Linkage, mechanism)
    return mechanism.changed(
        lengths={key: float(x) * rng.uniform(0.9, 1.1) for key, x in description.lengths.items()},
        points={
            key: tuple(float(x) * rng.uniform(0.9, 1.1) for x in place)
            for key, place in description.points.items()
        },
    )


def _written_dyads(number: int) -> lw.Mechanism:
    return as_loops(dyad_linkage(number), seed=number, drawn=number % 2 == 0)


def _cranked(graph: str, number: int) -> lw.Mechanism:
    return cranked_truss(graph, _rng(34, graph, number))


def _truss(graph: str, number: int) -> lw.Mechanism:
    rng = _rng(35, graph, number)
    return truss(graph, rng, size=10.0 ** rng.uniform(-2, 3))


def _pinned(name: str, number: int) -> lw.Mechanism:
    return law_mechanism(f"{name} {number}")


# ------------------------------------------------------------------ variants of library files

#: Where numbers stand that are lengths, by table; ``segments`` hold lifts.
_LENGTHS = {
    "points": None,
    "lengths": None,
    "sliders": ("offset",),
    "gears": ("radii",),
    "belts": ("radii",),
    "racks": ("radius",),
    "rolling": ("radius", "circle_radius"),
    "cams": ("radius", "base", "profile", "lift", "segments"),
    "curves": ("through",),
}


#: Files that fit together in their proportions only: wheels that mesh, redundant links.
_PROPORTIONED = (
    "cardan-circles", "dixon-one", "dixon-two", "four-bar", "four-bar-crossed", "geared-five-bar",
    "inverted-slider-crank", "parallel-cranks", "scissor-three-bars", "sun-and-planet",
)  # fmt: skip


def variant(example: str, number: int) -> lw.Mechanism:
    """A library file with other numbers, fewer rows, the same in every run.

    In turn: every dimension with a factor of its own (one factor for all lengths if the file has
    no dimensions), so that special proportions stay; every number within a tenth; every number
    within a hundredth. Where proportions are conditions, the last is refused for most files, and
    one factor for all lengths, up to a hundred, takes the place of the second.
    """
    rng = _rng(31, example, number)
    text = tomlkit.parse(lw.example_text(example)).unwrap()
    mode, strict = number % 3, example in _PROPORTIONED
    if "equations" in text:
        text["guess"] = _each(text["guess"], rng, 0.1)
    elif mode == 1 and strict:
        _enlarge(text, float(10.0 ** rng.uniform(-2.0, 2.0)))
    elif mode:
        _vary(text, rng, (0.1, 0.01)[mode - 1])
    elif "dimensions" in text and not strict:
        text["dimensions"] = _each(text["dimensions"], rng, 0.1)
    else:
        _enlarge(text, float(rng.uniform(0.9, 1.1)))
    _thin(text, _ROWS[number // 3 % len(_ROWS)])
    return lw.loads(tomlkit.dumps(text), f"variant of {example} {number}")


def _vary(text: dict[str, Any], rng: Rng, spread: float) -> None:
    """Every number of points, lengths, angles and dimensions by itself, wheels and cams as one."""
    for table in ("dimensions", "points", "lengths", "angles"):
        if table in text:
            text[table] = _each(text[table], rng, spread)
    for table, keys in _LENGTHS.items():
        for part in text.get(table, []) if keys else []:
            assert keys is not None
            factor = 1.0 + rng.uniform(-spread, spread)
            part |= {key: _times(part[key], factor) for key in keys if key in part}


def _each(value: Any, rng: Rng, spread: float) -> Any:
    if isinstance(value, dict):
        return {key: _each(x, rng, spread) for key, x in value.items()}
    if isinstance(value, list):
        return [_each(x, rng, spread) for x in value]
    return value if isinstance(value, str) else value * (1.0 + rng.uniform(-spread, spread))


def _enlarge(text: dict[str, Any], factor: float) -> None:
    """All lengths by the same factor."""
    for table, keys in _LENGTHS.items():
        if keys is None and table in text:
            text[table] = _times(text[table], factor)
        for part in text.get(table, []) if keys else []:
            assert keys is not None
            part |= {key: _times(part[key], factor) for key in keys if key in part}
    for driven in _inputs(text):
        if "slider" in driven or "cylinder" in driven:
            given = [key for key in ("from", "to", "step") if key in driven]
            driven |= {key: _times(driven[key], factor) for key in given}


def _times(value: Any, factor: float) -> Any:
    """All lengths of a value times a factor, formulas too; of a segment of a cam its lift."""
    if isinstance(value, dict):
        every = "law" not in value
        return {k: _times(x, factor) if every or k == "lift" else x for k, x in value.items()}
    if isinstance(value, list):
        return [_times(x, factor) for x in value]
    return f"{factor!r}*({value})" if isinstance(value, str) else value * factor


def _inputs(text: dict[str, Any]) -> list[dict[str, Any]]:
    given = text.get("input", [])
    return given if isinstance(given, list) else [given]


def _thin(text: dict[str, Any], every: int) -> None:
    """Keep one of so many rows, or of the largest divisor that all tables share with it."""
    tables = []
    for driven in _inputs(text):
        low, high, step = (driven.get(k, x) for k, x in (("from", 0), ("to", 360), ("step", 1)))
        if any(isinstance(x, str) for x in (low, high, step)):
            return
        if low != high:
            tables.append((driven, step, round((high - low) / step)))
    common = math.gcd(every, *(rows for _, _, rows in tables))
    for driven, step, _ in tables:
        driven["step"] = step * common


# ------------------------------------------------------------------ all kinds

#: Files whose circuits take seconds each: few variants of them are followed around; those of
#: Dixon's mechanisms take a minute and are listed for the file itself only.
_SLOW = (
    "beam-engine", "crank-shaper", "double-butterfly", "drag-link", "excavator", "galloway",
    "hart-inversor", "jansen-leg", "kempe-translator", "landing-gear", "pantograph",
    "parallel-cranks", "peaucellier", "scissor-lift", "scissor-three-bars",
    "stephenson-valve-gear", "three-rpr", "toggle-press", "trotbot-leg",
)  # fmt: skip
_SLOWEST = ("dixon-one", "dixon-two")


def _circuits_of_variants(example: str) -> int:
    return 0 if example in _SLOWEST else 27 if example in _SLOW else 6


def _all_kinds() -> Iterator[tuple[str, Kind]]:
    """Every kind with its share in percent, roughly."""
    for family in FAMILIES:
        yield f"loop {family}", Kind(partial(_loops, family), 6.0, 3)
    for name in CONTACTS:
        rolls = name.startswith("rolling") and "circle" in name
        slow = name == "cam by its outline, sliding roller"
        every = 30 if rolls else 12 if slow else 4
        yield f"contact {name}", Kind(partial(contact, name), 1.0, every)
    for example in lw.examples():
        every = _circuits_of_variants(example)
        yield f"variant of {example}", Kind(partial(variant, example), 0.27, every)
    yield "dyads", Kind(dyad_linkage, 5.0, 3)
    yield "dyads as loops", Kind(_written_dyads, 2.0, 6)
    for name in LINKAGES:
        yield f"linkage {name}", Kind(partial(_guided, name), 0.3, 4)
    for name in ("four-bar", "slider-crank"):
        yield f"pinned {name}", Kind(partial(_pinned, name), 2.0, 4)
    for graph in (*FIVE_LINKS, *SEVEN_LINKS):
        yield f"crank and {graph}", Kind(partial(_cranked, graph), 0.4, 10)
    for graph in (*FIVE_LINKS, *SEVEN_LINKS, *tuple(NINE_LINKS)[::10]):
        yield f"truss {graph}", Kind(partial(_truss, graph), 0.35, 0)


KINDS = dict(_all_kinds())
