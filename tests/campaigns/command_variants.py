"""Library mechanisms as files of few rows, changed: what commands seldom meet."""

from __future__ import annotations

import contextlib
import json
import tomllib
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import tomlkit

import linkwork as lw

__all__ = ["MECHANISMS", "VARIANTS", "Data", "inputs_of", "variant_text"]

Data = dict[str, Any]

_ROWS = 12  # of tables
_TURN = {"rad": 6.283185307179586}
_BLOCK = {"name": "s", "link": "block", "points": ["A"], "on": "ground", "line": ["O", "C"]}
#: What is driven on ground directly: a bar, two bars, a block.
_BARS: tuple[Data, ...] = (
    {
        "points": {"O": [0, 0], "A": [30, 10]},
        "links": {"ground": ["O"], "bar": ["O", "A"]},
        "input": {"link": "bar", "from": 0, "to": 90, "step": 10},
    },
    {
        "points": {"O": [0, 0], "A": [30, 10], "B": [50, 40]},
        "links": {"ground": ["O"], "upper": ["O", "A"], "lower": ["A", "B"]},
        "input": [
            {"link": "upper", "from": 0, "to": 90, "step": 10},
            {"link": "lower", "relative_to": "upper", "from": 0, "to": 90, "step": 10},
        ],
    },
    {
        "points": {"O": [0, 0], "A": [30, 0], "B": [40, 20], "C": [60, 0]},
        "links": {"ground": ["O", "C"], "block": ["A", "B"]},
        "sliders": [_BLOCK],
        "input": {"slider": "s", "from": 10, "to": 90, "step": 10},
    },
)
_OF_LINKS = ("format", "name", "length", "angle", "points", "links", "input", "dimensions")


def inputs_of(data: Data) -> list[Data]:
    """The inputs of a file, however many."""
    inputs = data.get("input", [])
    return inputs if isinstance(inputs, list) else [inputs]


def variant_text(name: str, variant: str, *, loaded: bool) -> str:
    """The file of a library mechanism, changed; ``loaded``: every link has mass."""
    data = tomllib.loads(lw.example_text(name))
    for which in inputs_of(data):
        _coarsen(which, _TURN.get(data.get("angle", "deg"), 360.0))
    VARIANTS[variant](data)
    if loaded and "equations" not in data:
        _load(data)
    return tomlkit.dumps(data)


def _coarsen(which: Data, turn: float) -> None:
    ends: list[Any] = [which.get("from"), which.get("to")]
    if all(isinstance(end, int | float) for end in ends) and ends[0] != ends[1]:
        which["step"] = (ends[1] - ends[0]) / (_ROWS - 1)
    elif not {"law", "step", "from"} & {*which} and "link" in which:
        which.update({"from": 0, "to": turn, "step": turn / (_ROWS - 1)})


def _load(data: Data) -> None:
    masses = data.setdefault("masses", {})
    for link, points in data.get("links", {}).items():
        if link != "ground" and link not in masses:
            masses[link] = {"mass": 1.5, "shape": "rod"} if len(points) > 1 else {"mass": 1.5}
    data["length"] = "mm"


def _as_it_is(_: Data) -> None:
    """Only fewer rows."""


def _no_unknowns(data: Data) -> None:
    """The first driven link on ground alone, or one of the mechanisms above."""
    links, ground = data.get("links", {}), set(data.get("links", {}).get("ground", ()))
    driven = [which for which in inputs_of(data) if which.get("link") in links]
    kept = [which for which in driven if ground & {*links[which["link"]]}][:1]
    if not kept or "relative_to" in kept[0] or len(links[kept[0]["link"]]) < 2 or "loops" in data:
        bar = json.loads(json.dumps(_BARS[len(data.get("name", "")) % len(_BARS)]))
        data.clear()
        data.update({"format": 1, **bar})
        return
    link = kept[0]["link"]
    points = set(links[link])
    data["links"] = {"ground": [p for p in links["ground"] if p in points], link: links[link]}
    data["points"] = {p: place for p, place in data["points"].items() if p in points}
    data["input"] = kept[0]
    for table in {*data} - {*_OF_LINKS}:
        del data[table]


def _one_row(data: Data) -> None:
    for which in inputs_of(data):
        which.pop("step", None)
        which["from"] = which["to"] = which.get("from", 0)


def _two_inputs(data: Data) -> None:
    """A second input, in place of a link or equation where the mechanism moves with one only."""
    data["input"] = [dict(which) for which in inputs_of(data)]
    if "loops" in data or "equations" in data:
        _drive_unknown(data, "loops" if "loops" in data else "equations")
        return
    driven = {which.get("link") for which in data["input"]} | {"ground"}
    spare = [link for link in data["links"] if link not in driven]
    for gone in [None, *reversed(spare)]:
        for link in spare:
            tried = json.loads(json.dumps(data))
            if gone is not None:
                _drop_link(tried, gone)
            tried["input"].append({"link": link, "from": 0, "to": 20, "step": 20 / (_ROWS - 1)})
            with contextlib.suppress(lw.LinkworkError):
                lw.loads(tomlkit.dumps(tried))
                data.clear()
                data.update(tried)
                return


def _drive_unknown(data: Data, table: str) -> None:
    if len(data[table]) > 1:
        del data[table][[*data[table]][-1]]
    known = " ".join(map(str, data[table].values()))
    data["guess"] = {n: value for n, value in data["guess"].items() if n in known}
    driven = {which["variable"] for which in data["input"]}
    free = [n for n, value in data["guess"].items() if n not in driven and value != str(value)]
    for name in free[:1]:
        value = data["guess"][name]
        data["input"].append({"variable": name, "from": value, "to": value})


def _drop_link(data: Data, link: str) -> None:
    """Leave out a link, its points that no other one carries, and all that names them."""
    gone = set(data["links"].pop(link)) - {p for ps in data["links"].values() for p in ps} | {link}
    for table in ("points", "lengths", "angles", "masses", "clearances", "friction"):
        if table in data:
            data[table] = {k: v for k, v in data[table].items() if not {*k.split()} & gone}
    for table in {*data} & {"trace", "outputs", "questions"}:
        del data[table]
    for table, entries in [*data.items()]:
        if isinstance(entries, list) and table != "input":
            data[table] = [entry for entry in entries if not gone & {*_words(entry)}]


def _words(entry: Any) -> Iterator[str]:
    if isinstance(entry, str):
        yield entry
    elif isinstance(entry, Mapping | list):
        for value in entry.values() if isinstance(entry, Mapping) else entry:
            yield from _words(value)


def _laws(data: Data) -> None:
    """Segments and formulas in turn; the times are written at the last input only."""
    inputs = inputs_of(data)
    for k, which in enumerate(inputs):
        ends = which.get("from", 0), which.get("to", 30)
        text = any(isinstance(end, str) for end in ends)
        span = 1.0 if text else float(min(max(ends[1] - ends[0], -30.0), 30.0)) or 10.0
        for key in {*which} & {"from", "to", "step", "speed", "motor"}:
            del which[key]
        which["law"] = f"{span}*t"
        if k % 2 == 0:
            rise, rest, back = (
                {"law": "cycloidal", "over": "0.5 s", "by": 0.5 * span},
                {"law": "dwell", "over": "0.1 s"},
                {"law": "spline", "times": [0.2, 0.4], "values": [0.1 * span, 0.3 * span]},
            )
            which["law"] = [rise, rest, back]
    if inputs:
        inputs[-1].update({"from": 0, "to": 1, "step": 1 / _ROWS})


def _no_points(data: Data) -> None:
    for table in {*data} & {"points", "trace"}:
        del data[table]
    if "loops" in data:
        for table in {*data} & {"links", "masses", "loads", "stops"}:
            del data[table]


def _nothing_to_show(data: Data) -> None:
    """Without traces, outputs and titles."""
    for table in {*data} & {"trace", "outputs", "questions", "name", "purpose", "source"}:
        del data[table]


#: How files are changed.
VARIANTS: dict[str, Callable[[Data], None]] = {
    "as it is": _as_it_is,
    "no unknowns": _no_unknowns,
    "one row": _one_row,
    "two inputs": _two_inputs,
    "laws": _laws,
    "no points": _no_points,
    "nothing to show": _nothing_to_show,
}
#: The library.
MECHANISMS = tuple(lw.examples())
