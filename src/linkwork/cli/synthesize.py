"""``linkwork synthesize``"""

from __future__ import annotations

import os
from dataclasses import replace

import click

from linkwork.api.designs_folder import FolderOptions, check_folder, keeps_earlier, write_designs
from linkwork.api.synthesis import Task
from linkwork.api.task_copy import task_copy
from linkwork.cli.interrupts import answer_interrupt
from linkwork.cli.mechanism_source import text_of_source
from linkwork.cli.options import debug_option, json_option
from linkwork.cli.synthesis_page import synthesis_lines
from linkwork.cli.terminal import print_json, print_lines, progress, wrapped
from linkwork.design.synthesis.advice import advice_of, remarks_on
from linkwork.foundation.errors import InputError
from linkwork.foundation.paths import as_path

__all__ = ["synthesize"]


@click.command
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
def synthesize(
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
