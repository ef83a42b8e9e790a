"""Ctrl-C: one quiet end, whatever the program does at that moment.

Python raises ``KeyboardInterrupt`` at whatever instruction runs. Two kinds of code lose it: CPython
drops every exception of an object that is being deleted, and some libraries turn all exceptions
into their own. So the interrupt is remembered too.
"""

from __future__ import annotations

import _thread
import atexit
import io
import json
import math
import os
import signal
import sys
import textwrap
import threading
import time
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from types import FrameType
from typing import TYPE_CHECKING, Any, NoReturn

import click

if TYPE_CHECKING:
    from linkwork.core.results.listing import Column

#: The shell's exit code after SIGINT.
INTERRUPTED = 128 + 2

_LATER = 0.02  # seconds after which a deletion has ended
_came = threading.Event()


def watch_interrupts() -> None:
    """Remember interrupts, unless the program runs in the background and ignores them."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)
    sys.unraisablehook = _interrupt_again


def was_interrupted() -> bool:
    """Whether Ctrl-C has been pressed."""
    return _came.is_set()


def check_interrupt() -> None:
    """Raise an interrupt once more that a library has dropped; long work calls this regularly."""
    if _came.is_set():
        raise KeyboardInterrupt


def answer_interrupt() -> None:
    """Forget an interrupt that has ended a search whose best results are kept."""
    _came.clear()


def ignore_interrupts() -> None:
    """The exit code stays what it is, whenever Ctrl-C was pressed or is pressed from now on."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # An interrupt of text that is executed, as in the making of a dataclass, has CPython end the
    # process by the signal even if it is caught; the next text that is executed revokes that.
    exec("")


def leave(code: int) -> NoReturn:
    """End the process at once: what is registered for its end is done, objects are not deleted.

    Deleting them takes a third of a second once compiled code is loaded.
    """
    ignore_interrupts()
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # the reader may be gone
            stream.flush()
    os._exit(code)


def _interrupt(number: int, frame: FrameType | None) -> None:
    _came.set()
    signal.default_int_handler(number, frame)


def _interrupt_again(lost: sys.UnraisableHookArgs) -> None:
    """Repeat an interrupt that came while an object was deleted."""
    if lost.exc_type is KeyboardInterrupt:
        threading.Timer(_LATER, _thread.interrupt_main).start()
    else:
        sys.__unraisablehook__(lost)


# ----------------------------------------------------------------------
# Plain tables for a terminal: numbers as text, columns aligned at the decimal point.


#: Characters of a line of output.
WIDTH = 80

_GAP = 2
_INDENT = 2


def table_lines(columns: Sequence[Column], width: int = WIDTH) -> list[str]:
    """The lines of a table, header first.

    Columns that do not fit the width follow below, after the first column repeated. If even
    two columns are too wide, the cells of the first column are shortened. No columns, no lines.
    """
    if not columns:
        return []
    first, *others = columns
    lines: list[str] = []
    while True:
        widest = max((_width(_lines(column)[0]) for column in others[:1]), default=0)
        first = _shortened(first, width - _INDENT - _GAP - widest)
        used = _INDENT + _width(_lines(first)[0])
        count = 0
        for column in others:
            used += _GAP + _width(_lines(column)[0])
            # at least one column in each block, of any width
            if used > width and count:
                break
            count += 1
        here, others = [first, *others[:count]], others[count:]
        joined = zip(*map(_lines, here), strict=True)
        lines += [(" " * _INDENT + (" " * _GAP).join(cells)).rstrip() for cells in joined]
        if not others:
            return lines
        lines.append("")


def _lines(column: Column) -> list[str]:
    """The header and the cells, padded to one width."""
    cells = _at_point(column.cells) if column.align == "point" else list(column.cells)
    width = max(map(_width, (column.header, *cells)))
    lines = [_padded(cell, width, column.align != "left") for cell in (column.header, *cells)]
    if not any(column.units):
        return lines
    room = max(map(_width, column.units))
    units = [_padded(unit, room, False) for unit in ("", *column.units)]
    return [f"{line} {unit}" for line, unit in zip(lines, units, strict=True)]


def _at_point(cells: Sequence[str]) -> list[str]:
    """Cells padded on both sides so that decimal points align."""
    wholes = [cell.partition(".")[0] for cell in cells]
    parts = [cell[len(whole) :] for cell, whole in zip(cells, wholes, strict=True)]
    left = max(map(len, wholes), default=0)
    right = max(map(len, parts), default=0)
    return [f"{w:>{left}}{p:<{right}}" for w, p in zip(wholes, parts, strict=True)]


def _shortened(column: Column, room: int) -> Column:
    cells = [_cut(cell, max(room, 8)) for cell in column.cells]
    return replace(column, cells=cells)


def _cut(text: str, room: int) -> str:
    """The text with its middle replaced by … if it is too long."""
    if _width(text) <= room:
        return text
    head = (room - 1) // 2
    return f"{text[:head]}…{text[len(text) - (room - 1 - head) :]}"


def _padded(text: str, width: int, right: bool) -> str:
    space = " " * (width - _width(text))
    return space + text if right else text + space


def _width(text: str) -> int:
    """The number of terminal cells that the text occupies."""
    return sum(
        # combining marks take no cell, East Asian characters two
        0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1
        for c in text
    )


# ----------------------------------------------------------------------
# Output to the terminal: UTF-8 streams, colour, wrapped text, progress bars.


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


#: Key of ``click.Context.meta`` that stores ``--debug``.
DEBUG = "linkwork.debug"


#: Key that stores ``--json``.
JSON = "linkwork.json"


Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def _note_debug(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted:
        context.meta[DEBUG] = True


debug_option: Decorator = click.option(
    "--debug",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_note_debug,
    help="Show the traceback of an error.",
)


def _note_json(context: click.Context, _: click.Parameter, wanted: bool) -> bool:
    context.meta[JSON] = wanted
    return wanted


json_option: Decorator = click.option(
    "--json", "as_json", is_flag=True, is_eager=True, callback=_note_json, help="Print JSON."
)
