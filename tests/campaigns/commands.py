"""Every command on every library mechanism: as it is, without unknowns, of one row, with two
inputs, with laws, without points, and with nothing to show.

``python -m tests.campaigns.commands four-bar "one row"`` repeats the commands of one variant.
"""

from __future__ import annotations

import contextlib
import json
import shlex
import sys
import tempfile
import tomllib
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from time import process_time
from typing import Any
from unittest.mock import patch

from click.testing import CliRunner

import linkwork as lw
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.session import Bench
from linkwork.core.commands.main import linkwork as program
from linkwork.synthesis.solvers.solving import solve_task
from linkwork.wings import WINGS
from tests.campaigns.command_variants import MECHANISMS, VARIANTS, inputs_of, variant_text
from tests.campaigns.fuzzing.witness import LIMIT, SHOWS_PROGRESS, Witness

__all__ = ["PARTS", "command_campaign"]

PARTS = len(MECHANISMS) * len(VARIANTS)

#: NAME is every column asked for, LAST the last one, LINK and POINT are the last ones of the file,
#: AT is a position. FILE is written after the command.
_COMMANDS = """
check | check --json | quantities | quantities --json
equations | equations --json | equations --latex | equations --derivation
solve | solve --json | solve --show-steps --from-guess | solve AT
sweep | sweep --json --csv a.csv --xlsx a.xlsx --draw a.svg --plot b.svg
sweep --through --change-points turn --no-certificates --csv -
sweep --columns NAME --plot a.svg | sweep --limits-of LAST
configurations | configurations --json | configurations --draw a.svg
circuits | circuits --json --no-certificates | circuits --draw a.svg
forces | forces --json --csv a.csv --draw a.svg --plot b.svg | forces AT
simulate --until 0.01 --step 0.005
simulate --until 0.01 --step 0.005 --json --csv a.csv --plot a.svg
simulate --equilibria
sensitivity --of LAST | sensitivity --of LAST --json AT | sensitivity --of max(LAST)
tolerance --of LAST --samples 3 | tolerance --of max(LAST)
design --flywheel 0.1 | design --motor 200 "120 rpm" | design --harmonics LAST --count 3
design --counterweights 30 | design --inflection LINK AT
draw -o a.svg | draw -o a.tikz --vectors --velocities --accelerations --dimensions
draw -o a.svg --centres --speed --link-names --dimensions | draw -o a.svg --centrodes LINK
draw -o a.svg --force "POINT=1,2 N" --trace POINT
plot -o a.svg --kind curves | plot -o a.svg --kind polar | plot -o a.svg --kind path
plot -o a.svg --kind hodograph | plot -o a.svg --kind transmission
plot -o a.svg --kind circuits | plot -o a.svg --kind branches
plot -o a.tikz --against time | plot -o a.svg --of LAST --against LAST --wrapped
animate -o a.html | animate -o a.html --all | animate -o a.gif --rows 2
export -o a.py | export -o a.m | export -o a.c | export -o a.js | export -o a.st
export pmks | export pylinkage | export pyslvs | export -o a.xlsx
export -o a.mjcf | export -o a.urdf | export -o a.sdf
export -o a.html | export -o a.docx | export -o a.md | export -o a.pdf --template student
export -o a.dxf --layout --labels --bill a.csv
export plates -o a.svg | export -o a.stl | export -o a.3mf | export -o a.step
link | link --text --json | link --app https://a.org --embed | link --app https://a.org --qr a.svg
study -o a.zarr --force --quiet --workers 1
"""
_PLAN = """\
format = 1
mechanism = "m.toml"
sampling = "random"
count = 3
seed = 1
keep = [LAST]
[dimensions]
"""


def command_campaign(part: int) -> tuple[Counter[str], list[str]]:
    """Counts of exit codes and false claims about one mechanism and variant."""
    name = MECHANISMS[part // len(VARIANTS) % len(MECHANISMS)]
    return _try_all(name, [*VARIANTS][part % len(VARIANTS)], loaded=part % 2 == 0)


def _try_all(name: str, variant: str, *, loaded: bool) -> tuple[Counter[str], list[str]]:
    witness, watch = Witness(), _Watch()
    text = variant_text(name, variant, loaded=loaded)
    of = f"{name}, {variant}{', loaded' * loaded}"
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        stack.enter_context(contextlib.chdir(folder))
        stack.enter_context(warnings.catch_warnings())
        warnings.simplefilter("error")
        for each in watch.patches():
            stack.enter_context(each)
        Path("m.toml").write_text(text, encoding="utf-8")
        for typed in _commands_for(text):
            _try(witness, watch, typed, of)
        page = MechanismFile(Path("m.toml"))
        bench = witness.call(f"{of}: view", lambda: Bench(page, lw.loads, solve_task))
        if bench is not None:
            witness.call(f"{of}: view", bench.opened, SHOWS_PROGRESS)
    return witness.counts, witness.false


def _commands_for(text: str) -> Iterator[list[str]]:
    """The commands for the file ``m.toml``; of one that is refused only the first few."""
    data = tomllib.loads(text)
    commands = [each.strip() for line in _COMMANDS.splitlines() for each in line.split("|")]
    try:
        columns = _columns(lw.loads(text))
    except lw.LinkworkError:
        columns, commands = [], commands[:4]
    for name in columns[-1:]:
        plan = _PLAN.replace("LAST", json.dumps(name)) + _varied(data)
        Path("plan.toml").write_text(plan, encoding="utf-8")
    places = [_place(which, len(inputs_of(data)) > 1) for which in inputs_of(data)]
    known = {
        "NAME": columns,
        "LAST": columns[-1:],
        "LINK": [*data.get("links", {})][-1:],
        "POINT": [*data.get("points", {})][-1:],
        "AT": [" ".join(f"--at {place}" for place in places or ["20"])],
    }
    for command in filter(None, commands):
        for filled in _filled(command, known):
            words = shlex.split(filled)
            named = next((k for k, word in enumerate(words) if word[:1] == "-"), len(words))
            file = "plan.toml" if words[0] == "study" else "m.toml"
            yield [*words[:named], file, *words[named:]]


def _filled(command: str, known: dict[str, list[str]]) -> Iterator[str]:
    for word, names in known.items():
        if word in command:
            for name in names:
                own = name if word == "AT" or '"' in command else shlex.quote(name)
                yield from _filled(command.replace(word, own), known)
            return
    yield command


def _columns(mechanism: lw.Mechanism) -> list[str]:
    names = mechanism.model.motion_quantities.names
    found = [*names.inputs, *names.unknowns, *names.outputs]
    points = [f"{point}.x" for point in names.points[-1:]]
    return [*found[:1], *(f"{name}.velocity" for name in found[:1]), *found[-1:], *points]


def _place(which: dict[str, Any], several: bool) -> str:
    kinds = ("link", "joint", "slider", "cylinder", "variable")
    name = next((which[kind] for kind in kinds if kind in which), "")
    return shlex.quote(f"{name}=20") if several else "20"


def _varied(data: dict[str, Any]) -> str:
    numbers = {**data.get("dimensions", {}), **data.get("lengths", {})}
    for name, value in numbers.items():
        if isinstance(value, int | float):
            return f"{json.dumps(name)} = {{ from = {value}, to = {1.001 * value} }}\n"
    return ""


class _Watch:
    """How long commands show their progress [s of the processor]."""

    shown = 0.0

    @contextmanager
    def progress(self, _: object) -> Iterator[Callable[[object], None]]:
        begin = process_time()
        try:
            yield lambda fraction: None
        finally:
            self.shown += process_time() - begin

    def patches(self) -> Iterator[Any]:
        core = [f"linkwork.core.commands.{name}" for name in ("check", "files", "solve", "sweep")]
        others = [f"{wing.module}.commands" for wing in WINGS[1:] if wing.commands]
        for module in map(import_module, [*core, *others]):
            for bar in ("progress", "study_progress"):
                if hasattr(module, bar):
                    yield patch.object(module, bar, self.progress)


def _try(witness: Witness, watch: _Watch, typed: list[str], of: str) -> None:
    begin, watch.shown = process_time(), 0.0
    ended = CliRunner().invoke(program, typed)
    silent = process_time() - begin - watch.shown
    what = f"{of}: {shlex.join(typed)}"
    witness.counts[f"commands with exit code {ended.exit_code}"] += 1
    if silent > LIMIT:
        witness.counts["commands over 2 s without progress"] += 1
        witness.false.append(f"{what}: {silent:.1f} s without progress")
    if ended.exit_code not in (0, 1, 2) or not isinstance(ended.exception, SystemExit | None):
        witness.counts["internal errors"] += 1
        witness.false.append(f"{what}: {ended.output[-300:]!r} {ended.exception!r}")
    elif "No such command" in ended.output:
        witness.false.append(f"{what}: no such command")
    elif ended.exit_code:
        witness.judge_message(what, ended.output)


def main(arguments: list[str]) -> None:
    """Repeat the commands of one mechanism and variant, without and with masses."""
    name, variant = arguments
    for loaded in (False, True):
        counts, false = _try_all(name, variant, loaded=loaded)
        lines = [*map(str, counts.items()), *false]
        sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
