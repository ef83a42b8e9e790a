"""Commands on studies."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from pathlib import Path

import click

from linkwork.core.commands.options import columns_option
from linkwork.core.commands.terminal import (
    WIDTH,
    bad,
    check_interrupt,
    debug_option,
    fields,
    json_option,
    print_json,
    print_lines,
    progress,
    sentence,
    table_lines,
    title_lines,
    wrapped,
)
from linkwork.core.foundation.errors import InputError
from linkwork.core.results.listing import Column, lengths, significant
from linkwork.families import study as studies
from linkwork.families.study.store import check_packages

# ----------------------------------------------------------------------
# A study as a page of text: counts of designs, filters, ranges and histograms.


_DIGITS = 6
_MOST_PROBLEMS = 5
_SIGN = "#"
_GAP = 2  # between columns


def summary_lines(found: studies.Summary, store: str) -> list[str]:
    """The page of a study."""
    head = f"{found.mechanism}: {found.designs:,} designs × {found.inputs:,} inputs in {store}"
    lines = [*title_lines(found.name), *sentence(str, head)]
    lines += fields(_counts(found), dict.fromkeys(("not computed", "not built", "damaged"), bad))
    lines += ["", *_rows(found)]
    outputs = [output for output in found.outputs if output.count]
    if outputs:
        lines += ["", *_ranges(outputs)]
    for output in outputs:
        lines += ["", *_histogram(output)]
    return lines


def _counts(found: studies.Summary) -> Iterator[tuple[str, str]]:
    """The numbers of designs that were computed, were built, and passed each filter."""
    missing = found.designs - found.computed
    if missing:
        yield "not computed", f"{missing:,}: the study is not finished"
    if found.damaged:
        yield "damaged", f"{_chunks(found.damaged)}: repeat the command of the study"
    if found.repaired:
        yield "repaired", f"{_chunks(found.repaired)}: changed after it was stored"
    yield "computed", f"{found.computed:,}"
    unbuilt = found.computed - found.built
    if unbuilt:
        yield "not built", f"{unbuilt:,}"
    for problem, count in list(found.problems.items())[:_MOST_PROBLEMS]:
        yield "", f"{count:,}: {problem}"
    for name, (condition, count) in found.filters.items():
        yield name, f"{_of(count, found.computed)}  {condition}"
    yield "passed", _of(found.passed, found.computed)


def _chunks(which: tuple[int, ...]) -> str:
    return _first_few([f"chunk {k}" for k in which])


def _first_few(names: Sequence[str]) -> str:
    more = len(names) - _MOST_PROBLEMS
    return ", ".join(names[:_MOST_PROBLEMS]) + (f" and {more:,} more" if more > 0 else "")


def verification_lines(found: studies.Verification, store: str) -> list[str]:
    """The page of a comparison of a store with its checksums."""
    if found.intact:
        return [f"All {found.sound:,} chunks of {store} are as they were written."]
    damaged = {f"chunk {chunk}": _first_few(files) for chunk, files in found.chunks.items()}
    return [
        *title_lines(f"{store} is damaged"),
        *fields(damaged.items(), dict.fromkeys(damaged, bad)),
        *sentence(
            str,
            f"{found.sound:,} chunks are as they were written. To repair the others, repeat the "
            "command of the study.",
        ),
    ]


def _of(count: int, total: int) -> str:
    return f"{count:,} ({100 * count / total:.4g} %)" if total else f"{count:,}"


def _rows(found: studies.Summary) -> list[str]:
    """Rows by status."""
    names = [name.lower().replace("_", " ") for name in found.rows]
    counts = [f"{count:,}" for count in found.rows.values()]
    return table_lines(
        [
            Column(
                header="rows",
                cells=["found" if n == "converged" else n for n in names] + ["certified"],
            ),
            Column(header="", cells=[*counts, f"{found.certified:,}"], align="right"),
        ]
    )


def _ranges(outputs: list[studies.OutputSummary]) -> list[str]:
    """Smallest, mean and largest value of every output of the designs that passed."""

    def column(header: str, values: list[float]) -> Column:
        return Column(header=header, cells=[significant(v, _DIGITS) for v in values], align="point")

    return table_lines(
        [
            Column(header="of designs that passed", cells=[output.name for output in outputs]),
            column("minimum", [output.least for output in outputs]),
            column("mean", [output.mean for output in outputs]),
            column("maximum", [output.most for output in outputs]),
            Column(header="unit", cells=[output.unit for output in outputs]),
        ]
    )


def _histogram(output: studies.OutputSummary) -> list[str]:
    """A histogram over equal parts of the range, as bars of text."""
    bins = len(output.histogram)
    edges = [output.least + k * (output.most - output.least) / bins for k in range(bins)]
    unit = f" [{output.unit}]" if output.unit else ""
    columns = [
        Column(header="from", cells=lengths(edges), align="right"),
        Column(header="count", cells=[f"{count:,}" for count in output.histogram], align="right"),
    ]
    room = WIDTH - max(map(len, table_lines(columns))) - _GAP
    largest = max(output.histogram)
    bars = [_SIGN * math.ceil(room * count / largest) for count in output.histogram]
    return [f"  {output.name}{unit}", *table_lines([*columns, Column(header="", cells=bars)])]


# ----------------------------------------------------------------------
# ``linkwork study``


@click.command("study")
@click.argument("plan", metavar="PLAN", required=False)
@click.option("-o", "--output", metavar="STORE", help="Folder for the results (a Zarr store).")
@columns_option("Keep this quantity at every row, in addition to those of the plan.")
@click.option(
    "--workers", metavar="N", type=int, help="Processes on this machine. Default: one per core."
)
@click.option("--scheduler", metavar="ADDRESS", help="Compute on a Dask cluster: tcp://host:8786.")
@click.option("--force", is_flag=True, help="Delete the study in STORE and start over.")
@click.option("--summary", metavar="STORE", help="Only print the summary of a store.")
@click.option(
    "--verify", is_flag=True, help="Only compare the files of a store with their checksums."
)
@click.option("--quiet", is_flag=True, help="Do not show the progress bar.")
@json_option
@debug_option
@click.pass_context
def study_command(
    context: click.Context,
    plan: str | None,
    output: str | None,
    names: tuple[str, ...],
    workers: int | None,
    scheduler: str | None,
    force: bool,
    summary: str | None,
    verify: bool,
    quiet: bool,
    as_json: bool,
) -> None:
    """Compute many designs of a mechanism from a plan file.

    Results are stored in chunks. To resume an interrupted study, repeat the
    same command.

    \b
      linkwork study plan.toml -o out.zarr
      linkwork study plan.toml -o out.zarr --scheduler tcp://host:8786
      linkwork study --summary out.zarr
      linkwork study out.zarr --verify
    """
    if summary is not None:
        if plan is not None or output is not None:
            raise InputError("--summary reads a store: leave out the plan and -o")
        check_packages()
        stored = studies.summary_of(summary)
        _print(stored, summary_lines(stored, summary), as_json)
        return
    if verify:
        if plan is None or output is not None:
            raise InputError(
                "--verify reads a store and nothing else:\n    linkwork study out.zarr --verify"
            )
        compared = studies.verify_store(plan)
        _print(compared, verification_lines(compared, plan), as_json)
        context.exit(0 if compared.intact else 1)
    if plan is None or output is None:
        raise InputError(
            "a study needs a plan and a store:\n    linkwork study plan.toml -o out.zarr"
        )
    check_packages()
    asked = _read(plan, names)
    try:
        with nullcontext(_unseen) if quiet else progress("studying") as tell:
            found = studies.run_study(
                asked,
                output,
                workers=workers,
                scheduler=scheduler,
                force=force,
                progress=lambda progress: tell(progress.done / progress.total),
            )
    except KeyboardInterrupt:
        print_lines(["", *_how_to_go_on(asked, output)], err=True)
        raise
    _print(found, summary_lines(found, output), as_json)


def _unseen(fraction: float) -> None:
    check_interrupt()


def _read(plan: str, columns: tuple[str, ...]) -> studies.Study:
    if plan != "-":
        return studies.read_plan(plan, columns=columns)
    if sys.stdin is None:
        raise InputError("there is no standard input to read a plan from")
    return studies.read_plan_bytes(sys.stdin.buffer.read(), columns=columns)


def _print(
    found: studies.Summary | studies.Verification, lines: Sequence[str], as_json: bool
) -> None:
    if as_json:
        print_json(found.to_dict())
    else:
        print_lines(lines)


def _how_to_go_on(asked: studies.Study, store: str) -> list[str]:
    """How many designs of an interrupted study are stored, and how to resume it."""
    if not Path(store).exists():
        return []
    stored = asked.count_in(studies.chunks_with_record(Path(store)))
    return wrapped(
        f"{stored} of {asked.plan.count} designs are stored in {store}. "
        "To resume, repeat the same command."
    )


# ----------------------------------------------------------------------
# ``linkwork compile``


@click.command("compile")
@json_option
@debug_option
def compile_command(as_json: bool) -> None:
    """Compile the code of families and long tables, once.

    Without this command, the first family after an installation waits for it.

    \b
      linkwork compile
    """
    # the other command says that packages are missing before it loads Numba, which takes long
    from linkwork.families.family import compile_kernels

    begin = time.perf_counter()
    with progress("compiling") as tell:
        compile_kernels(tell)
    seconds = round(time.perf_counter() - begin, 1)
    if as_json:
        print_json({"seconds": seconds})
    else:
        print_lines([f"Compiled code is ready ({seconds} s)."])
