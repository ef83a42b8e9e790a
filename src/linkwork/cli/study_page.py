"""A study as a page of text: counts of designs, filters, ranges and histograms."""

from __future__ import annotations

import math
from collections.abc import Iterator

from linkwork.batch import study as studies
from linkwork.cli.terminal import bad, fields, sentence, title_lines
from linkwork.cli.text_table import WIDTH, table_lines
from linkwork.results.listing.column import Column
from linkwork.results.listing.number_text import lengths, significant

__all__ = ["progress_line", "summary_lines", "verification_lines"]

_DIGITS = 6
_MOST_PROBLEMS = 5
_SIGN = "#"
_GAP = 2  # between columns


def progress_line(progress: studies.Progress) -> str:
    """The finished fraction of a run, its rate and the remaining time."""
    share = math.floor(100 * progress.done / progress.total)
    line = f"{share:3d} %  {progress.done:,} of {progress.total:,} designs"
    if progress.left is None:
        return line
    return f"{line}  {progress.rate:,.0f}/s  {_duration(progress.left)} left"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(math.ceil(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


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


def _chunks(which: tuple[int | str, ...]) -> str:
    """Names of chunks and files, the first few of them."""
    named = [x if isinstance(x, str) else f"chunk {x}" for x in which[:_MOST_PROBLEMS]]
    more = len(which) - len(named)
    return ", ".join(named) + (f" and {more:,} more" if more else "")


def verification_lines(found: studies.Verification, store: str) -> list[str]:
    """The page of a comparison of a store with its checksums."""
    if found.intact:
        return [f"All {found.sound:,} chunks of {store} are as they were written."]
    damaged = {"metadata": found.metadata} if found.metadata else {}
    damaged |= {f"chunk {chunk}": files for chunk, files in found.chunks.items()}
    names = dict.fromkeys(damaged, bad)
    pairs = ((name, _chunks(files)) for name, files in damaged.items())
    return [
        *title_lines(f"{store} is damaged"),
        *fields(pairs, names),
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
