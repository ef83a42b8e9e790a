"""Calls of the public functions with arguments of every type."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

import linkwork as lw
from linkwork import families as batch
from tests.campaigns.fuzzing.loads import LOADED
from tests.campaigns.fuzzing.odd import OBJECTS, pick
from tests.campaigns.fuzzing.witness import Witness

__all__ = ["python_call"]

_BAR: Mapping[str, Any] = MappingProxyType({
    "points": {"O2": (0, 0), "A": (35, 20), "B": (146, 66), "O4": (100, 0)},
    "links": {
        "ground": ["O2", "O4"], "crank": ["O2", "A"], "coupler": ["A", "B"], "rocker": ["O4", "B"],
    },
    "lengths": {"O2 A": 40, "A B": 120, "O4 B": 80},
    "inputs": lw.Input(link="crank", from_=0, to=90, step=30),
})  # fmt: skip
_LOOPS: Mapping[str, Any] = MappingProxyType({
    "loops": {"four-bar": "a*cis(θ2) + b*cis(θ3) = d + c*cis(θ4)"},
    "dimensions": {"a": 40, "b": 120, "c": 80, "d": 100},
    "inputs": lw.Input(variable="θ2", from_=0, to=90, step=30),
    "guess": {"θ2": 60, "θ3": 20, "θ4": 65},
})  # fmt: skip
_PLAIN: Mapping[str, Any] = MappingProxyType({
    "equations": {"circle": "x^2 + y^2 = 25", "line": "y = x + 1"}, "guess": {"x": 2, "y": 3}
})  # fmt: skip
_FIELDS = (
    "name", "length", "angle", "source", "family", "configuration", "dimensions", "outputs",
    "inputs",
    "trace", "points", "links", "lengths", "angles", "sketch", "sliders", "slots", "cylinders",
    "gears",
    "belts", "racks", "rolling", "cams", "curves", "springs", "welds", "noncircular_gears",
    "loops", "guess",
    "equations", "ground", "masses", "loads", "gravity", "mass", "force", "questions",
)  # fmt: skip
_PARTS = (
    lw.Belt, lw.Cam, lw.Curve, lw.Cylinder, lw.forces.Force, lw.Gear, lw.Input, lw.NewtonOptions,
    lw.Gravity, lw.Load, lw.Mass, lw.NoncircularGear, lw.Question, lw.Rack, lw.Rolling, lw.Segment,
    lw.Slider, lw.Slot, lw.Spring, lw.Weld,
)  # fmt: skip
_FUNCTIONS: tuple[Callable[..., Any], ...] = (
    lw.load, lw.loads, lw.example, lw.example_text, batch.from_table, batch.grid,
    batch.latin_hypercube,
    batch.random, batch.read_plan, batch.summary_of, batch.verify_store, batch.designs_of,
)  # fmt: skip
_METHODS = (
    "solve", "sweep", "configurations", "circuits", "family", "with_dimensions", "changed",
    "inversion",
    "driven_by", "iterates", "nearest_assembly", "pulled_guess",
    "moving_loops", "scene", "forces", "link",
)  # fmt: skip
_MOTION = ("__getitem__", "trace", "value", "series", "place", "quantity", "table")


@cache
def _mechanism() -> lw.Mechanism:
    return lw.linkage(**_BAR)


@cache
def _loaded() -> lw.Mechanism:
    return lw.loads(LOADED)


@cache
def _motion() -> lw.Motion:
    return _mechanism().sweep()


@cache
def _family() -> batch.FamilyMotion:
    return _mechanism().family({"O2 A": [38.0, 40.0]}).sweep(certify=False)


def python_call(rng: np.random.Generator, witness: Witness) -> None:
    """A call with odd arguments, and what follows if it is accepted."""
    match int(rng.integers(6)):
        case 0:
            _made(rng, witness)
        case 1:
            part = pick(rng, _PARTS)
            made = _odd(rng, witness, part, part.__name__)
            field = pick(rng, _FIELDS) if rng.random() < 0.2 else _field_of(part)
            if made is not None and field:
                entry = (
                    made
                    if field in ("inputs", "gravity")
                    else {"crank": made}
                    if field == "masses"
                    else [made]
                )
                witness.call(
                    f"linkage {field}={made!r}"[:300], lambda: lw.linkage(**{**_BAR, field: entry})
                )
        case 2:
            function = pick(rng, _FUNCTIONS)
            _odd(rng, witness, function, function.__name__)
        case 3 | 4:
            name = pick(rng, _METHODS)
            mechanism = _mechanism() if rng.random() < 0.7 else _loaded()
            _odd(rng, witness, getattr(mechanism, name), name)
        case _:
            source = _motion() if rng.random() < 0.7 else _family()
            name = pick(rng, [n for n in _MOTION if hasattr(source, n)])
            _odd(rng, witness, getattr(source, name), f"{type(source).__name__}.{name}")


def _field_of(part: type) -> str:
    named = {
        "Input": "inputs",
        "Rolling": "rolling",
        "NoncircularGear": "noncircular_gears",
        "Gravity": "gravity",
        "Mass": "masses",
    }
    return named.get(
        part.__name__,
        f"{part.__name__.lower()}s"
        if part not in (lw.forces.Force, lw.NewtonOptions, lw.Segment)
        else "",
    )


def _made(rng: np.random.Generator, witness: Witness) -> None:
    maker, parts = pick(rng, [(lw.linkage, _BAR), (lw.loops, _LOOPS), (lw.plain_equations, _PLAIN)])
    fields = dict(parts)
    for _ in range(int(rng.integers(1, 3))):
        key = pick(rng, [*fields] if rng.random() < 0.6 else _FIELDS)
        fields[key] = _changed_inside(rng, fields.get(key))
    what = f"{maker.__name__} { ({k: v for k, v in fields.items() if parts.get(k) is not v})!r}"[
        :300
    ]
    mechanism = witness.call(what, lambda: maker(**fields))
    if mechanism is not None:
        witness.call(f"solve of {what}", mechanism.solve)


def _changed_inside(rng: np.random.Generator, value: Any) -> Any:
    """An odd object, or the value with one inside."""
    if isinstance(value, dict) and value and rng.random() < 0.7:
        key = pick(rng, [*value])
        return {**value, key: _changed_inside(rng, value[key])}
    if isinstance(value, list | tuple) and value and rng.random() < 0.7:
        k = int(rng.integers(len(value)))
        return [*value[:k], _changed_inside(rng, value[k]), *value[k + 1 :]]
    return pick(rng, OBJECTS)


def _odd(
    rng: np.random.Generator, witness: Witness, function: Callable[..., Any], name: str
) -> Any:
    """Call a function with one or two odd arguments and plausible others."""
    signature = inspect.signature(function)
    positional: list[Any] = []
    keywords: dict[str, Any] = {}
    for parameter in signature.parameters.values():
        needed = parameter.default is parameter.empty
        if parameter.kind is parameter.VAR_POSITIONAL:
            positional += [pick(rng, OBJECTS) for _ in range(int(rng.integers(3)))]
        elif parameter.kind is parameter.VAR_KEYWORD:
            keywords |= {
                pick(rng, ["a", "points", "lengths", "O2 A", "link", "joint", "x"]): pick(
                    rng, OBJECTS
                )
            }
        elif needed or rng.random() < 0.3:
            if parameter.name in ("progress", "threads"):
                continue
            entry = pick(rng, OBJECTS) if rng.random() < 0.7 else _plausible(rng, parameter.name)
            if parameter.kind is parameter.KEYWORD_ONLY:
                keywords[parameter.name] = entry
            else:
                positional.append(entry)
                continue
        elif parameter.kind is not parameter.KEYWORD_ONLY:
            break
    given = [*map(repr, positional), *(f"{key}={entry!r}" for key, entry in keywords.items())]
    what = f"{name}({', '.join(given)})"
    return witness.call(what[:300], lambda: function(*positional, **keywords))


def _plausible(rng: np.random.Generator, name: str) -> Any:
    known = {"from_": 0, "to": 60, "step": 30, "at": 60, "dimensions": {"O2 A": [38.0, 40.0]},
    "of": {"a": (1, 2)},
             "ranges": {"a": (1, 2)}, "levels": {"a": [1, 2]}, "count": 3, "seed": 1,
             "mechanism": _mechanism(),
             "configuration": "open", "guess": {"theta3": 20.0}, "cycle": _motion(),
             "neighbour": _motion()}  # fmt: skip
    return known.get(name, pick(rng, ["A", "crank", "coupler", 1, (1, 2), True]))
