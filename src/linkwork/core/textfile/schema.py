"""The JSON Schema of mechanism files, for completion and checks in editors."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

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
from linkwork.core.textfile.keys import FORMS, Form

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
