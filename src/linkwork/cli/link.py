"""``linkwork link``"""

from __future__ import annotations

from pathlib import Path

import click

from linkwork.cli.mechanism_source import mechanism_of, text_of_source
from linkwork.cli.options import debug_option, file_argument, json_option, set_option
from linkwork.cli.output_file import check_outputs, write_bytes
from linkwork.cli.terminal import print_json
from linkwork.foundation.errors import InputError
from linkwork.textfile.link import link_of
from linkwork.textfile.writer import write_text
from linkwork.viewer.embedding import embed_snippet
from linkwork.viewer.qr_code import qr_png, qr_svg

__all__ = ["link"]


@click.command
@file_argument
@set_option
@click.option(
    "--app",
    metavar="URL",
    help="Address of a Linkwork app, before the #. Default: the part from the # on alone.",
)
@click.option("--qr", metavar="PATH", help="Write a QR code to this file: svg, png.")
@click.option("--embed", is_flag=True, help="Print HTML that shows the mechanism in a page.")
@click.option("--text", "as_text", is_flag=True, help="Print the mechanism file in FILE or a link.")
@json_option
@debug_option
def link(
    file: str,
    changes: tuple[str, ...],
    app: str | None,
    qr: str | None,
    embed: bool,
    as_text: bool,
    as_json: bool,
) -> None:
    """Print a link that contains the whole mechanism file.

    \b
      linkwork link rapier.toml --app https://example.org/lw/
      linkwork link rapier.toml --app https://example.org/lw/ --qr rapier.svg
      linkwork link rapier.toml --app https://example.org/lw/ --embed
      linkwork link "#lw1=..." --text > rapier.toml

    The mechanism follows the #; browsers do not send that part to servers.
    Every command reads a link, in quotes, where it wants a FILE.
    """
    _check(file, app, qr, embed)
    text, name = text_of_source(file)
    mechanism = mechanism_of(text, name, changes)
    if changes:
        text = write_text(mechanism.description)
    made = link_of(text, app)
    snippet = embed_snippet(made, mechanism.name) if embed else None
    written = [] if qr is None else [qr]
    if qr is not None:
        code = qr_svg(made).encode() if _suffix(qr) == ".svg" else qr_png(made)
        write_bytes(qr, [code])
    if as_json:
        found = {"link": made, "characters": len(made), "embed": snippet, "written": written}
        print_json(found | ({"text": text} if as_text else {}))
    elif as_text:
        click.echo(text, nl=False)
    else:
        # not wrapped: these are copied
        click.echo(made if snippet is None else snippet)
        for path in written:
            click.echo(f"Wrote {path}.")


def _check(file: str, app: str | None, qr: str | None, embed: bool) -> None:
    """Reject options that do not fit together, before anything is read."""
    for option, wanted in (("--qr", qr is not None), ("--embed", embed)):
        if wanted and app is None:
            raise InputError(
                f"{option} needs the address of a Linkwork app: add --app URL, as in "
                "--app https://example.org/linkwork/"
            )
    check_outputs(file, qr)
    if qr is not None and _suffix(qr) not in (".svg", ".png"):
        raise InputError(f'cannot write "{qr}": a QR code needs the suffix .svg or .png')


def _suffix(path: str) -> str:
    return Path(path).suffix.lower()
