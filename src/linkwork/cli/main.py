"""The program ``linkwork``: its commands, and how errors become messages and exit codes."""

from __future__ import annotations

import sys
import traceback
from importlib import import_module
from keyword import iskeyword

import click

from linkwork.cli.interrupts import INTERRUPTED, was_interrupted
from linkwork.cli.options import DEBUG, JSON, debug_option
from linkwork.cli.problems import problem_data, problem_lines
from linkwork.cli.terminal import abandon_output, print_json, print_lines, ready_streams
from linkwork.foundation.errors import LinkworkError

__all__ = ["linkwork", "main"]

#: Each command is a function of this name in the module of this name.
_COMMANDS = (
    "check",
    "equations",
    "solve",
    "quantities",
    "sweep",
    "configurations",
    "circuits",
    "forces",
    "simulate",
    "sensitivity",
    "tolerance",
    "design",
    "draw",
    "plot",
    "animate",
    "new",
    "import",
    "view",
    "web",
    "link",
    "synthesize",
    "atlas",
    "code",
    "export",
    "robot",
    "report",
    "plates",
    "study",
    "compile",
    "examples",
    "schema",
)

_WRONG_INPUT = 2
_OUR_FAULT = 3
_READER_GONE = 128 + 13  # the shell's exit code after SIGPIPE


class _Program(click.Group):
    """The group of commands; it turns every error into a message and an exit code."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The commands in the order in which they are usually needed."""
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """A command, imported only when it is called: imports take most of a short run."""
        if cmd_name not in _COMMANDS:
            return None
        # a module cannot be called like a keyword of Python
        own = f"{cmd_name}_" if iskeyword(cmd_name) else cmd_name
        command: click.Command = getattr(import_module(f"linkwork.cli.{own}"), own)
        return command

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
