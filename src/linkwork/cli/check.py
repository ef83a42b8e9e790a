"""``linkwork check``"""

from __future__ import annotations

from collections.abc import Iterator

import click

from linkwork.cli.classification import classification_fields
from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import debug_option, file_argument, json_option, set_option
from linkwork.cli.position_page import redundant_lines
from linkwork.cli.terminal import (
    bad,
    fields,
    good,
    print_json,
    print_lines,
    progress,
    sentence,
    title_lines,
)
from linkwork.cli.text_table import Column, lengths, short, significant, table_lines
from linkwork.results.check import BlockSummary, CheckReport

__all__ = ["check", "check_lines"]


@click.command
@file_argument
@set_option
@json_option
@debug_option
@click.pass_context
def check(context: click.Context, file: str, changes: tuple[str, ...], as_json: bool) -> None:
    """Report how the file was read: loops, unknowns, mobility, problems.

    \b
      linkwork check rapier.toml
      linkwork check rapier.toml --set a2=260
    """
    mechanism = read_mechanism(file, changes)
    with progress("checking"):
        report = mechanism.check()
    if as_json:
        print_json(report.to_dict())
    else:
        print_lines(check_lines(report, mechanism.description.length))
    if not report.start.ok:
        context.exit(1)


def check_lines(report: CheckReport, length: str) -> list[str]:
    """The report as a page; ``length`` is the unit of lengths."""
    lines = [*title_lines(report.mechanism), *fields(_understood(report)), "", *_start(report)]
    if report.measured:
        links, points, values = zip(*report.measured, strict=True)
        lines += ["", "Lengths measured between [points], because [lengths] does not give them"]
        lines += table_lines(
            [
                Column(header="link", cells=links),
                Column(header="points", cells=points),
                Column(header=f"length [{length}]", cells=lengths(values), align="point"),
            ]
        )
    return lines


def _understood(report: CheckReport) -> Iterator[tuple[str, str]]:
    yield "written as", report.form
    if report.links:
        read = ", read off the loops" if report.form == "loops" else ""
        yield "parts", f"{_count(report.links, 'link')}, {_count(report.joints, 'joint')}{read}"
    what = "equation" if report.form == "equations" else "loop"
    yield what if len(report.loops) == 1 else f"{what}s", ", ".join(map(_quoted, report.loops))
    yield "unknowns", _with_units(report.unknowns) or "none"
    inputs = _with_units(report.inputs) or "none: solve finds one position, there is no sweep"
    yield "input" if len(report.inputs) < 2 else "inputs", inputs
    if report.rows:
        yield "sweep", _count(report.rows, "position")
    if report.blocks:
        yield "blocks", _blocks_sentence(report)
        if len(report.blocks) > 1:
            for k, block in enumerate(report.blocks, 1):
                together = " and ".join(map(_quoted, block.equations))
                yield "", f"{k}. {', '.join(block.unknowns)} from {together}{_group(block)}"
    if report.form != "equations":
        yield "mobility", _mobility(report)
    yield from redundant_lines({link: gap for link, _, gap in report.redundant})
    if report.classification is not None:
        yield from classification_fields(report.classification)
    else:
        yield "chain", f"not known: {report.unclassified}"


def _blocks_sentence(report: CheckReport) -> str:
    if len(report.blocks) == 1:
        return f"1, all unknowns are solved together{_group(report.blocks[0])}"
    return f"{len(report.blocks)}, solved one after the other:"


def _group(block: BlockSummary) -> str:
    return "" if block.group is None else f": {block.group.text}"


def _mobility(report: CheckReport) -> str:
    count, rank = report.mobility_count, report.mobility_rank
    by_rank = "not known by rank, which needs a position" if rank is None else f"{rank} by rank"
    if count is None:
        return by_rank
    both = f"{count} by Grübler's count, {by_rank}"
    return f"{both}. They differ: {report.mobility_why}" if report.mobility_why else both


def _start(report: CheckReport) -> list[str]:
    where = ", ".join(
        f"{name} = {short(report.start_input[name])} {unit}".rstrip()
        for name, unit in report.inputs
    )
    at = f"at {where}" if where else ""
    if not report.start.ok:
        told = report.failure
        why = [("why", report.start_message)] if told is None else told.sentences()
        return [*sentence(bad, "No position found", at), *fields(why)]
    measure = "" if report.form == "equations" else " of the longest link"
    residual = significant(report.residual, 2) + measure
    return [*sentence(good, "Position found", at), *fields([("residual", residual)])]


def _with_units(names: tuple[tuple[str, str], ...]) -> str:
    return ", ".join(f"{name} [{unit}]" if unit else name for name, unit in names)


def _quoted(label: str) -> str:
    return f'"{label}"'


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
