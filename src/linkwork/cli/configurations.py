"""``linkwork configurations``"""

from __future__ import annotations

import click

from linkwork.api import Mechanism
from linkwork.cli import picture
from linkwork.cli.mechanism_source import read_mechanism, shown_source
from linkwork.cli.options import (
    at_option,
    debug_option,
    file_argument,
    input_values,
    json_option,
    set_option,
)
from linkwork.cli.output_file import check_outputs
from linkwork.cli.terminal import (
    bad,
    fields,
    good,
    print_json,
    print_lines,
    progress,
    sentence,
    title_lines,
    wrapped,
)
from linkwork.cli.text_table import table_lines
from linkwork.drawing.sheet import configuration_sheet
from linkwork.results.configurations import Configurations
from linkwork.results.listing.configuration_listing import (
    completeness_fields,
    configuration_columns,
)
from linkwork.results.listing.number_text import short
from linkwork.results.listing.position_listing import inputs_text
from linkwork.results.quantity import Kind

__all__ = ["configurations", "configurations_lines"]


@click.command
@file_argument
@at_option
@click.option("--draw", metavar="PATH", help="Draw all configurations as .png, .svg or .pdf.")
@set_option
@json_option
@debug_option
@click.pass_context
def configurations(
    context: click.Context,
    file: str,
    at: tuple[str, ...],
    draw: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """List all assembly configurations at one input value.

    States whether the list is proved complete. The commands solve and sweep
    accept the names in the list.

    \b
      linkwork configurations rapier.toml --at 60 --draw list.png
      linkwork solve fourbar.toml --at 60 --configuration crossed
    """
    if draw is not None:
        picture.check_picture(draw)
    check_outputs(file, draw)
    mechanism = read_mechanism(file, changes)
    if draw is not None:
        picture.check_points(mechanism)
    values = input_values(mechanism, at)
    with progress("listing configurations"):
        found = mechanism.configurations(values)
    if draw is not None and len(found):
        with progress("drawing"):
            picture.write(configuration_sheet(found), draw)
    if as_json:
        print_json(found.to_dict())
    else:
        hint = [] if len(found) else _reason(file, found)
        written = _written(draw, len(found))
        print_lines([*configurations_lines(mechanism, found), *written, *hint])
    if not (found.completeness.complete and len(found)):
        context.exit(1)


def _reason(file: str, found: Configurations) -> list[str]:
    """The command that explains why there is no configuration."""
    asked = [f"{name}={short(value)}" for name, value in found.input.items()]
    at = "".join(f" --at {text if len(asked) > 1 else text.partition('=')[2]}" for text in asked)
    return ["", *wrapped(f"For the reason: linkwork solve {shown_source(file)}{at}")]


def _written(draw: str | None, count: int) -> list[str]:
    if draw is None:
        return []
    return ["", f"Wrote {draw}." if count else f"Did not write {draw}: there is nothing to draw."]


def configurations_lines(mechanism: Mechanism, found: Configurations) -> list[str]:
    """The page: one row per configuration, then completeness and the counts of solutions."""
    kinds = {v.name: Kind(v.kind) for v in mechanism.loop_equations.unknowns}
    lines = title_lines(found.mechanism)
    count = len(found)
    what = "1 configuration" if count == 1 else f"{count or 'No'} configurations"
    where = inputs_text(found.input, found.input_units)
    lines += sentence(good if found.completeness.complete and count else bad, what, where)
    if count:
        lines += ["", *table_lines(configuration_columns(found, kinds))]
    return [*lines, "", *fields(completeness_fields(found))]
