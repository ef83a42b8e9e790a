"""The command ``import``."""

from __future__ import annotations

import click

from linkwork.core.commands.options import check_outputs, file_argument, write_text
from linkwork.core.commands.terminal import (
    debug_option,
    json_option,
    print_json,
    print_lines,
    title_lines,
    wrapped,
)
from linkwork.core.textfile.writer import write_text as text_of
from linkwork.readers.importing import FORMATS, Imported, imported


@click.command("import")
@file_argument
@click.option("-o", "--output", metavar="PATH", help="Write this mechanism file (.toml).")
@click.option(
    "--as",
    "form",
    type=click.Choice(list(FORMATS)),
    help="The format, if suffix and content do not say it.",
)
@json_option
@debug_option
def import_command(file: str, output: str | None, form: str | None, as_json: bool) -> None:
    """Read a mechanism from a file of another program.

    PMKS and PMKS+ links and texts, pylinkage JSON, Linkage (.linkage2), Pyslvs
    expressions, GeoGebra (.ggb), DXF sketches, MJCF and URDF. The list says
    what was not carried over. Nothing in a file is executed.

    \b
      linkwork import crank.linkage2 -o crank.toml
      linkwork import sketch.dxf -o sketch.toml
      linkwork import "https://app.pmksplus.com/?..." -o pmks.toml
    """
    check_outputs(file, output)
    result = imported(file, form)
    text = text_of(result.description)
    if output is not None:
        write_text(output, [text])
    if as_json:
        print_json(_data(result) | {"written": [output] if output else [], "text": text})
    else:
        print_lines(_page(result, output))


def _data(imported: Imported) -> dict[str, object]:
    return {
        "format": imported.format,
        "name": imported.description.name,
        "carried": imported.carried,
        "renamed": dict(imported.renamed),
        "missing": imported.missing(),
        "left_out": [{"what": o.what, "places": list(o.places)} for o in imported.left_out],
    }


def _page(imported: Imported, output: str | None) -> list[str]:
    """Name and counts, changed names, omitted parts."""
    head, *notes = str(imported).splitlines()
    lines = [*title_lines(imported.description.name), *wrapped(head)]
    lines += [line for note in notes for line in wrapped(note, "  ", "    ")]
    if missing := imported.missing():
        lines += wrapped(f"still missing: {missing}", "  ", "    ")
    written = f"Wrote {output}." if output else "Nothing was written: add -o mechanism.toml"
    return [*lines, written]
