"""``linkwork robot``"""

from __future__ import annotations

from pathlib import Path

import click

from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import (
    at_option,
    configuration_option,
    debug_option,
    file_argument,
    input_values,
    json_option,
    set_option,
)
from linkwork.cli.output_file import check_outputs, write_text
from linkwork.cli.terminal import print_written, progress
from linkwork.export import check_robot_file, robot_of

__all__ = ["robot"]


@click.command
@file_argument
@click.option(
    "-o", "--output", metavar="PATH", required=True, help="Robot file: .mjcf, .urdf or .sdf."
)
@at_option
@configuration_option
@set_option
@json_option
@debug_option
def robot(
    file: str,
    output: str,
    at: tuple[str, ...],
    configuration: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Write the mechanism for a simulator of robots.

    MJCF (MuJoCo) has the real loops, SDF all joints; URDF has a tree whose
    joints follow the driven one, their polynomials and limits. All joint
    values are zero in the start position, --at.

    \b
      linkwork robot fourbar.toml -o fourbar.mjcf
      linkwork robot fourbar.toml -o fourbar.urdf --at 60
    """
    path = Path(output)
    suffix = check_robot_file(path)
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    start = mechanism.solve(input_values(mechanism, at), configuration=configuration)
    motion = None
    if suffix == ".urdf":
        with progress("sweeping") as tell:
            motion = mechanism.sweep(configuration=configuration, progress=tell)
    write_text(output, [robot_of(mechanism.model, start, motion, path)])
    print_written(output, as_json)
