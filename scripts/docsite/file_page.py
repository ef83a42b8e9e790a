"""The reference page of the keys of mechanism files, from their JSON Schema."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from linkwork.core.textfile import json_schema

__all__ = ["file_page"]

_FORMS = {
    "points_and_links": "Points and links",
    "loops": "Loop equations",
    "plain_equations": "Plain equations",
}


def file_page() -> str:
    """Every key of the three forms of a file, as Markdown."""
    schema = json_schema()
    parts = [
        "# Keys of a file\n",
        "From the JSON Schema that `linkwork schema` prints; [mechanism files](file-format.md)",
        "has examples. A number may be a formula of `[dimensions]`.\n",
    ]
    for form, title in _FORMS.items():
        properties = schema["$defs"][form]["properties"]
        required = schema["$defs"][form].get("required", ())
        simple = {key: found for key, found in properties.items() if not list(_rows(found))}
        parts.append(f"## {title}\n")
        parts += _table(simple, required)
        for key, found in properties.items():
            for below, needed in _rows(found):
                brackets = f"[[{key}]]" if found.get("type") == "array" else f"[{key}]"
                parts.append(f"### `{brackets}` in {title.lower()}\n\n{found['description']}.\n")
                parts += _table(below, needed)
    return "\n".join(parts)


def _rows(found: Mapping[str, Any]) -> Iterator[tuple[dict[str, Any], list[str]]]:
    """The keys of a table, or of the tables in an array, with those that are required."""
    choices = [found, found.get("items", {}), found.get("additionalProperties", {})]
    for choice in [*choices, *found.get("oneOf", ()), *found.get("anyOf", ())]:
        if isinstance(choice, dict) and choice.get("properties"):
            yield choice["properties"], choice.get("required", [])
            return


def _table(keys: Mapping[str, Any], required: object) -> list[str]:
    needed = set(required) if isinstance(required, list | tuple) else set()
    lines = ["| key | value | meaning |\n|---|---|---|"]
    for key, found in keys.items():
        star = ", required" if key in needed else ""
        text = found.get("description", "").replace("|", "\\|")
        lines.append(f"| `{key}` | {_value(found)}{star} | {text} |")
    return [*lines, ""]


def _value(found: Mapping[str, Any]) -> str:
    """What may be written, in words."""
    if "const" in found:
        return f"`{found['const']}`"
    if "enum" in found:
        return " or ".join(f"`{choice}`" for choice in found["enum"])
    if "$ref" in found:
        return str(found["$ref"].rsplit("/", 1)[-1])
    if found.get("type") == "array":
        return f"list of {_value(found['items'])}"
    if "anyOf" in found or "oneOf" in found:
        return " or ".join(_value(choice) for choice in found.get("anyOf", found.get("oneOf")))
    if found.get("type") == "object":
        return "table"
    return {"string": "text", "boolean": "`true` or `false`"}.get(
        str(found.get("type")), str(found.get("type"))
    )
