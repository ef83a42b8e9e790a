"""Compares cycles that the page of a browser received with those that CPython sends."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from linkwork.app.pages.page_data import PackedColumn
from linkwork.core.foundation.arrays import Array, BoolArray
from tests.app.unpacking import unpacked

__all__ = ["differences"]

#: Of coordinates, relative to the size of the mechanism.
_SAME = 1e-12
_SAME_INPUT = 1e-9  # of limits, relative

Event = dict[str, Any]


def differences(one: Event, other: Event) -> Iterator[str]:
    """What differs between two ``motion_found`` events: rows, statuses, certificates, limits and
    coordinates.
    """
    for name in ("rows", "missing", "certified", "message"):
        if one[name] != other[name]:
            yield f"{name}: {one[name]} and {other[name]}"
    yield from _limits(one["limits"], other["limits"])
    if one["page"] is None or other["page"] is None:
        if one["page"] is not other["page"]:
            yield "one has no page"
        return
    for a, b in zip(one["page"]["motions"], other["page"]["motions"], strict=True):
        for name in ("status", "certification", "branch"):
            if _evidence(a, name) != _evidence(b, name):
                yield f"{name} of rows"
        if not np.array_equal(_found(a), _found(b)):
            yield "rows with positions"
            continue
        yield from _coordinates(a, b)


def _limits(one: list[Event], other: list[Event]) -> Iterator[str]:
    if [(each["what"], each["located"]) for each in one] != [
        (each["what"], each["located"]) for each in other
    ]:
        yield f"limits: {one} and {other}"
        return
    for a, b in zip(one, other, strict=True):
        if abs(a["input"] - b["input"]) > _SAME_INPUT * max(1.0, abs(b["input"])):
            yield f"a limit at {a['input']} and {b['input']}"


def _coordinates(one: Event, other: Event) -> Iterator[str]:
    found = _found(one)
    places = [_places(each, found) for each in (one, other)]
    if places[0].keys() != places[1].keys():
        yield f"points: {sorted(places[0])} and {sorted(places[1])}"
        return
    every = np.concatenate([*places[1].values(), np.zeros(1)])
    size = float(np.ptp(every[np.isfinite(every)]))
    for name, values in places[0].items():
        apart = np.abs(values - places[1][name])[found]
        if not bool((apart <= _SAME * size).all()):
            yield f"{name}: {float(np.nanmax(apart)) / size:.1e} of the size apart"


def _places(motion: Event, found: BoolArray) -> dict[str, Array]:
    return {
        f"{point['name']}.{axis}": _column(point[axis], found)
        for point in motion["points"]
        for axis in ("x", "y")
    }


def _found(motion: Event) -> BoolArray:
    every = np.ones(motion["rows"], dtype=bool)
    found: BoolArray = _column(motion["evidence"]["found"], every) == 1
    return found


def _evidence(motion: Event, name: str) -> list[str]:
    """A text for every row."""
    evidence = motion["evidence"]
    texts = evidence["branch_names" if name == "branch" else f"{name}_texts"]
    every = np.ones(motion["rows"], dtype=bool)
    return [texts[int(k)] for k in _column(evidence[name], every)]


def _column(column: Event, found: BoolArray) -> Array:
    return unpacked(PackedColumn(**column), found)
