"""``linkwork examples``"""

from __future__ import annotations

import tomllib
from pathlib import Path
from textwrap import shorten

import click

from linkwork.cli.options import debug_option
from linkwork.cli.output_file import check_outputs, write_text
from linkwork.cli.terminal import bold, print_lines, sentence
from linkwork.cli.text_table import WIDTH
from linkwork.everyday import example_text
from linkwork.everyday import examples as example_names
from linkwork.foundation.errors import InputError

__all__ = ["examples"]


@click.command
@click.argument("name", required=False)
@click.option("-o", "--output", metavar="PATH", help="Write to this file.")
@click.option("--force", is_flag=True, help="Overwrite the file if it exists.")
@debug_option
def examples(name: str | None, output: str | None, force: bool) -> None:
    """List the mechanisms of the library, or get one.

    \b
      linkwork examples
      linkwork examples rapier-drive
      linkwork examples rapier-drive -o rapier.toml
    """
    if name is None:
        if output is not None:
            raise InputError("-o needs the name of an example: linkwork examples NAME -o PATH")
        print_lines(_listing())
        return
    text = example_text(name)
    if output is None or output == "-":
        click.echo(text, nl=False)
        return
    check_outputs("-", output)
    if Path(output).exists() and not force:
        raise InputError(f'"{output}" exists already: choose another name, or add --force')
    write_text(output, [text])
    print_lines([f"Wrote {output}. Next: linkwork sweep {output}"])


def _listing() -> list[str]:
    """Name, title and one line about every example."""
    lines: list[str] = []
    for name in example_names():
        data = tomllib.loads(example_text(name))
        lines += sentence(bold, name, f" {data.get('name', '')}", "    ")
        if source := data.get("source"):
            lines.append(shorten(source, WIDTH, initial_indent="    ", placeholder=" …"))
    return [*lines, "", "To start from one: linkwork examples NAME -o FILE.toml"]
