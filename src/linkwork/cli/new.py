"""``linkwork new``"""

from __future__ import annotations

import re
from pathlib import Path

import click

from linkwork.cli.mechanism_source import text_to_copy
from linkwork.cli.options import debug_option, json_option
from linkwork.cli.terminal import print_json
from linkwork.foundation.errors import InputError
from linkwork.foundation.written_file import save_text
from linkwork.viewer.live.mechanism_file import blank_sheet

__all__ = ["new"]


@click.command
@click.argument("name")
@click.option(
    "--from",
    "model",
    metavar="EXAMPLE",
    help='A mechanism or a task to begin with: "linkwork examples" lists them.',
)
@json_option
@debug_option
def new(name: str, model: str | None, as_json: bool) -> None:
    """Write a new file of a mechanism or a task.

    \b
      linkwork new press                        (a blank sheet, press.toml)
      linkwork new press --from toggle-press    (a copy with that name)
      linkwork new tipper --from three-poses    (a task: linkwork synthesize)

    "linkwork view press.toml" opens it to draw on. Existing files are never
    overwritten.
    """
    path = Path(name)
    if path.name in ("", ".."):
        raise InputError(
            f'"{name}" is not the name of a file: write one, as in "linkwork new press"'
        )
    path = path if path.suffix else path.with_suffix(".toml")
    text = blank_sheet(path.stem) if model is None else _named(text_to_copy(model), path.stem)
    if path.exists():
        raise InputError(f'"{path}" exists already: choose another name, or open it')
    save_text(text, path)
    if as_json:
        print_json({"file": str(path)})
    else:
        click.echo(f"{path} was written. To draw on it: linkwork view {path}")


def _named(text: str, name: str) -> str:
    """A file's text under another name."""
    title = blank_sheet(name).splitlines()[1]
    return re.sub(r"(?m)^name\s*=.*$", lambda _: title, text, count=1)
