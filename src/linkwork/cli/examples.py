"""``linkwork examples``"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from pathlib import Path

import click

from linkwork.api import examples as example_names
from linkwork.cli.mechanism_source import text_to_copy
from linkwork.cli.options import debug_option, json_option
from linkwork.cli.output_file import check_outputs, write_text
from linkwork.cli.terminal import fields, print_json, print_lines, title_lines
from linkwork.foundation.errors import InputError
from linkwork.viewer.live.task.templates import template_names

__all__ = ["examples"]

_NO_FAMILY = "other"


@click.command
@click.argument("name", required=False)
@click.option("-o", "--output", metavar="PATH", help="Write to this file.")
@click.option("--force", is_flag=True, help="Overwrite the file if it exists.")
@json_option
@debug_option
def examples(name: str | None, output: str | None, force: bool, as_json: bool) -> None:
    """List the mechanisms of the library and tasks to begin with, or copy one.

    \b
      linkwork examples
      linkwork examples rapier-drive
      linkwork examples rapier-drive -o rapier.toml
    """
    if name is None:
        if output is not None:
            raise InputError("-o needs the name of an example: linkwork examples NAME -o PATH")
        if as_json:
            print_json({"examples": _entries(example_names()), "tasks": _entries(template_names())})
        else:
            print_lines(_listing())
        return
    text = text_to_copy(name)
    if as_json and output is None:
        print_json({"name": name, "text": text})
        return
    if output is None or output == "-":
        click.echo(text, nl=False)
        return
    check_outputs("-", output)
    if Path(output).exists() and not force:
        raise InputError(f'"{output}" exists already: choose another name, or add --force')
    write_text(output, [text])
    if as_json:
        print_json({"written": [output]})
    else:
        command = "synthesize" if name in template_names() else "sweep"
        print_lines([f"Wrote {output}. Next: linkwork {command} {output}"])


def _entries(names: Iterable[str]) -> list[dict[str, str]]:
    """Name, title and family of files."""
    found = []
    for name in names:
        data = tomllib.loads(text_to_copy(name))
        title, family = str(data.get("name", "")), str(data.get("family", _NO_FAMILY))
        found.append({"name": name, "title": title, "family": family})
    return found


def _listing() -> list[str]:
    """Name and title of every example, by family, and of every task."""
    titles: dict[str, dict[str, str]] = {}
    for entry in _entries(example_names()):
        titles.setdefault(entry["family"], {})[entry["name"]] = entry["title"]
    lines: list[str] = []
    for family in sorted(titles, key=lambda family: (family == _NO_FAMILY, family.casefold())):
        lines += [*title_lines(family), *fields(titles[family].items()), ""]
    tasks = [(entry["name"], entry["title"]) for entry in _entries(template_names())]
    lines += [*title_lines("Tasks, for linkwork synthesize"), *fields(tasks), ""]
    return [*lines, "To copy an example: linkwork examples NAME -o FILE.toml"]
