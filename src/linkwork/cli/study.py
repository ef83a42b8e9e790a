"""``linkwork study``"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic

import click

from linkwork.batch import study as studies  # its modules load Numba, at their first use
from linkwork.batch.study.store_packages import check_packages
from linkwork.cli.interrupts import check_interrupt
from linkwork.cli.options import columns_option, debug_option, json_option
from linkwork.cli.study_page import progress_line, summary_lines, verification_lines
from linkwork.cli.terminal import print_json, print_lines, wrapped
from linkwork.foundation.errors import InputError

__all__ = ["study", "study_progress"]

_PATIENCE = 1.0  # seconds before the progress line appears


@click.command
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
@click.option("--quiet", is_flag=True, help="Do not show the progress line.")
@json_option
@debug_option
@click.pass_context
def study(
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
        _print(studies.summary_of(summary), summary, as_json)
        return
    if verify:
        if plan is None or output is not None:
            raise InputError(
                "--verify reads a store and nothing else:\n    linkwork study out.zarr --verify"
            )
        compared = studies.verify_store(plan)
        _print_verification(compared, plan, as_json)
        context.exit(0 if compared.intact else 1)
    if plan is None or output is None:
        raise InputError(
            "a study needs a plan and a store:\n    linkwork study plan.toml -o out.zarr"
        )
    check_packages()
    asked = _read(plan, names)
    with study_progress(quiet) as tell:
        try:
            found = studies.run_study(
                asked,
                output,
                workers=workers,
                scheduler=scheduler,
                force=force,
                progress=tell,
            )
        except KeyboardInterrupt:
            print_lines(["", *_how_to_go_on(asked, output)], err=True)
            raise
    _print(found, output, as_json)


def _read(plan: str, columns: tuple[str, ...]) -> studies.Study:
    if plan != "-":
        return studies.read_plan(plan, columns=columns)
    if sys.stdin is None:
        raise InputError("there is no standard input to read a plan from")
    return studies.read_plan_bytes(sys.stdin.buffer.read(), columns=columns)


def _print(found: studies.Summary, store: str, as_json: bool) -> None:
    if as_json:
        print_json(found.to_dict())
    else:
        print_lines(summary_lines(found, store))


def _print_verification(found: studies.Verification, store: str, as_json: bool) -> None:
    if as_json:
        print_json(found.to_dict())
    else:
        print_lines(verification_lines(found, store))


def _how_to_go_on(asked: studies.Study, store: str) -> list[str]:
    """How many designs of an interrupted study are stored, and how to resume it."""
    if not Path(store).exists():
        return []
    stored = asked.count_in(studies.chunks_with_entry(Path(store)))
    return wrapped(
        f"{stored} of {asked.plan.count} designs are stored in {store}. "
        "To resume, repeat the same command."
    )


@contextmanager
def study_progress(quiet: bool) -> Iterator[Callable[[studies.Progress], None]]:
    """A progress line that rewrites itself, on the error stream of a terminal only."""
    if quiet or not sys.stderr.isatty():
        yield lambda progress: check_interrupt()
        return
    began = monotonic()
    width = 0

    def tell(progress: studies.Progress) -> None:
        nonlocal width
        check_interrupt()
        if monotonic() - began > _PATIENCE:
            line = progress_line(progress)
            click.echo("\r" + line.ljust(width), nl=False, err=True)
            width = len(line)

    try:
        yield tell
    finally:
        if width:
            click.echo("\r" + " " * width + "\r", nl=False, err=True)
