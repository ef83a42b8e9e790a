"""Commands on synthesis."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable
from dataclasses import replace
from pathlib import Path

import click

from linkwork.core.commands.options import check_outputs, text_of_source
from linkwork.core.commands.terminal import (
    answer_interrupt,
    bad,
    debug_option,
    fields,
    good,
    json_option,
    print_json,
    print_lines,
    progress,
    sentence,
    table_lines,
    title_lines,
    wrapped,
)
from linkwork.core.foundation.errors import InputError, MechanismError, MechanismFileError
from linkwork.core.foundation.files import OwnFiles, as_path
from linkwork.core.results.listing import Column, rounded_down, significant
from linkwork.core.textfile.writer import save
from linkwork.synthesis.atlas import NearPath, PathAtlas
from linkwork.synthesis.defects.verdicts import DefectKind, JudgedDesign
from linkwork.synthesis.designs_folder import (
    FolderOptions,
    check_folder,
    keeps_earlier,
    synthesis_facts,
    task_copy,
    write_designs,
)
from linkwork.synthesis.solvers.result import Synthesis, front_of, goal_misses
from linkwork.synthesis.solvers.solving import advice_of, remarks_on
from linkwork.synthesis.task_objects import Task
from linkwork.synthesis.tasks.conditions import read_curve

# ----------------------------------------------------------------------
# A synthesis as a page of text: counts, defects by kind, dyads and delivered designs.


_DIGITS = 5
_MOST_DYADS = 8
_MOST_REASONS = 5


def synthesis_lines(synthesis: Synthesis) -> list[str]:
    """The page of a synthesis."""
    lines = [*title_lines(synthesis.task.name), *fields(synthesis_facts(synthesis))]
    if synthesis.dyads and len(synthesis.dyads) <= _MOST_DYADS:
        lines += ["", *_dyad_lines(synthesis)]
    if synthesis.delivered:
        lines += ["", *_design_lines(synthesis)]
    lines += ["", *_verdict(synthesis)]
    return lines


def _numbers(header: str, values: Iterable[float], digits: int = _DIGITS) -> Column:
    return Column(header=header, cells=[significant(v, digits) for v in values], align="point")


def _dyad_lines(synthesis: Synthesis) -> list[str]:
    """The dyads: kind, pivots, proof."""
    dyads, unit, digits = synthesis.dyads, synthesis.task.length, _DIGITS + 1
    return table_lines(
        [
            Column(header="dyad", cells=[dyad.kind for dyad in dyads]),
            _numbers(f"moving x [{unit}]", [dyad.moving[0] for dyad in dyads], digits),
            _numbers("y", [dyad.moving[1] for dyad in dyads], digits),
            _numbers(f"fixed x [{unit}]", [dyad.fixed[0] for dyad in dyads], digits),
            _numbers("y", [dyad.fixed[1] for dyad in dyads], digits),
            Column(header="", cells=["proved" if dyad.proved else "not proved" for dyad in dyads]),
        ]
    )


def _design_lines(synthesis: Synthesis) -> list[str]:
    """The delivered designs, best first."""
    designs, task = synthesis.delivered, synthesis.task
    front = front_of(synthesis)

    columns = [
        Column(header="", cells=[str(design.number) for design in designs], align="right"),
        *(_numbers(f"goal {k}", misses) for k, misses in enumerate(front.values(), start=1)),
    ]
    if not front:
        columns.append(Column(header="mechanism", cells=[d.mechanism for d in designs]))
        if not synthesis.starts:  # fits are all driven at one link
            columns.append(Column(header="driven at", cells=[d.driven for d in designs]))
    least = [rounded_down(design.transmission, _DIGITS) for design in designs]
    columns += [
        _numbers(f"transmission [{task.angle.value}]", least),
        _numbers(f"size [{task.length}]", [design.size for design in designs]),
    ]
    if front:
        legend = [f"goal {k}: the miss of {name}" for k, name in enumerate(front, start=1)]
        return [*table_lines(columns), "", *(line for text in legend for line in wrapped(text))]
    if any(design.error for design in designs):
        error = f"error [{synthesis.error_unit}]" if synthesis.error_unit else "error"
        columns.append(_numbers(error, [d.error for d in designs]))
    columns.append(_numbers("score", [design.score for design in designs]))
    return [*table_lines(columns), *_miss_lines(synthesis)]


def _miss_lines(synthesis: Synthesis) -> list[str]:
    """How far the best design misses each goal, if there are several."""
    misses = goal_misses(synthesis.delivered[:1])
    if len(misses) < 2:
        return []
    rows = [(name, significant(values[0], _DIGITS)) for name, values in misses.items()]
    return ["", *wrapped("Design 1 misses its goals by"), *fields(rows)]


def _verdict(result: Synthesis) -> list[str]:
    """Lines that say whether a design is sound; if not, the commonest defects and a change."""
    if result.delivered:
        have = "has" if result.sound == 1 else "have"
        lines = sentence(good, f"{result.sound} of {len(result.designs)} designs {have} no defect.")
        return [*lines, *(line for text in remarks_on(result) for line in wrapped(text))]
    explanation = advice_of(result)
    advice = wrapped(explanation) if explanation else []
    if not result.designs:
        head = "No mechanism of the wanted kinds solves the task."
        if result.task.kind == "improve":
            head = "No start leads to a design."
        return [*sentence(bad, head), *advice]
    lines = sentence(bad, "No design is free of defects.")
    cost = result.most_restrictive
    if cost is not None:
        wish, count = cost
        first = f"The requirement that rejects the most designs is {wish}:"
        lines += wrapped(f"{first} without it {count} would be sound.")
    lines += advice
    shown = _examples(result)
    for design in shown:
        reason = f"{design.mechanism} driven at {design.driven}: "
        lines += wrapped(reason + design.defects[0].message, "  ", "    ")
    more = len(result.refused) - len(shown)
    if more > 0:
        lines += wrapped(f"and {more} more; --json lists all reasons", "  ")
    return lines


def _examples(synthesis: Synthesis) -> list[JudgedDesign]:
    """All refused designs if they are few, else one for each kind of first defect."""
    if len(synthesis.refused) <= _MOST_REASONS:
        return list(synthesis.refused)
    first: dict[DefectKind, JudgedDesign] = {}
    for design in synthesis.refused:
        first.setdefault(design.kinds[0], design)
    return list(first.values())


# ----------------------------------------------------------------------
# ``linkwork synthesize``


@click.command("synthesize")
@click.argument("task", metavar="TASK")
@click.option("-o", "--output", metavar="FOLDER", help="Folder for the designs.")
@click.option("--all", "refused", is_flag=True, help="Write refused designs to FOLDER/refused.")
@click.option("--draw", is_flag=True, help="Draw every written design (SVG).")
@click.option("--csv", is_flag=True, help="Write a table of all designs: FOLDER/designs.csv.")
@click.option("--html", is_flag=True, help="Write a page of all designs: FOLDER/index.html.")
@click.option("--force", is_flag=True, help="Replace the files of an earlier synthesis.")
@json_option
@debug_option
@click.pass_context
def synthesize_command(
    context: click.Context,
    /,
    task: str,
    output: str | None,
    as_json: bool,
    **flags: bool,
) -> None:
    """Find mechanisms for a task: poses, points, a curve or a function.

    Every solution is listed. Designs that change branch or circuit, pass the
    positions out of order or break a requirement are rejected, with the reason.
    The others are written as mechanism files, best first.

    \b
      linkwork synthesize five-poses   (a task to begin with)
      linkwork synthesize task.toml
      linkwork synthesize task.toml -o designs --draw --html
      linkwork synthesize task.toml -o designs --all --json
    """
    options = FolderOptions(**flags)
    if output is None and any(flags.values()):
        raise InputError("--all, --draw, --csv, --html and --force need a folder: add -o FOLDER")
    # a task in a file finds the files that it names beside it
    loaded = Task.load(task) if os.path.exists(task) else Task.loads(*text_of_source(task))
    if output is not None:
        earlier = check_folder(as_path(output), options, loaded.described)
    try:
        with progress("solving the task") as tell:
            synthesis = loaded.solve(progress=tell)
    except KeyboardInterrupt:
        raise KeyboardInterrupt("before there was a design") from None
    if synthesis.interrupted:
        answer_interrupt()
    if not synthesis.sound:
        try:
            with progress("trying changes of the task"):
                advice_of(synthesis)  # which is kept
        except KeyboardInterrupt:
            synthesis = replace(synthesis, what_helps=str)
            answer_interrupt()
    files: dict[int, str] = {}
    if output is not None:
        with progress("writing designs") as tell:
            files = write_designs(synthesis, output, options, tell, earlier)
    if as_json:
        advice = {"remarks": list(remarks_on(synthesis)), "advice": advice_of(synthesis)}
        print_json({**synthesis.to_dict(files), **advice})
    else:
        lines = synthesis_lines(synthesis)
        if output is not None:
            count = f"{len(files)} design{'' if len(files) == 1 else 's'}"
            written = [count, *task_copy(synthesis.task).files]
            message = f"Wrote {', '.join(written[:-1])} and {written[-1]} in {output}."
            if keeps_earlier(synthesis, earlier):
                message = f"Wrote nothing: {output} keeps its earlier designs and their task."
            lines += ["", *wrapped(message)]
        print_lines(lines)
    if not synthesis.delivered:
        context.exit(1)


# ----------------------------------------------------------------------
# ``linkwork atlas``


_SHOWN = 20
_OWN = OwnFiles(run="search", files=re.compile(r"near-\d+\.toml", re.IGNORECASE))


@click.command("atlas")
@click.argument("sources", metavar="CURVE", nargs=-1)
@click.option("-o", "--output", metavar="PATH", help="Folder for mechanisms; with --index a file.")
@click.option("--atlas", "file", metavar="FILE", help="Another atlas than the shipped one.")
@click.option("--count", type=int, help="Mechanisms to find. Default: 100.")
@click.option("--force", is_flag=True, help="Replace the files of an earlier search.")
@click.option("--index", is_flag=True, help="Make an atlas of the stores of studies.")
@json_option
@debug_option
def atlas_command(
    sources: tuple[str, ...],
    output: str | None,
    file: str | None,
    count: int | None,
    force: bool,
    index: bool,
    as_json: bool,
) -> None:
    """Find mechanisms whose paths resemble a closed curve (CSV: x, y).

    Place, size, direction and timing do not count. With -o the mechanisms are
    written as files, placed on the curve: starts for improvement. An atlas is
    made of studies that keep the path of a point over a whole turn.

    \b
      linkwork atlas curve.csv
      linkwork atlas curve.csv --count 20 -o near
      linkwork atlas --index four-bar.zarr stephenson.zarr -o mine.npz
      linkwork atlas curve.csv --atlas mine.npz
    """
    if index:
        if force or (file, count) != (None, None):
            raise InputError("--index makes an atlas: leave out --atlas, --count and --force")
        _index(sources, output, as_json)
        return
    if len(sources) != 1:
        raise InputError("give one curve:\n    linkwork atlas curve.csv")
    try:
        curve = read_curve({"file": sources[0]}, None)
    except MechanismFileError:
        raise
    except MechanismError as error:  # there is no task that names the file
        raise InputError(error.problems[0].message) from None
    earlier = () if output is None else _OWN.check(as_path(output), force)
    with progress("comparing paths"):
        atlas = PathAtlas.shipped() if file is None else PathAtlas.load(file)
        near = atlas.nearest(curve.points, 100 if count is None else count)
    files: list[str] = []
    if output is not None:
        files = _write(near, as_path(output), earlier)
    if as_json:
        print_json({"paths": len(atlas), "nearest": [_data(n, files) for n in near]})
        return
    title = f"{len(near)} of {len(atlas)} paths near {sources[0]}"
    lines = [*title_lines(title), *_path_rows(near)]
    if files:
        lines += ["", *wrapped(f"Wrote {len(files)} mechanisms in {output}.")]
    print_lines(lines)


def _index(stores: tuple[str, ...], output: str | None, as_json: bool) -> None:
    if not stores or output is None:
        raise InputError(
            "--index needs stores and a file:\n    linkwork atlas --index four-bar.zarr -o mine.npz"
        )
    check_outputs("-", output)
    with progress("reading paths") as tell:
        made = PathAtlas.of_stores(stores, tell)
    made.save(output)
    if as_json:
        print_json({"paths": len(made), "file": output, "unfinished": list(made.unfinished)})
        return
    count = len({as_path(store).resolve() for store in stores})
    shown = "1 store" if count == 1 else f"{count} stores"
    print_lines(wrapped(f"Wrote {len(made):,} paths of {shown} to {output}."))
    for problem in made.unfinished:
        print_lines(wrapped(f"{problem}. Finish it and repeat this command for the others."))


def _write(paths: tuple[NearPath, ...], folder: Path, earlier: Collection[str]) -> list[str]:
    digits, files = len(str(len(paths))), []
    with progress("writing mechanisms") as tell, _OWN.written(folder, earlier) as part:
        for near in paths:
            name = f"near-{near.number:0{digits}}.toml"
            save(near.mechanism.description, part / name)
            files.append(str(folder / name))
            tell(near.number / len(paths))
    return files


def _data(near: NearPath, files: list[str]) -> dict[str, object]:
    return {
        "distance": near.distance,
        "mechanism": near.family,
        "mirrored": near.is_mirrored,
        "numbers": near.numbers,
        "file": files[near.number - 1] if files else None,
    }


def _path_rows(paths: tuple[NearPath, ...]) -> list[str]:
    """The nearest ones."""
    shown = paths[:_SHOWN]
    lines = table_lines(
        [
            Column(header="", cells=[str(near.number) for near in shown], align="right"),
            _numbers("distance", [near.distance for near in shown], 3),
            Column(header="mechanism", cells=[near.family for near in shown]),
            Column(header="", cells=["mirrored" if n.is_mirrored else "" for n in shown]),
        ]
    )
    more = len(paths) - len(shown)
    return lines + (wrapped(f"and {more} more; --json lists all", "  ") if more else [])
