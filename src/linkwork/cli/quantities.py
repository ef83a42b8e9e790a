"""``linkwork quantities``"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from textwrap import wrap

import click

from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import debug_option, file_argument, json_option, set_option
from linkwork.cli.terminal import print_json, print_lines, title_lines
from linkwork.cli.text_table import WIDTH, table_lines
from linkwork.results.listing.column import Column
from linkwork.results.quantities.registry import Listed

__all__ = ["quantities"]

_GAPS = 8  # before each column of the table
_NARROWEST = 16  # width of the explanations


@click.command
@file_argument
@set_option
@json_option
@debug_option
def quantities(file: str, changes: tuple[str, ...], as_json: bool) -> None:
    """List all quantities of a mechanism.

    Every name is a column of sweep and plot, an output in a file, and a
    quantity of families and studies; numbers of a motion are values of
    sweeps, families and studies. "…" is any quantity.

    \b
      linkwork quantities rapier.toml
      linkwork sweep rapier.toml --columns s16.d1 --csv rates.csv
      linkwork sweep rapier.toml --columns "stroke(s16)"
    """
    mechanism = read_mechanism(file, changes)
    model = mechanism.model
    listed = list(model.quantities.listed(timed=model.speed is not None))
    if as_json:
        print_json({"quantities": [asdict(line) for line in listed]})
    else:
        print_lines([*title_lines(mechanism.name), "", *_table(listed)])


def _table(listed: Sequence[Listed]) -> list[str]:
    """Name, kind, unit and explanation of each; long explanations are wrapped."""
    used = _GAPS + sum(
        max(len(text) for text in texts)
        for texts in (
            [line.name for line in listed],
            [line.kind for line in listed],
            ["unit", *(line.unit for line in listed)],
        )
    )
    rows = [row for line in listed for row in _rows(line, max(WIDTH - used, _NARROWEST))]
    headers = ("name", "kind", "unit", "meaning")
    columns = zip(headers, zip(*rows, strict=True), strict=True)
    return table_lines([Column(header=header, cells=cells) for header, cells in columns])


def _rows(line: Listed, room: int) -> Iterator[tuple[str, str, str, str]]:
    first, *more = wrap(line.about, room)
    yield line.name, line.kind, line.unit, first
    yield from (("", "", "", text) for text in more)
