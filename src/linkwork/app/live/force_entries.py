"""Masses and loads as they are typed, and their removal with links, points and parts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from linkwork.app.live.file_state import EntryShown, MassShown, PaletteForm
from linkwork.app.live.number_edits import TypedUnits
from linkwork.app.live.palette import field_of, shown_entry, typed_entries
from linkwork.app.live.requests import SetEntry, SetMass, Typed
from linkwork.core.foundation.errors import UnknownNameError, choices
from linkwork.core.foundation.names import GROUND, canonical, find_spelling
from linkwork.core.foundation.values import Key, NumberValue as NumberKey
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.inputs import MOTOR_KEYS, Input
from linkwork.core.mechanism.machine import (
    FRICTION_KEYS,
    GRAVITY_KEYS,
    STOP_KEYS,
    Gravity,
    LoadedBodies,
)
from linkwork.core.mechanism.part.index import JoinedBodies
from linkwork.core.textfile.writer import TextEdits


def masses_shown(description: Description) -> Iterator[MassShown]:
    """The masses of all moving links, empty for those without."""
    if not isinstance(description, LoadedBodies):
        return
    for link in description.carried:
        if link == GROUND:
            continue
        mass = description.masses.get(link)
        center = () if mass is None or mass.center is None else mass.center
        x, y = map(str, center) if len(center) == 2 else ("", "")
        yield MassShown(
            link=link,
            mass="" if mass is None else str(mass.mass),
            x=x,
            y=y,
            inertia="" if mass is None or mass.shape is not None else str(mass.inertia),
            rod=mass is not None and mass.shape is not None,
        )


def put_mass(edit: SetMass, text: TextEdits) -> None:
    """Write or remove the mass of a link.

    Raises
    ------
    UnknownNameError
        If the link does not exist.
    """
    links = {canonical(link): link for link in text.keys(("links",))}
    if canonical(edit.link) not in links:
        raise UnknownNameError(
            f'there is no link "{edit.link}" {choices("links", links.values(), edit.link)}'
        )
    link = links[canonical(edit.link)]
    before = next(
        (key for key in text.keys(("masses",)) if canonical(key) == canonical(link)), link
    )
    if edit.mass is None:
        if text.has(("masses", before)):
            text.remove(("masses", before))
        return
    entry: dict[str, object] = {"mass": _plain(edit.mass)}
    if edit.x is not None or edit.y is not None:
        entry["center"] = [_plain(part or 0) for part in (edit.x, edit.y)]
    if edit.inertia is not None:
        entry["inertia"] = _plain(edit.inertia)
    if len(entry) == 1 and len(text.get(("links", link))) > 1:
        entry["shape"] = "rod"
    if not text.has(("masses", before)):
        text.put(("masses", before), entry)
        return
    # key by key: the row keeps its place and form
    for key in text.keys(("masses", before)):
        if key not in entry:
            text.remove(("masses", before, key))
    for key, number in entry.items():
        text.put(("masses", before, key), number)


def _plain(number: float | str) -> float | str:
    """A whole number without decimals."""
    whole = isinstance(number, float) and number.is_integer()
    return int(number) if whole else number


def drop_lost_loads(text: TextEdits, *names: str) -> None:
    """Remove masses, friction, loads and stops of links, points and parts that were removed."""
    lost = set(map(canonical, names))
    for table in ("masses", "friction"):
        for key in text.keys((table,)):
            if canonical(key) in lost:
                text.remove((table, key))
    for k, row in reversed(list(text.entries("loads"))):
        if any(canonical(str(row[key])) in lost for key in ("point", "link", "with") if key in row):
            text.remove(("loads", k))
    for k, row in reversed(list(text.entries("stops"))):
        if canonical(str(row.get("of", "")).split(".")[0]) in lost:
            text.remove(("stops", k))


# ----------------------------------------------------------------------
# Entries of gravity, friction, motors and stops as they are typed: shown, changed, removed.


KeyPath = tuple[str | int, ...]

_FLYWHEEL = Key(
    "inertia", NumberKey("area"), "Flywheel that turns with the input; of a length a mass"
)
_KEYS: dict[str, tuple[Key, ...]] = {
    "gravity": GRAVITY_KEYS,
    "friction": FRICTION_KEYS,
    "motor": (*MOTOR_KEYS, _FLYWHEEL),
    "stops": STOP_KEYS,
}

#: The forms of loads that are no parts.
FORMS: tuple[PaletteForm, ...] = tuple(
    PaletteForm(table=table, title=title, doc=doc, fields=tuple(map(field_of, _KEYS[table])))
    for table, title, doc in (
        ("gravity", "Gravity", "Size and direction; downwards without an angle"),
        ("friction", "Friction", "Of pins and guides, in forces; a pin needs its radius"),
        ("motor", "Motor", "What turns an input in simulations, and a flywheel on it"),
        ("stops", "Stops", "Bounds of a quantity in simulations"),
    )
)


def entries_shown(description: Description) -> Iterator[EntryShown]:
    """All entries that there are or can be: those that are not in the file have nothing typed."""
    if isinstance(description, LoadedBodies):
        yield _shown("gravity", "", description.gravity)
    if isinstance(description, JoinedBodies):
        for name, sizes in _joints(description):
            takes = ("mu", *sizes)
            yield _shown("friction", name, description.friction.get(name), takes)
    for k, driven in enumerate(description.inputs):
        yield _motor(k, driven)
    if isinstance(description, LoadedBodies):
        for k, stop in enumerate(description.stops):
            yield _shown("stops", str(k), stop)
        yield _shown("stops", "", None)


def _shown(table: str, of: str, shown: object, takes: Iterable[str] = ()) -> EntryShown:
    keys = _KEYS[table]
    typed = _typed(keys, shown)
    return EntryShown(
        table=table,
        of=of,
        takes=tuple(takes) or tuple(key.name for key in keys),
        there=shown is not None,
        typed=typed,
    )


def _typed(keys: Iterable[Key], shown: object) -> dict[str, Typed]:
    typed: dict[str, Typed] = {}
    for key in keys:
        entry = None if shown is None else getattr(shown, key.attribute, None)
        if entry is not None and entry != () and not (key.name == "restitution" and entry == 0):
            typed[key.name] = shown_entry(key, entry)
    return typed


def _motor(k: int, driven: Input) -> EntryShown:
    typed = _typed(MOTOR_KEYS, driven.motor)
    if driven.inertia is not None:
        typed["inertia"] = str(driven.inertia)
    takes = tuple(key.name for key in _KEYS["motor"])
    return EntryShown(table="motor", of=driven.column, takes=takes, there=bool(typed), typed=typed)


def _joints(bodies: JoinedBodies) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Pins and parts that may have friction, and the sizes that it depends on there."""
    for point in bodies.points:
        if len(list(bodies.bodies_at(point))) > 1:
            yield point, ("radius",)
    for part in bodies.parts:
        if part.names and part.friction_sizes is not None:
            yield part.label, part.friction_sizes


def put_force_entry(edit: SetEntry, text: TextEdits, description: Description) -> None:
    """Write or remove an entry of gravity, friction, a motor or stops.

    Raises
    ------
    InputError, UnknownNameError
        If the table, joint, input or stop does not exist, or an entry does not match its key.
    """
    if edit.table not in _KEYS:
        raise UnknownNameError(
            f'there is no form "{edit.table}" {choices("forms", _KEYS, edit.table)}'
        )
    keys = _KEYS[edit.table]
    k = _input(edit.of, description) if edit.table == "motor" else -1
    row = text.get(("input", k)) if k >= 0 else {}
    units = TypedUnits.of(description)
    typed = typed_entries(f"[{edit.table}]", keys, edit.typed, units, row)
    match edit.table:
        case "gravity":
            _write(("gravity",), keys, typed or {"size": Gravity().size}, edit.remove, text)
        case "friction":
            _write(("friction", _joint(edit.of, description)), keys, typed, edit.remove, text)
        case "motor":
            _write_motor(k, typed, edit.remove, text)
        case _:
            _write_stop(edit, typed, text)


def _joint(name: str, description: Description) -> str:
    names = (
        [one for one, _ in _joints(description)] if isinstance(description, JoinedBodies) else []
    )
    one = find_spelling(name, names)
    if one not in names:
        raise UnknownNameError(
            f'"{name}" is no joint with friction {choices("joints", names, name)}'
        )
    return one


def _input(name: str, description: Description) -> int:
    names = [each.column for each in description.inputs]
    if name not in names:
        raise UnknownNameError(f'"{name}" is no input {choices("inputs", names, name)}')
    return names.index(name)


def _write(
    path: KeyPath, keys: Iterable[Key], entries: Mapping[str, object], remove: bool, text: TextEdits
) -> None:
    """Write a table key by key, so that its row keeps its place, form and comments."""
    if remove or not entries:
        if text.has(path):
            text.remove(path)
        return
    if len(path) > 1 and not text.has(path):
        text.put(path, dict(entries))
        return
    for key in keys:
        key_path = (*path, key.name)
        if key.name in entries:
            if not text.has(key_path) or text.get(key_path) != entries[key.name]:
                text.put(key_path, entries[key.name])
        elif text.has(key_path):
            text.remove(key_path)


def _write_motor(k: int, entries: Mapping[str, object], remove: bool, text: TextEdits) -> None:
    here: KeyPath = ("input", k)
    motor = {name: entry for name, entry in entries.items() if name != "inertia"}
    _write((*here, "motor"), MOTOR_KEYS, motor, remove, text)
    if "inertia" in entries and not remove:
        text.put((*here, "inertia"), entries["inertia"])
    elif text.has((*here, "inertia")):
        text.remove((*here, "inertia"))


def _write_stop(edit: SetEntry, entries: Mapping[str, object], text: TextEdits) -> None:
    count = len(list(text.entries("stops")))
    if not edit.of:
        if entries and not edit.remove:
            text.append("stops", entries)
        return
    if edit.of not in map(str, range(count)):
        raise UnknownNameError(f'there is no stop number "{edit.of}": the file has {count}')
    _write(("stops", int(edit.of)), STOP_KEYS, entries, edit.remove, text)


def entry_title(edit: SetEntry) -> str:
    """The change in a few words, for the history."""
    of = edit.of
    if edit.table == "stops":
        typed = edit.typed.get("of", "")
        of = typed if isinstance(typed, str) else ""
    what = f"{edit.table} of {of}" if of else edit.table
    return f"remove {what}" if edit.remove else what
