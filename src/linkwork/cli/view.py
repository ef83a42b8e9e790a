"""``linkwork view``"""

from __future__ import annotations

import threading
import webbrowser

import click

from linkwork.api import loads
from linkwork.cli.options import debug_option, file_argument
from linkwork.cli.terminal import print_lines, title_lines
from linkwork.foundation.errors import InputError
from linkwork.viewer.live.mechanism_file import MechanismFile
from linkwork.viewer.live.server import LiveServer
from linkwork.viewer.live.workbench import Workbench

__all__ = ["view"]


@click.command
@file_argument
@click.option(
    "--port",
    metavar="NUMBER",
    type=click.IntRange(0, 65535),
    default=0,
    help="Listen at this port; left out, at any that is free.",
)
@click.option("--no-browser", is_flag=True, help="Print the address only.")
@debug_option
def view(file: str, port: int, no_browser: bool) -> None:
    """Show and edit a mechanism in a browser until Ctrl-C.

    \b
      linkwork view rapier.toml
      linkwork view rapier.toml --port 8123 --no-browser

    The page is served on this machine only, to whoever knows the address
    printed. What was not saved is kept in a file beside FILE at the end.
    """
    if file == "-":
        raise InputError("the page edits a file: name one, standard input cannot be saved back")
    workbench = Workbench(MechanismFile(file), loads)
    server = LiveServer(workbench, port)

    def tell() -> None:
        print_lines(
            [
                *title_lines(f"{file} is shown at"),
                f"  {server.address}",
                "Whoever knows this address can edit the file. Ctrl-C ends.",
            ]
        )
        if not no_browser:
            threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()

    try:
        server.run(tell)
    finally:
        kept = workbench.keep_unsaved()
        if kept is not None:
            print_lines([f"There were changes that were not saved. They are kept in {kept}."])
