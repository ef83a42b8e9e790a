"""Error messages as lines for a terminal."""

from __future__ import annotations

import sys
import traceback
from typing import Any

import click

from linkwork import wings
from linkwork.core.commands.terminal import (
    DEBUG,
    INTERRUPTED,
    JSON,
    abandon_output,
    debug_option,
    print_json,
    print_lines,
    ready_streams,
    was_interrupted,
    wrapped,
)
from linkwork.core.foundation.errors import LinkworkError, MechanismError, Problem, key_text

_WIDEST_KEY = 28  # longer keys are printed on a separate line
_FORMULA = "    "  # lines with this indent are formulas with a caret below, never wrapped


def problem_lines(error: LinkworkError) -> list[str]:
    """The message of an error in lines that fit the terminal; formulas keep their shape."""
    first, *rest = str(error).split("\n")
    lines = wrapped(first, "Error: ", "  ")
    if isinstance(error, MechanismError):
        return [*lines, *_listed(error.problems)]
    return lines + [line for text in rest for line in _wrapped_or_formula(text, "  ")]


def problem_data(error: LinkworkError) -> dict[str, Any]:
    """The message of an error for JSON; every problem of a file with its line and key."""
    if not isinstance(error, MechanismError):
        return {"error": str(error)}
    problems = [
        {"line": p.line, "key": key_text(p.key), "message": p.message} for p in error.problems
    ]
    return {"error": str(error), "problems": problems}


def _listed(problems: tuple[Problem, ...]) -> list[str]:
    """Line, key and message of every problem, in columns."""
    places = ["" if p.line is None else f"line {p.line}" for p in problems]
    keys = [key_text(p.key) for p in problems]
    place_width = max(map(len, places), default=0)
    key_width = max((len(key) for key in keys if len(key) <= _WIDEST_KEY), default=0)
    lines: list[str] = []
    for place, key, problem in zip(places, keys, problems, strict=True):
        head = f"  {place:<{place_width}}  " if place_width else "  "
        below = " " * (len(head) + (key_width + 2 if key_width else 0))
        message, *rest = problem.message.split("\n")
        # a long key has its own line instead of widening the column
        if len(key) > key_width:
            lines += [head + key, *wrapped(message, below)]
        else:
            lines += wrapped(message, f"{head}{key:<{key_width}}  " if key_width else head, below)
        for text in rest:
            lines += _wrapped_or_formula(text, below)
    return lines


def _wrapped_or_formula(text: str, indent: str) -> list[str]:
    return [text] if text.startswith(_FORMULA) else wrapped(text, indent)


# ----------------------------------------------------------------------
# The program ``linkwork``: its commands, and how errors become messages and exit codes.


_WRONG_INPUT = 2
_OUR_FAULT = 3
_READER_GONE = 128 + 13  # the shell's exit code after SIGPIPE


class _Program(click.Group):
    """The group of commands; it turns every error into a message and an exit code."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The commands of all wings."""
        return [name for wing in wings.wings() for name in wing.commands]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """A command, imported only when it is called: imports take most of a short run."""
        return wings.command(cmd_name)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The list of commands, wing by wing, without loading any."""
        for wing in wings.wings():
            if wing.commands:
                with formatter.section(wing.title):
                    formatter.write_dl(list(wing.commands.items()))

    def invoke(self, ctx: click.Context) -> object:
        """Run a command; turn an error into a message and an exit code."""
        try:
            return super().invoke(ctx)
        # click reports these itself
        except (click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except (Exception, KeyboardInterrupt) as error:
            if ctx.meta.get(JSON, False) and isinstance(error, LinkworkError):
                print_json(problem_data(error))
            ctx.exit(_ended_by(error, ctx.meta.get(DEBUG, False)))


def _ended_by(error: BaseException, debug: bool) -> int:
    """Print the message of an error; returns the exit code."""
    # head and less close the pipe early: not an error
    if isinstance(error, BrokenPipeError):
        abandon_output()
        return _READER_GONE
    if debug:
        click.echo(traceback.format_exc(), err=True)
    # a library may have turned the interrupt into an error of its own
    if was_interrupted() and not isinstance(error, KeyboardInterrupt):
        error = KeyboardInterrupt()
    match error:
        case KeyboardInterrupt():
            told = " ".join(["Interrupted", *map(str, error.args)])
            lines, code = ["", f"{told}."], INTERRUPTED
        case LinkworkError():
            lines, code = problem_lines(error), error.exit_code
        case MemoryError():
            lines, code = ["Error: not enough memory: ask for fewer rows"], _WRONG_INPUT
        case OSError():
            abandon_output()  # otherwise a full disk fails a second time at exit
            lines, code = [f"Error: {error.strerror or error}"], _WRONG_INPUT
        case _:
            lines, code = _apology(error, debug), _OUR_FAULT
    print_lines(lines, err=True)
    return code


def _apology(error: BaseException, debug: bool) -> list[str]:
    lines = [
        f"Linkwork failed: {type(error).__name__}: {error}",
        "This is an error in Linkwork, not in your input. Please report it with the",
        "mechanism file and the command you typed.",
    ]
    return lines if debug else [*lines, "Add --debug to print the traceback."]


@click.group(cls=_Program, invoke_without_command=True)
@click.version_option(package_name="linkwork", message="%(prog)s %(version)s")
@debug_option
@click.pass_context
def linkwork(context: click.Context) -> None:
    """Planar mechanisms, solved from their loop-closure equations.

    A first result in two commands:

    \b
      linkwork examples rapier-drive -o rapier.toml
      linkwork sweep rapier.toml --csv rapier.csv --draw rapier.png

    Then edit rapier.toml to describe your own mechanism.

    Every command that takes a FILE reads standard input for "-", and takes a
    link of Linkwork, in quotes, instead. Exit codes: 0 done, 1 a position was
    not found, 2 wrong input, 3 internal error (please report).
    """
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


def main() -> None:
    """Entry point of the installed program."""
    ready_streams()
    try:
        sys.exit(linkwork.main(prog_name="linkwork", standalone_mode=False))
    except click.Abort:  # an interrupt outside a command
        raise KeyboardInterrupt from None
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except OSError as error:  # of the text of --help
        sys.exit(_ended_by(error, debug=False))
