"""``linkwork plates``"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import (
    configuration_option,
    debug_option,
    file_argument,
    json_option,
    range_options,
    set_option,
)
from linkwork.cli.output_file import check_outputs, write_bytes, write_table
from linkwork.cli.terminal import (
    bad,
    good,
    print_json,
    print_page,
    progress,
    sentence,
    title_lines,
)
from linkwork.cli.text_table import table_lines
from linkwork.export import PlateOptions, PlateStack, check_plate_file, plates_of, stack_of
from linkwork.foundation.errors import InputError
from linkwork.mechanism.dimensions import Number
from linkwork.results.listing.column import Column

__all__ = ["plates"]

_SIZES = (
    ("width", "Width of bars."),
    ("fillet", "Radius of inner corners between the arms of plates."),
    ("pin", "Diameter of pins."),
    ("clearance", "Diameter of holes minus that of pins."),
    ("kerf", "Width of the cut, halved on either side."),
    ("thickness", "Thickness of plates."),
    ("gap", "Least distance of moving plates in one layer."),
    ("module", "Module of gears that are given by radii."),
    ("backlash", "Backlash of gears on the pitch circle."),
    ("sheet", "Width of the sheet of --layout."),
)


def _size_options(command: Any) -> Any:
    for name, about in reversed(_SIZES):
        command = click.option(f"--{name}", type=float, metavar="LENGTH", help=about)(command)
    return command


@click.command
@file_argument
@click.option(
    "-o",
    "--output",
    metavar="PATH",
    required=True,
    help="File of plates: .dxf, .svg, .stl, .3mf or .step.",
)
@_size_options
@click.option("--labels", is_flag=True, help="Write every plate's name on it, to be engraved.")
@click.option("--layout", is_flag=True, help="Put the plates side by side on a sheet.")
@click.option("--bill", metavar="PATH", help="Write the bill of materials as CSV.")
@range_options
@configuration_option
@set_option
@json_option
@debug_option
def plates(
    file: str,
    output: str,
    labels: bool,
    layout: bool,
    bill: str | None,
    start: Number | None,
    stop: Number | None,
    step: Number | None,
    configuration: str | None,
    changes: tuple[str, ...],
    as_json: bool,
    **sizes: float | None,
) -> None:
    """Write the links as plates to cut or print.

    Links are bars, or plates with arms between three or more holes, the
    ground is a base plate. They lie in layers in which nothing collides over
    the whole table, which is proved if possible. Sizes are in the length unit
    of the file, by default in proportion to the mechanism. Without --layout
    the plates are assembled.

    \b
      linkwork plates fourbar.toml -o fourbar.dxf --layout --kerf 0.15
      linkwork plates fourbar.toml -o fourbar.3mf --layout --bill bill.csv
      linkwork plates fourbar.toml -o fourbar.svg --width 14 --pin 4
    """
    path = Path(output)
    check_plate_file(path)
    check_outputs(file, output, bill, as_json=as_json)
    chosen = {name: size for name, size in sizes.items() if size is not None}
    options = PlateOptions(labels=labels, **chosen)
    mechanism = read_mechanism(file, changes)
    with progress("sweeping") as tell:
        motion = mechanism.sweep(
            start=start, stop=stop, step=step, configuration=configuration, progress=tell
        )
    with progress("choosing layers") as tell:
        stack = stack_of(mechanism.model, motion, options, tell)
    with progress("writing the plates"):
        content = plates_of(stack, path, layout=layout)
    write_bytes(output, [content])
    try:
        written = [f"Wrote {output}.", *write_table(bill, stack.bill())]
    except InputError as error:
        raise InputError(f"{error}; the plates are written to {output}") from None
    if as_json:
        names = [name for name in (output, bill) if name is not None]
        print_json({"written": names, **stack.to_dict()})
    elif bill != "-":
        print_page(_page(stack), written)


def _page(stack: PlateStack) -> Iterator[str]:
    """The bill of materials, and what is known of collisions."""
    count = f"{len(stack.plates)} plates in {stack.layers} layers"
    yield from title_lines(f"{stack.mechanism}: {count}")
    yield from table_lines(list(_columns(stack)))
    yield ""
    sizes = stack.sizes
    about = f"Holes {sizes.hole:g} mm, pins {sizes.pin:g} mm, bars {sizes.width:g} mm wide."
    yield from sentence(str, about)
    verdict = f"{stack.verdict[0].upper()}{stack.verdict[1:]}."
    yield from sentence(good if stack.proved else bad, verdict)
    for note in stack.notes:
        yield from sentence(str, f"Note: {note}.")


def _columns(stack: PlateStack) -> Iterator[Column]:
    bill = stack.bill()
    low, high = (bill[name].tolist() for name in ("lowest layer", "highest layer"))
    layers = [f"{a}" if a == b else f"{a} to {b}" for a, b in zip(low, high, strict=True)]
    for name in ("kind", "name"):
        yield Column(header=name, cells=bill[name].tolist())
    yield Column(header="layer", cells=layers)
    for name in ("length", "diameter", "area", "holes"):
        unit, values = bill.units[name], bill[name].tolist()
        header = f"{name} {unit}".rstrip()
        yield Column(header=header, cells=[_cell(x) for x in values], align="point")


def _cell(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.6g}"
