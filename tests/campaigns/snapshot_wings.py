"""Records beyond positions: forces, motion in time, synthesis, studies, files, pages.

Kinds by name, as in ``forces four-bar`` or ``synthesis 17``. Of texts and pages only the numbers
are recorded, in their order: words and layout may change.
"""

from __future__ import annotations

import dataclasses
import io
import re
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import linkwork as lw
from linkwork.app.pages.page_building import motion_page
from linkwork.core.mechanism.linkage import Linkage
from linkwork.families.study import run_study
from linkwork.families.study.plan import read_plan_text
from linkwork.synthesis.tasks.templates import template_names, template_text
from tests.campaigns.snapshot import Record, attempt, record_of

__all__ = ["record_of_any", "wing_names"]

_SIMULATIONS, _SYNTHESES, _EXPORTS = 200, 60, 30
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_PROGRAMS = (".py", ".m", ".c", ".js", ".st")
_ROBOTS = (".mjcf", ".sdf", ".urdf")
_PLATES = (".dxf", ".svg", ".stl", ".3mf")
_FOREIGN = ("pmks", "pylinkage", "pyslvs")
_PLAN = """format = 1
mechanism = "four-bar"
sampling = "random"
count = 200
seed = 3
[dimensions]
"O2 A" = { mean = 40, deviation = 1 }
"A B" = { from = 110, to = 130 }
[input]
from = 0
to = 360
step = 30
[reductions]
swing = "stroke(rocker)"
least = "min(mu)"
[filters]
cycle = "whole cycle"
"""


def wing_names() -> tuple[str, ...]:
    """All names, the library's first."""
    library = sorted(lw.examples())
    chosen = library[:: max(1, len(library) // _EXPORTS)][:_EXPORTS]
    return (
        *(f"forces {name}" for name in library),
        *(f"simulation {k}" for k in range(_SIMULATIONS)),
        *(f"synthesis {k}" for k in range(_SYNTHESES)),
        "study 0",
        *(f"files {name}" for name in chosen),
        *(f"page {name}" for name in library),
    )


def record_of_any(name: str) -> Record:
    """What is recorded under a name of this module, or of a mechanism."""
    record, (kind, _, which) = Record(name), name.partition(" ")
    if kind not in _KINDS:
        return record_of(name)
    _KINDS[kind](record, which)
    return record


# ------------------------------------------------------------------ forces and time


def _loaded(name: str, number: int = 0) -> lw.Mechanism:
    """A library mechanism with weight; as it is if it has masses, or no links."""
    mechanism = lw.example(name)
    linkage = mechanism.description
    if not isinstance(linkage, Linkage) or linkage.masses:
        return mechanism
    rng = np.random.default_rng([40, number, *name.encode()])
    places = mechanism.solve().points.values()
    size = float(np.ptp([z for place in places for z in place])) or 1.0
    masses = {
        link: lw.Mass(
            mass=rng.uniform(0.5, 2.0),
            center=tuple(rng.uniform(-0.2, 0.2, 2) * size * (len(linkage.links[link]) > 1)),
            inertia=rng.uniform(0.05, 0.2) * size**2,
        )
        for link in linkage.links
        if link != "ground"
    }
    return mechanism.changed(masses=masses, gravity=lw.Gravity(size="9.81 m/s^2"))


def _forces(record: Record, name: str) -> None:
    found = attempt(record, "forces", lambda: _loaded(name).forces())
    if found is not None:
        columns = sorted(found.values)
        record.say("forces.names.column", columns)
        record.note(
            "forces.numbers.value", np.stack([found.values[key] for key in columns], axis=-1)
        )


def _simulation(record: Record, which: str) -> None:
    library = sorted(lw.examples())
    name, number = library[int(which) % len(library)], int(which)
    rng = np.random.default_rng([41, number])
    turning = rng.uniform(-3.0, 3.0)
    until = rng.uniform(0.05, 0.4)

    def simulated() -> lw.Motion:
        mechanism = _loaded(name, number)
        inputs = mechanism.model.equations.inputs
        speed = {n.name: turning * (k + 1) for k, n in enumerate(inputs)}
        return mechanism.simulate(until, step=until / 20, start_speed=speed)

    found = attempt(record, "simulation", simulated)
    if found is None:
        return
    record.say("simulation.status.name", [status.name for status in found.status])
    record.say("simulation.certified.flag", found.certified.tolist())
    columns = [*found.inputs, *found.unknowns]
    record.say("simulation.names.column", columns)
    record.note("simulation.numbers.value", np.stack([found[c] for c in columns], axis=-1))


# ------------------------------------------------------------------ designs


def _random_task(number: int) -> lw.Task:
    rng = np.random.default_rng([42, number])
    names = template_names()
    if number < len(names):
        return lw.Task.loads(template_text(names[number]), names[number])
    kind = number % 4
    if kind == 0:
        poses = [
            (20.0 * k + rng.uniform(-5, 5), rng.uniform(-10, 10), 15.0 * k + rng.uniform(-5, 5))
            for k in range(3 + number // 4 % 3)
        ]
        return lw.Task.motion(poses)
    if kind == 1:
        pairs = [(20.0 * k, 12.0 * k + rng.uniform(-4, 4)) for k in range(1, 4 + number // 4 % 3)]
        return lw.Task.function(pairs)
    if kind == 2:
        ranges = {"x": [1, 2], "input": [30, 120], "output": [20, 90]}
        return lw.Task.function(f"x^{rng.uniform(1.2, 2.0):.3f}", fit="least squares", **ranges)
    angles = np.linspace(0.3, 2.5, 5) + rng.uniform(-0.1, 0.1, 5)
    points = [(60 * float(np.cos(a)), 40 * float(np.sin(a))) for a in angles]
    return lw.Task.path(points)


def _synthesis(record: Record, which: str) -> None:
    found = attempt(record, "synthesis", lambda: _random_task(int(which)).solve())
    if found is None:
        return
    record.say("synthesis.counts.sound", [len(found.delivered)])
    record.say("synthesis.counts.refused", [len(found.refused)])
    record.say("synthesis.defects.kind", [
        "+".join(sorted(defect.kind.name for defect in design.defects)) for design in found.refused
    ])  # fmt: skip
    values = [list(_design_numbers(design)) for design in found.delivered]
    longest = max(map(len, values), default=0)
    table = np.full((len(values), longest), np.nan)
    for row, numbers in zip(table, values, strict=True):
        row[: len(numbers)] = numbers
    record.note("synthesis.numbers.value", table)


def _design_numbers(design: Any) -> Iterator[float]:
    yield from map(float, design.numbers.values())
    if isinstance(design, lw.synthesis.SynthesizedDesign):
        yield from (float(x) for place in design.linkage.points.values() for x in place)


def _study(record: Record, which: str) -> None:
    with tempfile.TemporaryDirectory() as folder:

        def run() -> Any:
            plan = read_plan_text(_PLAN, "plan.toml")
            run_study(plan, Path(folder, "out.zarr"), workers=1)
            import xarray

            return xarray.open_zarr(Path(folder, "out.zarr"), consolidated=False).load()

        found = attempt(record, "study", run)
        if found is not None:
            for name in sorted(map(str, found.variables)):
                values = found[name].values
                if values.dtype.kind in "iufb":
                    record.note(f"study.numbers.{name.replace('.', ' ')}", values.astype(float))


# ------------------------------------------------------------------ files


def _numbers_of(text: str) -> list[float]:
    return [float(number) for number in _NUMBER.findall(text)]


def _files(record: Record, name: str) -> None:
    mechanism = lw.example(name)
    motion = attempt(record, "sweep", lambda: mechanism.sweep(step=30))
    if motion is None:
        return
    with tempfile.TemporaryDirectory() as folder:

        def numbers(suffix: str, write: Callable[[Path], object]) -> list[float]:
            path = Path(folder, f"out{suffix}")
            write(path)
            return _numbers_of(_text_of(path))

        writers: dict[str, Callable[[Path], object]] = {
            **{s: lambda path: mechanism.write(path, motion=motion) for s in _PROGRAMS},
            **{s: lambda path: mechanism.write(path, motion=motion) for s in _ROBOTS},
            **{
                s: lambda path: mechanism.write(path, motion=motion, kind="plates") for s in _PLATES
            },
            ".xlsx": lambda path: mechanism.write(path, motion=motion),
        }
        for suffix, write in writers.items():
            key = suffix.removeprefix(".")
            found = attempt(record, key, partial(numbers, suffix, write))
            if found is not None:
                record.note(f"{key}.numbers.value", found)
        for form in _FOREIGN:
            written = attempt(record, form, partial(lw.readers.exported, mechanism, form))
            if written is not None:
                record.note(f"{form}.numbers.value", _numbers_of(written.text))


def _text_of(path: Path) -> str:
    content = path.read_bytes()
    if not zipfile.is_zipfile(io.BytesIO(content)):
        return content.decode("utf-8", errors="ignore")
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        names = [n for n in sorted(archive.namelist()) if "sheet" in n or n.endswith(".model")]
        return "\n".join(archive.read(n).decode() for n in names)


def _page(record: Record, name: str) -> None:
    found = attempt(record, "page", lambda: motion_page({"": lw.example(name).sweep(step=30)}))
    if found is not None:
        record.note("page.numbers.value", list(_leaves(found)))


def _leaves(value: Any) -> Iterator[float]:
    """All numbers of plain data, in order."""
    if dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            yield from _leaves(getattr(value, field.name))
    elif isinstance(value, dict):
        for part in value.values():
            yield from _leaves(part)
    elif isinstance(value, list | tuple | np.ndarray):
        for part in value:
            yield from _leaves(part)
    elif isinstance(value, bool | int | float | np.number):
        yield float(value)
    elif value is None:
        yield np.nan


_KINDS: dict[str, Callable[[Record, str], None]] = {
    "forces": _forces,
    "simulation": _simulation,
    "synthesis": _synthesis,
    "study": _study,
    "files": _files,
    "page": _page,
}
