"""The reference page of the command line, from the parser that reads it."""

from __future__ import annotations

from collections.abc import Iterator
from inspect import cleandoc

import click

from linkwork.core.commands.main import linkwork

__all__ = ["command_page"]


def command_page() -> str:
    """Every command with its usage, help, arguments and options, as one page of Markdown."""
    parts = ["# Command line\n"]
    for path, command in _commands(linkwork, "linkwork"):
        context = click.Context(command, info_name=path)
        usage = " ".join([path, *command.collect_usage_pieces(context)])
        parts.append(f"## `{path}`\n\n```text\n{usage}\n```\n")
        parts.append(_help(command))
        rows = [record for found in command.params if (record := found.get_help_record(context))]
        if rows:
            parts.append("| option | meaning |\n|---|---|")
            parts += [f"| `{_cell(name)}` | {_cell(text)} |" for name, text in rows]
            parts.append("")
    return "\n".join(parts)


def _commands(command: click.Command, path: str) -> Iterator[tuple[str, click.Command]]:
    """A command and all commands below it, in the order of the parser."""
    yield path, command
    if isinstance(command, click.Group):
        context = click.Context(command, info_name=path)
        for name in command.list_commands(context):
            below = command.get_command(context, name)
            if below is not None and not below.hidden:
                yield from _commands(below, f"{path} {name}")


def _help(command: click.Command) -> str:
    """The help as the terminal breaks it: paragraphs keep their lines."""
    text = cleandoc((command.help or "").split("\f")[0])
    text = "\n".join(line for line in text.splitlines() if line.strip(" ") != "\b")
    return f"```text\n{text}\n```\n" if text else ""


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
