"""``linkwork view``"""

from __future__ import annotations

import os
import threading
import webbrowser
from collections.abc import Callable
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING

import click

from linkwork.api import loads
from linkwork.cli.mechanism_source import names_to_copy, text_to_copy
from linkwork.cli.options import debug_option, json_option
from linkwork.cli.terminal import print_json, print_lines, progress, title_lines
from linkwork.foundation.errors import InputError
from linkwork.textfile.link import is_link, text_of_link
from linkwork.viewer.live.bench import Bench
from linkwork.viewer.live.mechanism_file import MechanismFile, blank_sheet, new_file
from linkwork.viewer.live.server import LiveServer

if TYPE_CHECKING:
    from linkwork.design.suggestion.suggested_design import Suggesting
    from linkwork.design.synthesis.result import Synthesis
    from linkwork.design.tasks.task import Task

__all__ = ["view"]


def _opened(file: str) -> MechanismFile:
    """A file, or a text that is written when it is saved: a mechanism of the library or of a link,
    a task to begin with, or a blank sheet.
    """
    if is_link(file) and not os.path.exists(file):
        return _of_link(text_of_link(file))
    if Path(file).exists() or file not in names_to_copy():
        path = Path(file)
        named = path if path.suffix or path.exists() else path.with_suffix(".toml")
        return MechanismFile(named, blank_sheet(path.stem))
    path = Path(f"{file}.toml")
    if path.exists():
        raise InputError(
            f'there is a file "{path}" already: to open it, linkwork view {path}; to open the '
            "example, go to another folder"
        )
    return MechanismFile(path, text_to_copy(file))


def _of_link(text: str) -> MechanismFile:
    """The mechanism of a link under the first free name."""
    taken = (Path(f"linked{k}.toml") for k in count(2))
    path = next(path for path in chain([Path("linked.toml")], taken) if not path.exists())
    return MechanismFile(path, text)


def _solve_task(task: Task, *, progress: Callable[[float], None] | None = None) -> Synthesis:
    from linkwork.design.synthesis.solving import solve_task  # the first time a task is solved

    return solve_task(task, progress=progress)


def _suggesting() -> Suggesting:
    from linkwork.design.suggestion import suggesting  # the first time designs are suggested

    return suggesting


def _told(name: str, address: str) -> list[str]:
    return [
        *title_lines(f"{name} is open at"),
        f"  {address}",
        "Anyone who knows this address can edit the file. Stop with Ctrl-C.",
    ]


@click.command
@click.argument("file", metavar="[FILE]", required=False)
@click.option(
    "--port",
    metavar="NUMBER",
    type=click.IntRange(0, 65535),
    default=0,
    help="Port of the page. Default: any free port.",
)
@click.option("--no-browser", is_flag=True, help="Print the address, but do not open a browser.")
@json_option
@debug_option
def view(file: str | None, port: int, no_browser: bool, as_json: bool) -> None:
    """Draw, show and edit a mechanism, or design one for a task, in a browser
    until Ctrl-C.

    Without FILE the page begins with the library, a blank sheet and tasks.

    \b
      linkwork view
      linkwork view rapier.toml   (a blank sheet, if there is no such file)
      linkwork view task.toml     (a task: its designs)
      linkwork view four-bar      (of the library: saved as four-bar.toml)
      linkwork view five-poses    (a task to begin with)
      linkwork view "LINK"        (saved as linked.toml)
      linkwork view rapier.toml --port 8123 --no-browser

    Only programs on this machine that know the printed address can open the
    page. At the end, unsaved changes are written to a file next to FILE.
    """
    if file == "-":
        raise InputError("standard input cannot be edited and saved: give the name of a file")
    opened = new_file() if file is None else _opened(file)
    with progress("opening"):
        bench = Bench(opened, loads, _solve_task, _suggesting, start=file is None)
    server = LiveServer(bench, port)

    def tell() -> None:
        if as_json:
            print_json({"file": None if file is None else opened.name, "address": server.address})
        else:
            print_lines(_told("The page" if file is None else opened.name, server.address))
        if not no_browser:
            threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()

    try:
        server.run(tell)
    finally:
        for kept in bench.keep_unsaved():
            print_lines([f"Unsaved changes were written to {kept}."])
