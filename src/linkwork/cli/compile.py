"""``linkwork compile``"""

from __future__ import annotations

import time

import click

from linkwork.batch import compile_kernels
from linkwork.cli.options import debug_option, json_option
from linkwork.cli.terminal import print_json, print_lines, progress

__all__ = ["compile"]


@click.command
@json_option
@debug_option
def compile(as_json: bool) -> None:
    """Compile the code that solves families and long tables, once after an installation.

    Without this command, the first family of designs waits for it.

    \b
      linkwork compile
    """
    begin = time.perf_counter()
    with progress("compiling") as tell:
        compile_kernels(tell)
    seconds = round(time.perf_counter() - begin, 1)
    if as_json:
        print_json({"seconds": seconds})
    else:
        print_lines([f"Compiled code is ready ({seconds} s)."])
