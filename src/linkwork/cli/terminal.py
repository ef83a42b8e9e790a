"""The terminal: streams that can write Greek, sparse colour, wrapped text, progress."""

from __future__ import annotations

import io
import json
import math
import os
import sys
import textwrap
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import click

from linkwork.cli.text_table import WIDTH

__all__ = [
    "abandon_output",
    "bad",
    "bold",
    "fields",
    "good",
    "print_json",
    "print_lines",
    "progress",
    "ready_streams",
    "sentence",
    "title_lines",
    "wrapped",
]

Style = Callable[[str], str]

JSON_SCHEMA = 1  # counts up when a key of the JSON output changes its meaning

_PATIENCE = 1.0  # seconds before a progress bar appears
_BAR_STEPS = 1000


def ready_streams() -> None:
    """Files and pipes get UTF-8; a terminal shows ? for letters that it does not have.

    A stream that was closed before we started is replaced by one that goes nowhere.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 - until exit
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            if stream.isatty():
                stream.reconfigure(errors="replace")
            else:
                stream.reconfigure(encoding="utf-8", errors="replace")


def abandon_output() -> None:
    """Write to nowhere from now on: whoever read our output has gone away."""
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
    except (OSError, ValueError):  # a stream without a file: nothing can break
        return


def print_lines(lines: Iterable[str], err: bool = False) -> None:
    """Lines of text to the output, or to the error stream."""
    click.echo("\n".join(lines), err=err)


def print_json(data: dict[str, Any]) -> None:
    """Data as JSON: the version of its keys first, null for numbers that there are not."""
    versioned = {"schema": JSON_SCHEMA, **_finite(data)}
    click.echo(json.dumps(versioned, indent=2, ensure_ascii=False, allow_nan=False))


def _finite(data: Any) -> Any:
    match data:
        case dict():
            return {key: _finite(entry) for key, entry in data.items()}
        case list() | tuple():
            return [_finite(entry) for entry in data]
        case float():
            return data if math.isfinite(data) else None
        case _:
            return data


def title_lines(text: str) -> list[str]:
    """The title of what follows."""
    return [bold(line) for line in wrapped(text)]


def bold(text: str) -> str:
    """Something to find again at a glance."""
    return _styled(text, bold=True)


def good(text: str) -> str:
    """Something that succeeded."""
    return _styled(text, fg="green")


def bad(text: str) -> str:
    """Something that needs attention."""
    return _styled(text, fg="red")


def _styled(text: str, **style: Any) -> str:
    """Styled on a terminal (elsewhere click takes the style off again), if colour is welcome."""
    welcome = not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
    return click.style(text, **style) if welcome else text


def wrapped(text: str, first: str = "", rest: str | None = None) -> list[str]:
    """Text in lines of the output's width behind ``first``, the later ones behind ``rest``.

    Control characters, which a file may carry into a terminal, become ?.
    """
    printable = "".join(c if c.isprintable() or c.isspace() else "?" for c in text)
    return textwrap.wrap(
        printable,
        WIDTH,
        initial_indent=first,
        subsequent_indent=" " * len(first) if rest is None else rest,
        break_long_words=False,
        break_on_hyphens=False,
    ) or [first.rstrip()]


def sentence(style: Style, head: str, rest: str = "", indent: str = "") -> list[str]:
    """A wrapped sentence whose beginning is styled; ``indent`` is that of its later lines."""
    first, *more = wrapped(f"{head} {rest}", "", indent)
    return [first.replace(head, style(head), 1), *more]


def fields(
    pairs: Iterable[tuple[str, str]], styles: Mapping[str, Style] | None = None
) -> list[str]:
    """Labels with their texts in a column, wrapped; an empty label continues the one above."""
    entries = list(pairs)
    width = max(len(label) for label, _ in entries)
    lines: list[str] = []
    for label, text in entries:
        first, *rest = wrapped(text, f"  {label:<{width}}  ")
        if styles and label in styles:
            first = first.replace(label, styles[label](label), 1)
        lines += [first, *rest]
    return lines


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """A bar for what takes longer than a second, on the error stream of a terminal only.

    Yields
    ------
    callable
        To be told the finished fraction, 0 to 1.
    """
    if not sys.stderr.isatty():
        yield lambda fraction: None
        return
    began = time.monotonic()
    bar = click.progressbar(length=_BAR_STEPS, label=label, file=sys.stderr)
    shown = False

    def tell(fraction: float) -> None:
        nonlocal shown
        if not shown and time.monotonic() - began > _PATIENCE:
            shown = True
            bar.__enter__()
        if shown:
            bar.update(max(int(_BAR_STEPS * fraction) - bar.pos, 0))

    try:
        yield tell
    finally:
        if shown:
            bar.__exit__(None, None, None)
