"""``linkwork draw``"""

from __future__ import annotations

import click

from linkwork.cli import picture
from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import (
    at_option,
    configuration_option,
    debug_option,
    file_argument,
    input_values,
    set_option,
)
from linkwork.cli.output_file import check_outputs
from linkwork.cli.terminal import print_lines, progress

__all__ = ["draw"]


@click.command
@file_argument
@click.option("-o", "--output", metavar="PATH", required=True, help="Picture: .png, .svg or .pdf.")
@at_option
@configuration_option
@set_option
@debug_option
def draw(
    file: str,
    output: str,
    at: tuple[str, ...],
    configuration: str | None,
    changes: tuple[str, ...],
) -> None:
    """Draw one position, with the paths of the traced points.

    \b
      linkwork draw rapier.toml -o rapier.png
      linkwork draw rapier.toml -o rapier.svg --at 120
      linkwork draw fourbar.toml -o crossed.png --configuration crossed
    """
    picture.check_picture(output)
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    picture.check_points(mechanism)
    values = input_values(mechanism, at)
    with progress("sweeping") as tell:
        scene = mechanism.scene(values, configuration=configuration, progress=tell)
    picture.write(scene, output)
    print_lines([f"Wrote {output}."])
