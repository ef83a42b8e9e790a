"""``linkwork equations``"""

from __future__ import annotations

import click

from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import debug_option, file_argument, json_option, set_option
from linkwork.cli.terminal import print_json, print_lines, title_lines
from linkwork.cli.text_table import WIDTH
from linkwork.equations.derivation import derivation
from linkwork.foundation.errors import InputError

__all__ = ["equations"]


@click.command
@file_argument
@click.option("--latex", "as_latex", is_flag=True, help="Print LaTeX displays.")
@click.option(
    "--derivation",
    "as_derivation",
    is_flag=True,
    help="Print a LaTeX document: loops, scalar equations, Newton-Raphson, rates.",
)
@set_option
@json_option
@debug_option
def equations(
    file: str, as_latex: bool, as_derivation: bool, changes: tuple[str, ...], as_json: bool
) -> None:
    """Show the loop-closure equations and the Jacobian.

    Linkwork derives the equations from the points and links of the file, or
    reads them from the file.

    \b
      linkwork equations rapier.toml
      linkwork equations rapier.toml --latex > equations.tex
      linkwork equations rapier.toml --derivation > rapier.tex
    """
    asked = {"--latex": as_latex, "--derivation": as_derivation, "--json": as_json}
    names = [name for name, is_asked in asked.items() if is_asked]
    if len(names) > 1:
        raise InputError(f"{' and '.join(names)} exclude each other: leave one out")
    mechanism = read_mechanism(file, changes)
    sheet = mechanism.equations()
    if as_json:
        print_json({"mechanism": mechanism.name, **sheet.to_dict()})
    elif as_derivation:
        click.echo(derivation(sheet, mechanism.name).rstrip("\n"))
    elif as_latex:
        click.echo(sheet.latex().rstrip("\n"))
    else:
        print_lines([*title_lines(mechanism.name), "", sheet.text(WIDTH).rstrip("\n")])
