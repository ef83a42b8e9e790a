"""The types of what a caller gives for the fields of a description."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import Any, TypeVar, cast

from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import canonical
from linkwork.foundation.plain_numbers import as_told
from linkwork.foundation.value_types import is_listed

__all__ = ["check_entries", "check_field_types", "fields_of", "made_of", "merged"]

T = TypeVar("T")


def made_of(kind: type[T], given: Mapping[str, Any]) -> T:
    """A description from its fields by name.

    Raises
    ------
    UnknownNameError
        For a field that does not exist, with those that do.
    """
    return kind(**fields_of(kind, given))


def fields_of(kind: type, given: Mapping[str, Any]) -> Mapping[str, Any]:
    """The same fields by name, all of which exist; raises like :func:`made_of`."""
    names = [field.name for field in fields(cast(Any, kind)) if field.init]
    for name in given:
        if name not in names:
            raise UnknownNameError(f'there is no field "{name}" {choices("fields", names, name)}')
    return given


def merged(description: Any, given: Mapping[str, Any]) -> dict[str, Any]:
    """New fields of a description: entries of tables by name join those that it has.

    An entry ``None`` removes the one of that name, an empty table all; lists replace lists.

    Raises
    ------
    UnknownNameError
        For a field, or an entry to be removed, that does not exist.
    """
    changed = dict(fields_of(type(description), given))
    for table, new in changed.items():
        old = getattr(description, table)
        if isinstance(old, Mapping) and isinstance(new, Mapping) and new:
            changed[table] = _joined(table, old, new)
    return changed


def _joined(table: str, old: Mapping[Any, Any], new: Mapping[Any, Any]) -> dict[Any, Any]:
    spelled = {_folded(key): key for key in old}
    # keys that are no texts are refused later, with the field's name
    keys = {key: spelled.get(_folded(key), key) if isinstance(key, str) else key for key in new}
    for key, entry in new.items():
        if entry is None and keys[key] not in old:
            raise UnknownNameError(f'{table} has no "{key}" {choices(table, old, str(key))}')
    if len(set(keys.values())) < len(keys):
        raise InputError(f"{table} has two values under one name: {', '.join(map(str, keys))}")
    entries = {**old, **{keys[key]: entry for key, entry in new.items()}}
    return {key: entry for key, entry in entries.items() if entry is not None}


def _folded(key: str) -> tuple[str, ...]:
    words = canonical(key).split()
    # a distance has no direction, an angle has
    return tuple(sorted(words) if len(words) == 2 else words)


def check_field_types(description: Any) -> None:
    """Check that every field has the type of its default value.

    Raises
    ------
    InputError
        With the field, the type it must have, and what was given.
    """
    for field in fields(description):
        if not field.init:
            continue
        name, given = field.name, getattr(description, field.name)
        if isinstance(field.default, Mapping):
            _check_mapping(name, str(field.type), given)
        elif isinstance(field.default, tuple):
            if not is_listed(given):
                raise _wrong(name, "a list", given)
        elif isinstance(field.default, bool | str) and not isinstance(given, type(field.default)):
            wanted = "a text" if isinstance(field.default, str) else "True or False"
            raise _wrong(name, wanted, given)


def check_entries(name: str, kind: type, given: Iterable[Any]) -> None:
    """Check that all entries of a field are of one class.

    Raises
    ------
    InputError
        With the field, the class, and what was given.
    """
    for k, entry in enumerate(given):
        if not isinstance(entry, kind):
            raise _wrong(f"{name}[{k}]", f"a lw.{kind.__name__}(…)", entry)


def _check_mapping(name: str, kind: str, given: Any) -> None:
    """``kind``: the type of the field as written: ``Mapping[str, …]``."""
    lists, texts = kind.startswith("Mapping[str, tuple"), kind == "Mapping[str, str]"
    wanted = _ENTRIES.get(name, "values") if lists else "texts" if texts else "values"
    if not isinstance(given, Mapping):
        raise _wrong(name, f"a dictionary of names and {wanted}", given)
    for key, entry in given.items():
        if not isinstance(key, str):
            raise InputError(f"the names in {name} must be texts, got {as_told(key)}")
        if lists and not is_listed(entry):
            raise _wrong(f'{name}["{key}"]', f"a list of {wanted}", entry)
        if texts and not isinstance(entry, str):
            raise _wrong(f'{name}["{key}"]', "a text", entry)


#: What the lists in a mapping contain.
_ENTRIES = {"points": "coordinates", "links": "points"}


def _wrong(name: str, wanted: str, given: Any) -> InputError:
    return InputError(f"{name} must be {wanted}, got {as_told(given)}")
