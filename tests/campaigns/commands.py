"""Every command on every library mechanism without unknowns, of one row, with two inputs, with laws,
without points, and with nothing to show.

``python -m tests.campaigns.commands crank-slider "no unknowns"`` repeats the commands of one variant.
"""

from __future__ import annotations

import contextlib
import json
import os
import shlex
import sys
import tempfile
import tomllib
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from time import perf_counter
from typing import Any
from unittest.mock import patch

import tomlkit
from click.testing import CliRunner

import linkwork as lw
from linkwork.cli import main as program
from linkwork.design.synthesis.solving import solve_task
from linkwork.viewer.live.bench import Bench
from linkwork.viewer.live.mechanism_file import MechanismFile
from tests.campaigns.fuzzing.witness import Witness

__all__ = ["VARIANTS", "command_campaign", "commands_of", "variant_text"]

_PATIENCE = 2.0  # seconds that a command may take without a bar or line of progress
_ROWS = 12  # of tables
_LENGTHY = ("slider", "cylinder", "variable")  # inputs whose range has no natural size

Data = dict[str, Any]


def _first_input(data: Data) -> Data:
    inputs = data.get("input", {})
    first: Data = (inputs[0] if inputs else {}) if isinstance(inputs, list) else inputs
    return first


def _inputs(data: Data) -> list[Data]:
    inputs = data.get("input", [])
    return inputs if isinstance(inputs, list) else [inputs]


_BARS = (
    # what is driven on ground directly: a bar, two bars, a block
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
        "sliders": [{"name": "s", "link": "block", "points": ["A"], "on": "ground", "line": ["O", "C"]}],
        "input": {"slider": "s", "from": 10, "to": 90, "step": 10},
    },
)


def _no_unknowns(data: Data) -> None:
    """Only a driven link on ground, or one of the mechanisms above."""
    links, ground = data.get("links", {}), set(data.get("links", {}).get("ground", ()))
    driven = [which["link"] for which in _inputs(data) if {"link"} == {"link", "relative_to"} & {*which}]
    kept = [link for link in driven if ground & set(links.get(link, ()))][:1]
    alone = not kept or len(links[kept[0]]) < 2
    if alone or "loops" in data:
        own = json.loads(json.dumps(_BARS[len(data.get("name", "")) % len(_BARS)]))
        data.clear()
        data.update({"format": 1, **own})
        return
    points = set(links[kept[0]])
    data["links"] = {"ground": [p for p in links["ground"] if p in points], kept[0]: links[kept[0]]}
    data["points"] = {p: place for p, place in data["points"].items() if p in points}
    data["input"] = next(which for which in _inputs(data) if which.get("link") == kept[0])
    for table in ("lengths", "angles"):
        if table in data:
            data[table] = {k: v for k, v in data[table].items() if set(k.split()) <= points}
    kinds = ("format", "name", "length", "angle", "points", "links", "input", "lengths", "dimensions")
    for table in {*data} - {*kinds, "angles"}:
        del data[table]


def _one_row(data: Data) -> None:
    for which in _inputs(data):
        begin = which.get("from", 0)
        which.pop("step", None)
        which["from"] = which["to"] = begin


def _two_inputs(data: Data) -> None:
    """A second input in place of the first part or link without which the mechanism is movable."""
    if not _inputs(data):
        data["input"] = []
    data["input"] = [dict(which) for which in _inputs(data)]
    if "links" not in data or "loops" in data or "equations" in data:
        guessed = [n for n in data.get("guess", {}) if all(w["variable"] != n for w in data["input"])]
        table = "equations" if "equations" in data else "loops"
        if guessed:
            # the last equation goes with an unknown: two inputs in its place
            if len(data[table]) > 1:
                del data[table][[*data[table]][-1]]
                known = " ".join(map(str, data[table].values()))
                data["guess"] = {n: value for n, value in data["guess"].items() if n in known}
                guessed = [name for name in guessed if name in known]
            value = data["guess"][guessed[0]]
            if isinstance(value, str):
                value = 1
            second = {"variable": guessed[0], "from": value, "to": value, "step": 1}
            data["input"].append(second)
        return
    named = {which.get("link") for which in data["input"]} | {"ground"}
    spare = [link for link in data["links"] if link not in named]
    for gone in [None, *reversed(spare)]:
        for link in spare:
            if link == gone:
                continue
            tried = json.loads(json.dumps(data))
            if gone is not None:
                _without_link(tried, gone)
            first = tried["input"][0] if tried["input"] else {}
            second = {"link": link, "from": 0, "to": 0}
            if first.get("from") is not None and first.get("from") != first.get("to"):
                second = {"link": link, "from": 0, "to": 20, "step": 20 / (_ROWS - 1)}
            tried["input"].append(second)
            with contextlib.suppress(lw.LinkworkError):
                lw.loads(tomlkit.dumps(tried))
                data.clear()
                data.update(tried)
                return


def _without_link(data: Data, link: str) -> None:
    """A link and its points that no other one carries, and all that names them, left out."""
    gone = set(data["links"].pop(link)) - {p for ps in data["links"].values() for p in ps} | {link}
    for table in ("points", "lengths", "angles", "masses", "clearances", "friction"):
        if isinstance(data.get(table), dict):
            data[table] = {k: v for k, v in data[table].items() if not set(k.split()) & gone}
    if "trace" in data:
        data["trace"] = {"points": [p for p in data["trace"]["points"] if p not in gone]}
    data.pop("outputs", None)
    data.pop("questions", None)
    for table, entries in [*data.items()]:
        if isinstance(entries, list) and table != "input":
            data[table] = [e for e in entries if not any(name in gone for name in _words(e))]
            if not data[table]:
                del data[table]


def _words(entry: Any) -> Iterator[str]:
    if isinstance(entry, str):
        yield entry
    elif isinstance(entry, Mapping):
        for value in entry.values():
            yield from _words(value)
    elif isinstance(entry, list):
        for value in entry:
            yield from _words(value)


def _laws(data: Data) -> None:
    """Segments for every other input, formulas for the others; only the last has times."""
    inputs = _inputs(data)
    for k, which in enumerate(inputs):
        span = _span(which)
        for key in ("from", "to", "step", "speed", "motor"):
            which.pop(key, None)
        if k % 2 == 0:
            half = 0.5 * span
            which["law"] = [
                {"law": "cycloidal", "over": "0.5 s", "by": half},
                {"law": "dwell", "over": "0.1 s"},
                {"law": "spline", "through": [[0.1, 0.1 * half], [0.2, 0.2 * half]]}
                if False
                else {"law": "3-4-5", "over": "0.4 s", "by": half},
            ]
        else:
            which["law"] = f"{which.get('begin', 0)} + {span}*t"
            which["to"] = 1
    if len(inputs) > 1:
        inputs[-1].update({"from": 0, "to": 1, "step": 1 / _ROWS})


def _span(which: Data) -> float:
    ends = which.get("from", 0), which.get("to", 30)
    if any(isinstance(end, str) for end in ends):
        return 1.0
    return float(min(max(ends[1] - ends[0], -30.0), 30.0)) or 10.0


def _no_points(data: Data) -> None:
    for table in ("points", "trace"):
        data.pop(table, None)
    if "loops" in data or "equations" in data:
        for table in ("links", "masses", "loads", "stops"):
            data.pop(table, None)


def _nothing_to_show(data: Data) -> None:
    for table in ("trace", "outputs", "questions", "name", "purpose", "source", "family"):
        data.pop(table, None)


def _as_it_is(_: Data) -> None:
    """Only fewer rows."""


#: What is changed in a mechanism's file.
VARIANTS: dict[str, Callable[[Data], None]] = {
    "as it is": _as_it_is,
    "no unknowns": _no_unknowns,
    "one row": _one_row,
    "two inputs": _two_inputs,
    "laws": _laws,
    "no points": _no_points,
    "nothing to show": _nothing_to_show,
}
_MECHANISMS = tuple(lw.examples())


def variant_text(name: str, variant: str, loaded: bool) -> str:
    """The file of a library mechanism, coarse and changed; ``loaded``: with masses and a force."""
    data = tomllib.loads(lw.example_text(name))
    for which in _inputs(data):
        _coarsen(which, data)
    VARIANTS[variant](data)
    if loaded and "equations" not in data:
        _load(data)
    return tomlkit.dumps(data)


def _load(data: Data) -> None:
    """Masses for all links that have none."""
    masses = data.setdefault("masses", {})
    for link, points in data.get("links", {}).items():
        if link == "ground" or link in masses:
            continue
        masses[link] = {"mass": 1.5, "shape": "rod"} if len(points) > 1 else {"mass": 1.5}
    data["length"] = "mm"


def _coarsen(which: Data, data: Data) -> None:
    """A table of few rows."""
    numbers = [which.get(key) for key in ("from", "to")]
    if all(isinstance(n, int | float) for n in numbers) and numbers[0] != numbers[1]:
        which["step"] = (numbers[1] - numbers[0]) / (_ROWS - 1)
    elif "law" not in which and "step" not in which and "link" in which and "from" not in which:
        turn = 6.283185307179586 if data.get("angle") == "rad" else 360.0
        which.update({"from": 0, "to": turn, "step": turn / (_ROWS - 1)})


def _quantities(text: str) -> tuple[list[str], list[str]]:
    """Columns and numbers of a whole motion to ask for."""
    with contextlib.suppress(Exception):
        mechanism = lw.loads(text)
        motion = mechanism.model.motion_quantities
        names = [*motion.names.inputs, *motion.names.unknowns, *motion.names.outputs]
        points = [f"{p}.x" for p in motion.names.points[-1:]]
        rates = [f"{n}.velocity" for n in names[:1]]
        return [*names[:2], *names[-1:], *points, *rates], [f"max({n})" for n in (names[-1:] + points)]
    return [], []


def commands_of(text: str) -> Iterator[list[str]]:
    """The commands for a file ``m.toml``, with every option that writes or shows something."""
    columns, numbers = _quantities(text)
    links = [*tomllib.loads(text).get("links", {})]
    points = [*tomllib.loads(text).get("points", {})]
    inputs = [which.get("link") or which.get("variable") or which.get("slider") or which.get("cylinder") or which.get("joint") or "" for which in _inputs(tomllib.loads(text))]
    at = [part for name in inputs for part in ("--at", f"{name}=20" if len(inputs) > 1 else "20")]
    shown = [*columns, *numbers]
    yield from (["check"], ["check", "--json"], ["quantities"], ["quantities", "--json"])
    yield from (["equations", *o] for o in ([], ["--json"], ["--latex"], ["--derivation"]))
    yield from (["solve", *o] for o in ([], ["--json"], ["--show-steps", "--from-guess"], at))
    yield ["sweep"]
    yield ["sweep", "--json", "--csv", "a.csv", "--xlsx", "a.xlsx", "--draw", "a.svg", "--plot", "b.svg"]
    yield ["sweep", "--through", "--change-points", "turn", "--no-certificates", "--csv", "-"]
    for name in shown:
        yield ["sweep", "--columns", name, "--plot", "c.svg"]
    for name in columns[-3:]:
        yield ["sweep", "--limits-of", name]
    yield from (["configurations", *o] for o in ([], ["--json"], ["--draw", "d.svg"]))
    yield from (["circuits", *o] for o in ([], ["--json", "--no-certificates"], ["--draw", "e.svg"]))
    yield ["forces"]
    yield ["forces", "--json", "--csv", "f.csv", "--draw", "f.svg", "--plot", "g.svg"]
    yield ["forces", *(at or ["--at", "20"])]
    yield ["simulate", "--until", "0.01", "--step", "0.005"]
    yield ["simulate", "--until", "0.01", "--step", "0.005", "--json", "--csv", "h.csv", "--plot", "h.svg"]
    yield ["simulate", "--equilibria"]
    for name in shown[-3:]:
        yield ["sensitivity", "--of", name]
        yield ["sensitivity", "--of", name, "--json", *at]
        yield ["tolerance", "--of", name, "--samples", "3"]
    yield ["design", "--flywheel", "0.1"]
    yield ["design", "--motor", "200", "120 rpm"]
    for name in columns[-1:]:
        yield ["design", "--harmonics", name, "--count", "3"]
    yield ["design", "--counterweights", "30"]
    for link in links[-1:]:
        yield ["design", "--inflection", link, *at]
    yield ["draw", "-o", "i.svg"]
    yield ["draw", "-o", "i.tikz", "--vectors", "--velocities", "--accelerations", "--dimensions"]
    yield ["draw", "-o", "i.svg", "--centres", "--speed", "--link-names", "--dimensions"]
    for link in links[-1:]:
        yield ["draw", "-o", "i.svg", "--centrodes", link]
    for point in points[-1:]:
        yield ["draw", "-o", "i.svg", "--force", f"{point}=1,2 N", "--trace", point]
    for kind in ("curves", "polar", "path", "hodograph", "transmission", "circuits", "branches"):
        yield ["plot", "-o", "j.svg", "--kind", kind]
    yield ["plot", "-o", "j.tikz", "--against", "time"]
    for name in columns[-1:]:
        yield ["plot", "-o", "j.svg", "--of", name, "--against", columns[0], "--wrapped"]
    yield from (["animate", "-o", "k.html", *o] for o in ([], ["--all"]))
    yield ["animate", "-o", "k.gif", "--rows", "2"]
    yield from (["code", "-o", f"l.{kind}"] for kind in ("py", "m", "c", "js", "st"))
    yield from (["export", "--as", kind] for kind in ("pmks", "pylinkage", "pyslvs"))
    yield from (["robot", "-o", f"n.{kind}"] for kind in ("mjcf", "urdf", "sdf"))
    yield from (["report", "-o", f"o.{kind}"] for kind in ("html", "docx", "md"))
    yield ["report", "-o", "o.pdf", "--template", "student"]
    yield ["plates", "-o", "q.dxf", "--layout", "--labels", "--bill", "q.csv"]
    yield from (["plates", "-o", f"q.{kind}"] for kind in ("svg", "stl", "3mf", "step"))
    yield from (["link", *o] for o in ([], ["--embed"], ["--text", "--json"], ["--qr", "r.svg"]))
    for name in columns[-1:]:
        (Path("plan.toml")).write_text(
            'format = 1\nmechanism = "m.toml"\nsampling = "random"\ncount = 3\nseed = 1\n'
            f'keep = [{json.dumps(name)}]\n[dimensions]\n' + _varied(text), encoding="utf-8"
        )
        yield ["study", "plan.toml", "-o", "s.zarr", "--fresh", "--quiet", "--workers", "1"]


def _varied(text: str) -> str:
    data = tomllib.loads(text)
    for table in ("dimensions", "lengths"):
        for name, value in data.get(table, {}).items():
            if isinstance(value, int | float):
                return f"{json.dumps(name)} = {{ from = {value}, to = {1.001 * value} }}\n"
    return ""


class _Watch:
    """How long commands take outside their bars of progress."""

    def __init__(self) -> None:
        self.shown = 0.0

    @contextmanager
    def progress(self, label: str) -> Iterator[Callable[[float], None]]:
        begin = perf_counter()
        try:
            yield lambda fraction: None
        finally:
            self.shown += perf_counter() - begin

    def patches(self) -> Iterator[Any]:
        for name in program._COMMANDS:
            module = import_module(f"linkwork.cli.{'import_' if name == 'import' else name}")
            if hasattr(module, "progress"):
                yield patch.object(module, "progress", self.progress)
        yield patch.object(import_module("linkwork.cli.picture"), "progress", self.progress)
        shown = contextlib.contextmanager(self._study)
        yield patch.object(import_module("linkwork.cli.study"), "study_progress", shown)

    def _study(self, quiet: bool) -> Iterator[Callable[[object], None]]:
        with self.progress("study"):
            yield lambda progress: None


def command_campaign(part: int) -> tuple[Counter[str], list[str]]:
    """Counts of exit codes and internal errors of one mechanism and variant."""
    name = _MECHANISMS[part // len(VARIANTS) % len(_MECHANISMS)]
    variant = [*VARIANTS][part % len(VARIANTS)]
    return variant_commands(name, variant, loaded=part % 2 == 0)


def variant_commands(
    name: str, variant: str, loaded: bool, seen: Callable[[str], None] = lambda line: None,
    only: Sequence[str] = ()
) -> tuple[Counter[str], list[str]]:
    witness, watch = Witness(), _Watch()
    text = variant_text(name, variant, loaded)
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        stack.enter_context(contextlib.chdir(folder))
        stack.enter_context(warnings.catch_warnings())
        warnings.simplefilter("error")
        for each in watch.patches():
            stack.enter_context(each)
        Path("m.toml").write_text(text, encoding="utf-8")
        for arguments in commands_of(text):
            if only and arguments[0] not in only:
                continue
            _tried(witness, watch, arguments, f"{name}, {variant}{', loaded' * loaded}", seen)
        if not only:
            _opened(witness, Path("m.toml"), f"{name}, {variant}")
    return witness.counts, witness.false


def _tried(witness: Witness, watch: _Watch, arguments: list[str], of: str, seen: Any) -> None:
    command, *options = arguments
    file = [] if command == "study" else ["m.toml"]
    typed = [command, *file, *options]
    begin, watch.shown = perf_counter(), 0.0
    ended = CliRunner().invoke(program.linkwork, typed)
    spent = perf_counter() - begin
    what = f"{of}: {shlex.join(typed)}"
    seen(f"{ended.exit_code} {spent:5.2f} s ({spent - watch.shown:.2f}) {what} {ended.output.strip().splitlines()[:1] if ended.exit_code else ''}")
    witness.counts[f"commands that end with exit code {ended.exit_code}"] += 1
    if spent - watch.shown > _PATIENCE:
        witness.counts["commands over 2 s without progress"] += 1
        witness.false.append(f"{what}: {spent - watch.shown:.1f} s without progress")
    if ended.exit_code not in (0, 1, 2) or not isinstance(ended.exception, SystemExit | None):
        witness.counts["internal errors"] += 1
        witness.false.append(f"{what}: {ended.output[-400:]!r} {ended.exception!r}")
    elif ended.exit_code:
        witness.judge_message(what, ended.output)


def _opened(witness: Witness, path: Path, of: str) -> None:
    """The mechanism in the live page."""
    bench = witness.call(f"{of}: view", lambda: Bench(MechanismFile(path), lw.loads, solve_task), 30)
    if bench is not None:
        witness.call(f"{of}: view", bench.opened, 30)


def main(arguments: list[str]) -> None:
    name, variant, *rest = arguments
    loaded = "loaded" in rest
    only = [r for r in rest if r != "loaded"]
    counts, false = variant_commands(name, variant, loaded, print, only)
    print(*counts.items(), *false, sep="\n")


if __name__ == "__main__":
    main(sys.argv[1:])
