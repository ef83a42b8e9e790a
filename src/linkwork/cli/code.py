"""``linkwork code``"""

from __future__ import annotations

from pathlib import Path

import click

from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import (
    configuration_option,
    debug_option,
    file_argument,
    json_option,
    range_options,
    set_option,
)
from linkwork.cli.output_file import check_outputs, write_text
from linkwork.cli.terminal import print_written, progress
from linkwork.export import code_of, language_of
from linkwork.mechanism.dimensions import Number

__all__ = ["code"]


@click.command
@file_argument
@click.option(
    "-o",
    "--output",
    metavar="PATH",
    required=True,
    help="Program file: .py (NumPy), .m (Octave, MATLAB), .c (C99), .js or .st (IEC 61131-3).",
)
@range_options
@configuration_option
@set_option
@json_option
@debug_option
def code(
    file: str,
    output: str,
    start: Number | None,
    stop: Number | None,
    step: Number | None,
    configuration: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Write the solver as a program in another language.

    The program has a function of the input that returns every unknown, point
    and output with its derivatives, and a main program that prints the table
    as CSV. It needs no Linkwork.

    \b
      linkwork code rapier.toml -o rapier.py
      linkwork code rapier.toml -o rapier.c --from 0 --to 90 --step 0.5
      linkwork code fourbar.toml -o crossed.js --configuration crossed
    """
    path = Path(output)
    language_of(path)
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    with progress("sweeping") as tell:
        motion = mechanism.sweep(
            start=start, stop=stop, step=step, configuration=configuration, progress=tell
        )
    with progress("writing the program"):
        text = code_of(mechanism.model, motion, path)
    write_text(output, [text])
    print_written(output, as_json)
