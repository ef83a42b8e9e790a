"""``linkwork draw``"""

from __future__ import annotations

from typing import Any

import click

from linkwork.cli import picture
from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import (
    at_option,
    configuration_option,
    debug_option,
    file_argument,
    force_option,
    forces_of,
    input_values,
    json_option,
    set_option,
)
from linkwork.cli.output_file import check_outputs
from linkwork.cli.terminal import print_written, progress
from linkwork.drawing.scene_options import SceneOptions
from linkwork.drawing.theme import THEMES

__all__ = ["draw"]


@click.command
@file_argument
@click.option(
    "-o", "--output", metavar="PATH", required=True, help="Picture file: .png, .svg, .pdf or .tikz."
)
@at_option
@configuration_option
@set_option
@click.option("--vectors", is_flag=True, help="Draw the loop equations as vectors, head to tail.")
@click.option("--velocities", is_flag=True, help="Draw the velocities of the points.")
@click.option("--accelerations", is_flag=True, help="Draw the accelerations of the points.")
@force_option
@click.option("--centres", is_flag=True, help="Draw the instant centres of all pairs of links.")
@click.option(
    "--centrodes",
    "centrodes",
    metavar="LINK",
    multiple=True,
    help="Draw the fixed and the moving centrode of a link; may be repeated.",
)
@click.option(
    "--dimensions", is_flag=True, help="Draw dimension lines of lengths, radii and the input."
)
@click.option(
    "--trace",
    "traces",
    metavar="POINT",
    multiple=True,
    help="Draw the path of this point instead of those in the file's [trace]; may be repeated.",
)
@click.option("--speed", is_flag=True, help="Colour the paths by the points' speed.")
@click.option("--link-names", is_flag=True, help="Label the links with their names.")
@click.option(
    "--theme",
    type=click.Choice(tuple(THEMES)),
    default="light",
    help="Colours of the page: light (the default) or dark.",
)
@json_option
@debug_option
def draw(
    file: str,
    output: str,
    at: tuple[str, ...],
    configuration: str | None,
    changes: tuple[str, ...],
    vectors: bool,
    traces: tuple[str, ...],
    forces: tuple[str, ...],
    theme: str,
    as_json: bool,
    **shown: Any,
) -> None:
    """Draw one position, with the paths of the traced points.

    \b
      linkwork draw rapier.toml -o rapier.png
      linkwork draw rapier.toml -o rapier.svg --at 120 --vectors
      linkwork draw fourbar.toml -o crossed.png --configuration crossed
      linkwork draw fourbar.toml -o load.svg --force "B=0,-981 N"
      linkwork draw fourbar.toml -o poles.pdf --centres --centrodes coupler
    """
    picture.check_picture(output)
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    if not vectors:
        picture.check_points(mechanism)
    values = input_values(mechanism, at)
    options = SceneOptions(forces=forces_of(mechanism, forces), **shown)
    with progress("sweeping") as tell:
        scene = mechanism.scene(
            values,
            configuration=configuration,
            vectors=vectors,
            traces=traces or None,
            options=options,
            progress=tell,
        )
    with progress("drawing"):
        picture.write(scene, output, theme=THEMES[theme])
    print_written(output, as_json)
