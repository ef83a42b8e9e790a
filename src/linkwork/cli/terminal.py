"""Output to the terminal: UTF-8 streams, colour, wrapped text, progress bars."""

from __future__ import annotations

import io
import json
import math
import os
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import click

from linkwork.cli.interrupts import check_interrupt
from linkwork.cli.text_table import WIDTH

__all__ = [
    "abandon_output",
    "bad",
    "bold",
    "fields",
    "good",
    "print_json",
    "print_lines",
    "print_page",
    "progress",
    "ready_streams",
    "sentence",
    "title_lines",
    "wrapped",
]

Style = Callable[[str], str]

JSON_SCHEMA = 1  # increases when a key of the JSON output changes its meaning

_PATIENCE = 1.0  # seconds before a progress bar appears
_BAR_STEPS = 1000
_CLEAR_LINE = "\r\x1b[K"


def ready_streams() -> None:
    """Use UTF-8 for files and pipes; a terminal shows ? for letters outside its encoding.

    A stream that was closed before the start is replaced by the null device.
    """
    for name in ("stdout", "stderr"):
        # without a console, as under pythonw
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 - until exit
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            if stream.isatty():
                stream.reconfigure(errors="replace")
            else:
                stream.reconfigure(encoding="utf-8", errors="replace")


def abandon_output() -> None:
    """Discard all further output: the reader of the pipe has closed it."""
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        # Python flushes at exit and would fail again
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
    except (OSError, ValueError):  # a stream without a file cannot fail
        return


def print_lines(lines: Iterable[str], err: bool = False) -> None:
    """Print lines of text to the output, or to the error stream."""
    click.echo("\n".join(lines), err=err)


def print_page(page: Iterable[str], written: Sequence[str]) -> None:
    """Print the lines of a result, then those about files that were written."""
    print_lines([*page, *(["", *written] if written else [])])


def print_json(data: dict[str, Any]) -> None:
    """Print data as JSON: the version of the keys first, null for missing numbers."""
    versioned = {"schema": JSON_SCHEMA, **_finite(data)}
    click.echo(json.dumps(versioned, indent=2, ensure_ascii=False, allow_nan=False))


def print_written(path: str, as_json: bool, about: str = "", further: Sequence[str] = ()) -> None:
    """Say that a file was written, and which further ones with it."""
    if as_json:
        print_json({"written": [path, *further]})
    else:
        print_lines([f"Wrote {path}{about}."])


def _finite(data: Any) -> Any:
    match data:
        case dict():
            return {key: _finite(entry) for key, entry in data.items()}
        case list() | tuple():
            return [_finite(entry) for entry in data]
        case float():
            return data + 0.0 if math.isfinite(data) else None  # -0.0 becomes 0.0
        case _:
            return data


def title_lines(text: str) -> list[str]:
    """A title line."""
    return [bold(line) for line in wrapped(text)]


def bold(text: str) -> str:
    """Text in the style of titles."""
    return _styled(text, bold=True)


def good(text: str) -> str:
    """Text in the style of success."""
    return _styled(text, fg="green")


def bad(text: str) -> str:
    """Text in the style of failure."""
    return _styled(text, fg="red")


def _styled(text: str, **style: Any) -> str:
    """Styled text, unless colour is switched off (click removes styles outside a terminal)."""
    welcome = not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
    return click.style(text, **style) if welcome else text


def wrapped(text: str, first: str = "", rest: str | None = None) -> list[str]:
    """Text wrapped to the output's width: ``first`` before line 1, ``rest`` before the others.

    Control characters, which could come from a file, become ?.
    """
    # control characters of a file could change the terminal
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
    # styled after wrapping: escape sequences have no width
    return [first.replace(head, style(head), 1), *more]


def fields(
    pairs: Iterable[tuple[str, str]], styles: Mapping[str, Style] | None = None
) -> list[str]:
    """Labels with their texts in a column, wrapped; an empty label continues the one above."""
    entries = list(pairs)
    width = max((len(label) for label, _ in entries), default=0)
    lines: list[str] = []
    for label, text in entries:
        first, *rest = wrapped(text, f"  {label:<{width}}  ")
        if styles and label in styles:
            first = first.replace(label, styles[label](label), 1)
        lines += [first, *rest]
    return lines


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """A progress bar for tasks over one second, on the error stream of a terminal only.

    Only the label is shown until a task reports its first fraction.

    Yields
    ------
    callable
        A function to call with the finished fraction, 0 to 1.
    """
    if not sys.stderr.isatty():
        yield lambda fraction: check_interrupt()
        return
    began = time.monotonic()
    bar = click.progressbar(length=_BAR_STEPS, label=label, file=sys.stderr)
    shown, lock = False, threading.Lock()

    def say() -> None:
        with lock:
            if not shown:
                click.echo(f"{label} …", file=sys.stderr, nl=False)

    def tell(fraction: float) -> None:
        nonlocal shown
        check_interrupt()
        with lock:
            if not shown and time.monotonic() - began > _PATIENCE:
                shown = True
                click.echo(_CLEAR_LINE, file=sys.stderr, nl=False)
                bar.__enter__()
            if shown:
                # branches report in any order: the bar must not move backwards
                bar.update(max(int(_BAR_STEPS * fraction) - bar.pos, 0))

    timer = threading.Timer(_PATIENCE, say)
    timer.daemon = True
    timer.start()
    try:
        yield tell
    finally:
        timer.cancel()
        timer.join()
        if shown:
            bar.__exit__(None, None, None)
        elif time.monotonic() - began > _PATIENCE:
            click.echo(_CLEAR_LINE, file=sys.stderr, nl=False)
