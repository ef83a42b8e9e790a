"""All tables and keys of a mechanism file, defined in one place.

The reader's checks (:mod:`~linkwork.core.textfile.reader`) and the published JSON Schema
(:mod:`~linkwork.core.textfile.keys`) are both generated from :data:`FORMS`.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from linkwork.core.foundation.units import FORCES, MASSES
from linkwork.core.foundation.values import (
    Constant,
    Either,
    Flag,
    Formula,
    Key,
    Kind,
    ListOf,
    Measured,
    Named,
    NumberValue,
    PlainNumber,
    Several,
    Speed,
    Table,
    Tables,
    TablesOrFormula,
    Text,
    Whole,
)
from linkwork.core.mechanism.description import HIDDEN, Question
from linkwork.core.mechanism.inputs import LAW_KEYS, MOTOR_KEYS, Input, LawSegment, Motor
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.mechanism.machine import (
    FRICTION_KEYS,
    GRAVITY_KEYS,
    MASS_KEYS,
    STOP_KEYS,
    Friction,
    Gravity,
    Mass,
    Stop,
)
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.mechanism.part.springs import Load
from linkwork.core.mechanism.varied_numbers import CLEARANCES, TOLERANCES

#: The version of the file format that this package reads and writes.
FORMAT = 1


@dataclass(frozen=True)
class Form:
    """A kind of file: its keys, and the table ``marker`` that identifies it, if any.

    ``made`` makes a description of its values.
    """

    title: str
    doc: str
    marker: str
    keys: tuple[Key, ...]
    made: Callable[..., Any] = dict

    @property
    def definition(self) -> str:
        """Its name in the definitions of the JSON Schema."""
        return self.title.replace("-", "_").replace(" ", "_")


_POINT_LIST = ListOf(Text(), "point")

_HEAD = (
    Key(
        "format",
        Constant(FORMAT),
        "The version of this file format; write format = 1",
        required=True,
    ),
    Key("name", Text(), "Name of the mechanism"),
    Key("length", Text(), "Unit of every length in this file; nothing is converted"),
    Key("angle", Text(("deg", "rad")), "Unit of every angle in this file"),
    Key("purpose", Text(), "What the mechanism is for, in one sentence"),
    Key("source", Text(), "Where the mechanism comes from: book, page, drawing"),
    Key("family", Text(), 'The family in lists of mechanisms: "straight line", "engine"'),
    Key(
        "configuration",
        Text(),
        'The configuration or branch to start from instead of the guess: "crossed", '
        '"circuit 1 branch 2"',
    ),
)
_DIMENSIONS = Key(
    "dimensions",
    Named(NumberValue("named")),
    "Named numbers and formulas, usable in place of numbers",
)
_OUTPUTS = Key(
    "outputs",
    Named(Formula()),
    "Named formulas of unknowns, dimensions and point coordinates (A.x)",
)
_TRACE = Key(
    "trace",
    Table(
        (Key("points", _POINT_LIST, "Points whose paths are drawn", required=True),),
        made=lambda points=(): points,
    ),
    "Traces in pictures",
)
_FORCE_UNITS = (
    Key("mass", Text(tuple(MASSES)), "Unit of every mass in this file; default kg"),
    Key("force", Text(tuple(FORCES)), "Unit of every force in this file; default N"),
)
_MASSES = (
    Key("gravity", Table(GRAVITY_KEYS, Gravity), "Gravity: size and direction; none unless given"),
    Key("masses", Named(Table(MASS_KEYS, Mass)), "Masses of links: crank = { mass = 1.2, … }"),
    Key("stops", Tables(STOP_KEYS, made=Stop), "Bounds of quantities in simulations"),
)
_FRICTION = Key(
    "friction",
    Named(Table(FRICTION_KEYS, Friction)),
    "Friction of pins and parts: A = { mu = 0.1, radius = 5 }",
)
_QUESTIONS = Key(
    "questions",
    Tables(
        (
            Key("text", Text(), "The question", required=True),
            Key(
                "answer",
                NumberValue(),
                '"dead points", "change points", a number of the whole motion such as '
                '"stroke(rocker)", with at a quantity such as "mu", or the number itself',
                required=True,
            ),
            Key("at", PlainNumber(), "The input value at which the quantity is asked"),
            Key(
                "tolerance",
                PlainNumber(),
                "How far an answer may be from the right one, in its unit",
                required=True,
            ),
            Key("unit", Text(), "The unit of an answer that is given as a number"),
            Key(
                "hide",
                ListOf(Text(HIDDEN), "word"),
                "What a page hides until the question is answered; default all but equations",
            ),
        ),
        made=Question,
    ),
    "Questions asked on pages; answers are computed, and hidden until they are asked for",
)
_GUESS = Key(
    "guess",
    Named(NumberValue("named")),
    "Estimates of all unknowns at one input value",
    required=True,
)
_RANGE = (
    Key(
        "from",
        NumberValue("ranged"),
        "First input value; with a law the first time [s]",
        field="from_",
    ),
    Key("to", NumberValue("ranged"), "Last input value; with a law the last time [s]"),
    Key(
        "step",
        NumberValue("ranged"),
        "Step between input values, or times; its sign points from the first to the last",
    ),
    Key(
        "speed",
        Speed(),
        'Speed of the input, "300 rpm"; a plain number is in file units per second',
    ),
    Key(
        "law",
        TablesOrFormula(LAW_KEYS, LawSegment),
        "How the input moves in time: segments from t = 0, or a formula of t",
    ),
    Key(
        "begin", NumberValue("driven"), "With segments: input value at t = 0; default: the sketch's"
    ),
    Key("motor", Table(MOTOR_KEYS, Motor), "What drives the input in simulations"),
    Key("inertia", NumberValue("area"), "Flywheel on the input in simulations"),
)
_DRIVES = (
    Key("link", Text(of="link"), "The link whose angle is driven"),
    Key(
        "relative_to",
        Text(of="link"),
        "The link relative to which the angle is measured; default ground",
    ),
    Key("joint", Text(of="point"), "The pin whose relative angle is driven"),
    Key("slider", Text(of="slider"), "The slider or slot whose displacement is driven"),
    Key("cylinder", Text(of="slider"), "The cylinder whose length is driven"),
    *_RANGE,
)
_VARIABLE = (
    Key("variable", Text(), "The driven variable of the equations", required=True),
    *_RANGE,
)


def _input(keys: tuple[Key, ...], doc: str) -> Key:
    return Key("input", Tables(keys, single=True, made=Input), doc, field="inputs")


LINKAGE = Form(
    "points-and-links",
    "A mechanism given by points and links",
    "",
    (
        *_HEAD,
        *_FORCE_UNITS,
        Key("sketch", Flag(), "If true, dimensions are never measured from [points]"),
        _DIMENSIONS,
        Key(
            "points",
            Named(ListOf(NumberValue("length"), "coordinate", 2, 2)),
            "One assembled position: A = [35, 20]; exact on ground, elsewhere a sketch is enough",
            required=True,
        ),
        Key(
            "links",
            Named(ListOf(Text(), "point", 1)),
            'The points each link carries: crank = ["O2", "A"]; "ground" is fixed',
            required=True,
        ),
        Key("lengths", Named(NumberValue("length"), 2), 'Exact distances in one link: "O2 A" = 40'),
        Key(
            "angles",
            Named(NumberValue("angle"), 3),
            'Exact angles in one link: "B A P" = 30, at A from AB to AP, counter-clockwise',
        ),
        *(Key(name, Tables(kind.keys, made=kind), kind.doc) for name, kind in PARTS.items()),
        *_MASSES,
        _FRICTION,
        _input(_DRIVES, "The driven quantity and its range"),
        TOLERANCES,
        CLEARANCES,
        _TRACE,
        _OUTPUTS,
        _QUESTIONS,
    ),
    Linkage,
)
LOOPS = Form(
    "loops",
    "A mechanism given by vector loop-closure equations",
    "loops",
    (
        *_HEAD,
        *_FORCE_UNITS,
        _DIMENSIONS,
        Key(
            "loops",
            Named(Formula(equation=True), 0),
            'Loop equations by label: "A B C" = "a2*e^(i*theta2) + a3*e^(i*theta3) = d"',
            required=True,
        ),
        _GUESS,
        _input(
            _VARIABLE,
            'The driven variable: variable = "theta2"; without it the loops describe a structure',
        ),
        Key(
            "points",
            Named(Formula()),
            'Points as formulas, A = "a2*e^(i*theta2)", for drawings',
        ),
        Key(
            "links",
            Named(ListOf(Text(), "point", 1)),
            'Points drawn as one link: crank = ["A0", "A"]; "ground" is fixed',
        ),
        *_MASSES,
        Key("loads", Tables(Load.keys, made=Load), Load.doc),
        TOLERANCES,
        _TRACE,
        _OUTPUTS,
        _QUESTIONS,
    ),
    Loops,
)
EQUATIONS = Form(
    "plain-equations",
    "Any small system of real equations, solved by Newton-Raphson",
    "equations",
    (
        *_HEAD,
        _DIMENSIONS,
        Key(
            "equations",
            Named(Formula(equation=True), 0),
            'Real equations by label: f = "x^3 - 2*x + 2 = 0"',
            required=True,
        ),
        _GUESS,
        _input(_VARIABLE, 'The driven variable: variable = "x"'),
        TOLERANCES,
        _OUTPUTS,
        _QUESTIONS,
    ),
    PlainEquations,
)
FORMS = (LINKAGE, LOOPS, EQUATIONS)


def form_of(tables: Iterable[str]) -> Form:
    """The form of a file with these top-level keys."""
    present = set(tables)
    return next((form for form in FORMS if form.marker in present), LINKAGE)


# ----------------------------------------------------------------------
# The JSON Schema of mechanism files, for completion and checks in editors.


_DRAFT = "https://json-schema.org/draft/2020-12/schema"
_FORMULA = {"type": "string", "minLength": 1}
_SHARED: dict[str, dict[str, Any]] = {
    "number": {
        "description": "A number, or a formula of the named dimensions in quotes",
        "anyOf": [{"type": "number"}, _FORMULA],
    },
    "formula": {"description": "A formula in quotes", **_FORMULA},
    "equation": {
        "description": "An equation in quotes: left = right",
        "type": "string",
        "pattern": "^[^=]+=[^=]+$",
    },
    "speed": {
        "description": 'A number (units per second), or text with a unit: "300 rpm"',
        "anyOf": [{"type": "number"}, _FORMULA],
    },
}


def json_schema() -> dict[str, Any]:
    """The schema (draft 2020-12) as a dictionary; one definition for each form."""
    definitions = {form.definition: _form(form) for form in FORMS}
    return {
        "$schema": _DRAFT,
        "title": "Linkwork mechanism file",
        "description": "A planar mechanism given by points and links, by loop equations, or by "
        "plain equations",
        "oneOf": [{"$ref": f"#/$defs/{name}"} for name in definitions],
        "$defs": {**definitions, **_SHARED},
    }


def schema_of(form: Form) -> dict[str, Any]:
    """The schema of files that have one form only."""
    return {"$schema": _DRAFT, **_form(form), "$defs": _SHARED}


def schema_text(schema: Mapping[str, Any] | None = None) -> str:
    """The published text of a schema; by default that of mechanism files."""
    return json.dumps(schema or json_schema(), indent=2, ensure_ascii=False) + "\n"


def _form(form: Form) -> dict[str, Any]:
    return {"title": f"Linkwork {form.title} file", "description": form.doc, **_fields(form.keys)}


def _fields(keys: tuple[Key, ...]) -> dict[str, Any]:
    """A table with a fixed set of keys."""
    found: dict[str, Any] = {
        "type": "object",
        "properties": {key.name: _described(key) for key in keys},
        "additionalProperties": False,
    }
    required = [key.name for key in keys if key.required]
    return {**found, "required": required} if required else found


def _described(key: Key) -> dict[str, Any]:
    return {"title": key.name, "description": key.doc, **_schema(key.kind)}


def _schema(kind: Kind) -> dict[str, Any]:
    match kind:
        case Constant(number):
            return {"const": number}
        case Text(words):
            return {"type": "string", "enum": list(words)} if words else {"type": "string"}
        case NumberValue():
            return {"$ref": "#/$defs/number"}
        case PlainNumber():
            return {"type": "number"}
        case Whole(least, most):
            return {"type": "integer", "minimum": least, "maximum": most}
        case Several(values, table):
            return {"anyOf": [{"type": "number"}, _schema(values), _fields(table.keys)]}
        case Either(plain, other):
            return {"anyOf": [_schema(plain), _schema(other)]}
        case Formula(equation):
            return {"$ref": "#/$defs/equation" if equation else "#/$defs/formula"}
        case Speed():
            return {"$ref": "#/$defs/speed"}
        case Measured(example):
            return {"type": ["number", "string"], "examples": [example]}
        case Flag():
            return {"type": "boolean"}
        case Table(keys):
            return _fields(keys)
        case Tables(keys, single):
            many = {"type": "array", "items": _fields(keys)}
            return {"anyOf": [_fields(keys), many]} if single else many
        case TablesOrFormula(keys):
            return {"anyOf": [{"type": "array", "items": _fields(keys)}, _FORMULA]}
        case ListOf(of, _, least, most):
            found = {"type": "array", "items": _schema(of), "minItems": least}
            return found if most is None else {**found, "maxItems": most}
        case Named(of, words):
            return {"type": "object", "additionalProperties": _schema(of), **_key_names(words)}


def _key_names(words: int) -> dict[str, Any]:
    """The pattern of keys that consist of several names."""
    if words < 2:
        return {}
    return {"propertyNames": {"pattern": r"^\s*\S+" + r"\s+\S+" * (words - 1) + r"\s*$"}}
