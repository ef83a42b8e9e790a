"""Commands on synthesis."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator
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
from linkwork.core.results.listing.motion_listing import Column, rounded_down, significant
from linkwork.core.textfile.writer import save
from linkwork.synthesis.atlas.near_paths import NearPath, PathAtlas
from linkwork.synthesis.defects.verdicts import DefectKind, JudgedDesign
from linkwork.synthesis.designs_folder import (
    FolderOptions,
    check_folder,
    keeps_earlier,
    write_designs,
)
from linkwork.synthesis.solvers.result import Synthesis, front_of, goal_misses
from linkwork.synthesis.solvers.solving import advice_of, remarks_on
from linkwork.synthesis.task_copy import task_copy
from linkwork.synthesis.task_objects import Task
from linkwork.synthesis.tasks.curve_file import read_curve

# ----------------------------------------------------------------------
# A synthesis as a page of text: counts, defects by kind, dyads and delivered designs.


_DIGITS = 5
_MOST_DYADS = 8
_MOST_REASONS = 5


def synthesis_lines(found: Synthesis) -> list[str]:
    """The page of a synthesis."""
    lines = [*title_lines(found.task.name), *fields(_counts(found))]
    if found.dyads and len(found.dyads) <= _MOST_DYADS:
        lines += ["", *_dyad_lines(found)]
    if found.delivered:
        lines += ["", *_design_lines(found)]
    lines += ["", *_verdict(found)]
    return lines


def _counts(found: Synthesis) -> Iterator[tuple[str, str]]:
    if found.starts:
        yield "starts", str(found.starts)
        if not (found.task.improvement and found.task.improvement.front):
            yield "fits", f"{found.real}, different ones"
    else:
        yield "complex", f"{found.complex} solution{'' if found.complex == 1 else 's'}"
        yield "real", str(found.real)
        yield "proved", str(found.proved)
    if found.triples:
        yield "triples", str(found.triples)
    yield "completeness", found.message
    if found.interrupted:
        yield "interrupted", "the designs are the best found until then"
    driven = len(found.designs)
    yield "mechanisms", str(found.linkages)
    each = "one for each link that can be driven"
    if found.starts:
        each = f"driven at {found.designs[0].driven}" if found.designs else "none found"
    yield "designs", f"{driven}, {each}"
    for kind, count in found.defects.items():
        yield kind.value, f"{count}"
    yield "without defects", str(found.sound)
    yield "delivered", str(len(found.delivered))


def _dyad_lines(found: Synthesis) -> list[str]:
    """The dyads: kind, pivots, proof."""
    dyads, unit = found.dyads, found.task.length

    def column(header: str, values: list[float]) -> Column:
        return Column(
            header=header, cells=[significant(v, _DIGITS + 1) for v in values], align="point"
        )

    return table_lines(
        [
            Column(header="dyad", cells=[dyad.kind for dyad in dyads]),
            column(f"moving x [{unit}]", [dyad.moving[0] for dyad in dyads]),
            column("y", [dyad.moving[1] for dyad in dyads]),
            column(f"fixed x [{unit}]", [dyad.fixed[0] for dyad in dyads]),
            column("y", [dyad.fixed[1] for dyad in dyads]),
            Column(header="", cells=["proved" if dyad.proved else "not proved" for dyad in dyads]),
        ]
    )


def _design_lines(found: Synthesis) -> list[str]:
    """The delivered designs, best first."""
    designs, task = found.delivered, found.task
    front = front_of(found)

    def column(header: str, values: list[float]) -> Column:
        return Column(header=header, cells=[significant(v, _DIGITS) for v in values], align="point")

    columns = [
        Column(header="", cells=[str(design.number) for design in designs], align="right"),
        *(column(f"goal {k}", misses) for k, misses in enumerate(front.values(), start=1)),
    ]
    if not front:
        columns.append(Column(header="mechanism", cells=[d.mechanism for d in designs]))
        if not found.starts:  # fits are all driven at one link
            columns.append(Column(header="driven at", cells=[d.driven for d in designs]))
    least = [rounded_down(design.transmission, _DIGITS) for design in designs]
    columns += [
        column(f"transmission [{task.angle.value}]", least),
        column(f"size [{task.length}]", [design.size for design in designs]),
    ]
    if front:
        told = [f"goal {k}: the miss of {name}" for k, name in enumerate(front, start=1)]
        return [*table_lines(columns), "", *(line for text in told for line in wrapped(text))]
    if any(design.error for design in designs):
        columns.append(column(_error(found), [d.error for d in designs]))
    columns.append(column("score", [design.score for design in designs]))
    return [*table_lines(columns), *_miss_lines(found)]


def _miss_lines(found: Synthesis) -> list[str]:
    """How far the best design misses each goal, if there are several."""
    misses = goal_misses(found.delivered[:1])
    if len(misses) < 2:
        return []
    rows = [(name, significant(values[0], _DIGITS)) for name, values in misses.items()]
    return ["", *wrapped("Design 1 misses its goals by"), *fields(rows)]


def _error(found: Synthesis) -> str:
    return f"error [{found.error_unit}]" if found.error_unit else "error"


def _verdict(found: Synthesis) -> list[str]:
    """Whether there is a sound design; if not, the commonest reasons and the costliest wish."""
    if found.delivered:
        have = "has" if found.sound == 1 else "have"
        lines = sentence(good, f"{found.sound} of {len(found.designs)} designs {have} no defect.")
        return [*lines, *(line for text in remarks_on(found) for line in wrapped(text))]
    told = advice_of(found)
    advice = wrapped(told) if told else []
    if not found.designs:
        head = "No mechanism of the wanted kinds solves the task."
        if found.task.kind == "improve":
            head = "No start leads to a design."
        return [*sentence(bad, head), *advice]
    lines = sentence(bad, "No design is free of defects.")
    cost = found.costliest
    if cost is not None:
        wish, count = cost
        told = f"The wish that costs most is {wish}: without it {count} would be sound."
        lines += wrapped(told)
    lines += advice
    shown = _examples(found)
    for design in shown:
        reason = f"{design.mechanism} driven at {design.driven}: "
        lines += wrapped(reason + design.defects[0].message, "  ", "    ")
    more = len(found.refused) - len(shown)
    if more > 0:
        lines += wrapped(f"and {more} more; --json lists all reasons", "  ")
    return lines


def _examples(found: Synthesis) -> list[JudgedDesign]:
    """All refused designs if they are few, else one for each kind of first defect."""
    if len(found.refused) <= _MOST_REASONS:
        return list(found.refused)
    first: dict[DefectKind, JudgedDesign] = {}
    for design in found.refused:
        first.setdefault(design.kinds[0], design)
    return list(first.values())


# ----------------------------------------------------------------------
# ``linkwork synthesize``


@click.command("synthesize")
@click.argument("task", metavar="TASK")
@click.option("-o", "--output", metavar="FOLDER", help="Folder for the designs.")
@click.option("--all", "every", is_flag=True, help="Write refused designs too, in FOLDER/refused.")
@click.option("--draw", is_flag=True, help="Draw every written design (SVG).")
@click.option("--csv", is_flag=True, help="Write a table of all designs: FOLDER/designs.csv.")
@click.option("--html", is_flag=True, help="Write a page of all designs: FOLDER/index.html.")
@click.option("--force", is_flag=True, help="Replace the files of an earlier synthesis.")
@json_option
@debug_option
@click.pass_context
def synthesize_command(
    context: click.Context,
    task: str,
    output: str | None,
    every: bool,
    draw: bool,
    csv: bool,
    html: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Find mechanisms for a task: poses, points, a curve or a function.

    Every solution is listed; designs that change branch or circuit, pass the
    positions out of order or miss a wish are refused with their reason. The
    others are written as mechanism files, best first.

    \b
      linkwork synthesize five-poses   (a task to begin with)
      linkwork synthesize task.toml
      linkwork synthesize task.toml -o designs --draw --html
      linkwork synthesize task.toml -o designs --all --json
    """
    options = FolderOptions(refused=every, draw=draw, csv=csv, html=html, force=force)
    if output is None and any((every, draw, csv, html, force)):
        raise InputError("--all, --draw, --csv, --html and --force need a folder: add -o FOLDER")
    # a task in a file finds the files that it names beside it
    asked = Task.load(task) if os.path.exists(task) else Task.loads(*text_of_source(task))
    if output is not None:
        earlier = check_folder(as_path(output), options, asked.described)
    try:
        with progress("solving the task") as tell:
            found = asked.solve(progress=tell)
    except KeyboardInterrupt:
        raise KeyboardInterrupt("before there was a design") from None
    if found.interrupted:
        answer_interrupt()
    if not found.sound:
        try:
            with progress("trying changes of the task"):
                advice_of(found)  # which is kept
        except KeyboardInterrupt:
            found = replace(found, what_helps=str)
            answer_interrupt()
    files: dict[int, str] = {}
    if output is not None:
        with progress("writing designs") as tell:
            files = write_designs(found, output, options, tell, earlier)
    if as_json:
        advice = {"remarks": list(remarks_on(found)), "advice": advice_of(found)}
        print_json({**found.to_dict(files), **advice})
    else:
        lines = synthesis_lines(found)
        if output is not None:
            count = f"{len(files)} design{'' if len(files) == 1 else 's'}"
            written = [count, *task_copy(found.task).files]
            told = f"Wrote {', '.join(written[:-1])} and {written[-1]} in {output}."
            if keeps_earlier(found, earlier):
                told = f"Wrote nothing: {output} keeps its earlier designs and their task."
            lines += ["", *wrapped(told)]
        print_lines(lines)
    if not found.delivered:
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
        asked = PathAtlas.shipped() if file is None else PathAtlas.load(file)
        found = asked.nearest(curve.points, 100 if count is None else count)
    files: list[str] = []
    if output is not None:
        files = _write(found, as_path(output), earlier)
    if as_json:
        print_json({"paths": len(asked), "nearest": [_data(n, files) for n in found]})
        return
    lines = [*title_lines(f"{len(found)} of {len(asked)} paths near {sources[0]}"), *_rows(found)]
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
    for told in made.unfinished:
        print_lines(wrapped(f"{told}. Finish it and repeat this command for the others."))


def _write(found: tuple[NearPath, ...], folder: Path, earlier: Collection[str]) -> list[str]:
    digits, files = len(str(len(found))), []
    with progress("writing mechanisms") as tell, _OWN.written(folder, earlier) as part:
        for near in found:
            name = f"near-{near.number:0{digits}}.toml"
            save(near.mechanism.description, part / name)
            files.append(str(folder / name))
            tell(near.number / len(found))
    return files


def _data(near: NearPath, files: list[str]) -> dict[str, object]:
    return {
        "distance": near.distance,
        "mechanism": near.family,
        "mirrored": near.is_mirrored,
        "numbers": near.numbers,
        "file": files[near.number - 1] if files else None,
    }


def _rows(found: tuple[NearPath, ...]) -> list[str]:
    """The nearest ones."""
    shown = found[:_SHOWN]
    lines = table_lines(
        [
            Column(header="", cells=[str(near.number) for near in shown], align="right"),
            Column(
                header="distance", cells=[significant(n.distance, 3) for n in shown], align="point"
            ),
            Column(header="mechanism", cells=[near.family for near in shown]),
            Column(header="", cells=["mirrored" if n.is_mirrored else "" for n in shown]),
        ]
    )
    more = len(found) - len(shown)
    return lines + (wrapped(f"and {more} more; --json lists all", "  ") if more else [])
