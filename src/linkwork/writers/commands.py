"""Commands that write files."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import click

from linkwork.circuits.results import Circuits
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.commands.options import (
    at_option,
    change_points_option,
    check_outputs,
    columns_option,
    configuration_option,
    file_argument,
    input_values,
    range_options,
    read_mechanism,
    set_option,
    through_option,
    write_bytes,
    write_table,
    write_text,
)
from linkwork.core.commands.sweep import answers, failure_line
from linkwork.core.commands.terminal import (
    bad,
    debug_option,
    good,
    json_option,
    print_json,
    print_lines,
    print_page,
    print_written,
    progress,
    sentence,
    table_lines,
    title_lines,
    wrapped,
)
from linkwork.core.drawing.matplotlib_writer import check_picture, write
from linkwork.core.drawing.scene import THEMES, theme_named
from linkwork.core.foundation.errors import InputError, choices
from linkwork.core.foundation.statuses import ChangePointPolicy
from linkwork.core.results.listing import Column
from linkwork.readers.importing import WRITERS, exported
from linkwork.writers.charts.plane import CIRCUIT_KINDS, MOTION_KINDS, circuits_plot, motion_plot
from linkwork.writers.code.programs import code_of, language_of
from linkwork.writers.plates.files import check_plate_file, plates_of
from linkwork.writers.plates.plate import PlateOptions, PlateStack
from linkwork.writers.plates.stack import stack_of
from linkwork.writers.report.report import check_report_file, write_report
from linkwork.writers.report.sections import template_of
from linkwork.writers.robot.files import check_robot_file, robot_of
from linkwork.writers.writing import kind_of, writers

_Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def _output_option(about: str) -> _Decorator:
    return click.option("-o", "--output", metavar="PATH", required=True, help=about)


def _common_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """``--set``, ``--json`` and ``--debug``."""
    return set_option(json_option(debug_option(command)))


# ----------------------------------------------------------------------
# ``linkwork plot``


@click.command("plot")
@file_argument
@_output_option("Picture file: .png, .svg, .pdf or .tikz.")
@columns_option(
    "Column of the table to plot; a point for path and hodograph; a pin for transmission. "
    "Default: unknowns and outputs, traced points, all pins."
)
@click.option(
    "--kind",
    type=click.Choice([*MOTION_KINDS, *CIRCUIT_KINDS]),
    default="curves",
    show_default=True,
    help="Kind of plot.",
)
@click.option("--against", metavar="NAME", default="", help="Plot over this column or over time.")
@click.option("--wrapped", is_flag=True, help="Reduce angles to one turn.")
@click.option(
    "--theme", type=click.Choice(list(THEMES)), default="light", show_default=True, help="Colours."
)
@range_options
@configuration_option
@through_option
@change_points_option
@_common_options
@click.pass_context
def plot_command(
    context: click.Context,
    /,
    file: str,
    output: str,
    names: tuple[str, ...],
    kind: str,
    against: str,
    wrapped: bool,
    theme: str,
    as_json: bool,
    changes: tuple[str, ...],
    **sweeping: Any,
) -> None:
    """Plot columns, paths, hodographs, transmission angles or circuits.

    \b
    curves        columns over the input, over time or over another column
    polar         columns as radii over the input angle
    path          paths of points in the plane
    hodograph     tips of the velocity and acceleration vectors of a point
    transmission  transmission angles with the band of 40 to 140 degrees
    circuits      unknowns over the input for every circuit, limits marked
    branches      as circuits, with one panel for each branch

    \b
      linkwork plot rapier.toml -o s16.png --columns s16 --columns s16.d1
      linkwork plot fourbar.toml -o time.svg --columns B.velocity --against time
      linkwork plot jansen.toml -o foot.png --kind hodograph --columns F
      linkwork plot rapier.toml -o quality.png --columns condition
    """
    check_picture(output)
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    colours = theme_named(theme, THEMES)
    if kind in CIRCUIT_KINDS:
        circuits = _circuits(mechanism, kind, {"against": against, "wrapped": wrapped, **sweeping})
        with progress("drawing"):
            write(circuits_plot(circuits, names, kind=kind), output, theme=colours)
        print_written(output, as_json)
        return
    with progress("sweeping") as tell:
        motion = mechanism.sweep(progress=tell, **sweeping)
    if motion.found.any():
        with progress("drawing"):
            chart = motion_plot(motion, names, kind=kind, against=against, wrapped=wrapped)
            write(chart, output, theme=colours)
        print_written(output, as_json)
    if not motion.found.all():
        print_lines(failure_line(motion), err=True)
        context.exit(0 if answers(motion, through=sweeping["through"]) else 1)


def _circuits(mechanism: Mechanism, kind: str, options: dict[str, Any]) -> Circuits:
    """Find the circuits; reject options of a sweep, which have no effect on whole circuits."""
    options["change_points"] = options["change_points"] != ChangePointPolicy.STOP.value
    spelled = {"from_": "from"}
    ignored = [
        f"--{spelled.get(name, name).replace('_', '-')}"
        for name, value in options.items()
        if value not in ("", None, False)
    ]
    if ignored:
        raise InputError(
            f"--kind {kind} shows whole circuits: leave out {', '.join(sorted(ignored))}"
        )
    with progress("following circuits") as tell:
        return mechanism.circuits(progress=tell)


# ----------------------------------------------------------------------
# ``linkwork export program``


@click.command("program")
@file_argument
@_output_option("Program file: .py (NumPy), .m (Octave, MATLAB), .c (C99), .js, .st (IEC 61131-3).")
@range_options
@configuration_option
@_common_options
def program_command(
    file: str, output: str, changes: tuple[str, ...], as_json: bool, **sweeping: Any
) -> None:
    """Write the solver as a program in another language.

    The program has a function of the input that returns every unknown, point
    and output with its derivatives, and a main program that prints the table
    as CSV. It needs no Linkwork.

    \b
      linkwork export rapier.toml -o rapier.py
      linkwork export rapier.toml -o rapier.c --from 0 --to 90 --step 0.5
      linkwork export fourbar.toml -o crossed.js --configuration crossed
    """
    path = Path(output)
    language_of(path)
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    with progress("sweeping") as tell:
        motion = mechanism.sweep(progress=tell, **sweeping)
    with progress("writing the program"):
        text = code_of(mechanism.model, motion, path)
    write_text(output, [text])
    print_written(output, as_json)


# ----------------------------------------------------------------------
# ``linkwork export report``


@click.command("report")
@file_argument
@_output_option("Report: .html, .pdf, .docx or .md.")
@click.option(
    "--template",
    metavar="NAME",
    default="engineer",
    show_default=True,
    help="engineer, student, or a template file, which names the sections.",
)
@click.option("--title", metavar="TEXT", help="The title; by default the mechanism's name.")
@click.option("--author", metavar="TEXT", help="Who writes the report.")
@click.option("--institution", metavar="TEXT", help="University, company or course.")
@click.option("--date", metavar="TEXT", help="The date as it is printed; none by default.")
@at_option
@configuration_option
@_common_options
def report_command(
    file: str,
    output: str,
    template: str,
    at: tuple[str, ...],
    configuration: str | None,
    changes: tuple[str, ...],
    as_json: bool,
    **head: str | None,
) -> None:
    """Write a report of the mechanism.

    For a design file or as homework: equations, drawings, tables, plots,
    circuits, forces, what is proved, and the file itself. Sections without
    content are named with the reason. Markdown has its pictures in the folder
    NAME-pictures next to it.

    \b
      linkwork export rapier.toml -o rapier.html
      linkwork export rapier.toml -o rapier.pdf --template student --at 60
      linkwork export press.toml -o press.docx --author "A. Student"
    """
    check_report_file(Path(output))
    check_outputs(file, output)
    template_of(template)
    mechanism = read_mechanism(file, changes)
    values = input_values(mechanism, at)
    with progress("writing the report") as tell:
        written = write_report(
            mechanism,
            output,
            values,
            template=template,
            configuration=configuration,
            progress=tell,
            **head,
        )
    _report, *pictures = map(str, written)
    about = f", with pictures in {written[1].parent}: {len(pictures)}" if pictures else ""
    print_written(output, as_json, about, pictures)


# ----------------------------------------------------------------------
# ``linkwork export plates``


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


def _size_options(command: Callable[..., Any]) -> Callable[..., Any]:
    for name, about in reversed(_SIZES):
        command = click.option(f"--{name}", type=float, metavar="LENGTH", help=about)(command)
    return command


@click.command("plates")
@file_argument
@_output_option("File of plates: .dxf, .svg, .stl, .3mf or .step.")
@_size_options
@click.option("--labels", is_flag=True, help="Write every plate's name on it, to be engraved.")
@click.option("--layout", is_flag=True, help="Put the plates side by side on a sheet.")
@click.option("--bill", metavar="PATH", help="Write the bill of materials as CSV.")
@range_options
@configuration_option
@_common_options
def plates_command(
    file: str,
    output: str,
    labels: bool,
    layout: bool,
    bill: str | None,
    changes: tuple[str, ...],
    as_json: bool,
    **given: Any,
) -> None:
    """Write the links as plates to cut or print.

    Links are bars, or plates with arms between three or more holes, the
    ground is a base plate. They lie in layers in which nothing collides over
    the whole table, which is proved if possible. Sizes are in the length unit
    of the file, by default in proportion to the mechanism. Without --layout
    the plates are assembled.

    \b
      linkwork export fourbar.toml -o fourbar.dxf --layout --kerf 0.15
      linkwork export fourbar.toml -o fourbar.3mf --layout --bill bill.csv
      linkwork export plates fourbar.toml -o fourbar.svg --width 14 --pin 4
    """
    path = Path(output)
    check_plate_file(path)
    check_outputs(file, output, bill, as_json=as_json)
    sizes = {name: given.pop(name) for name, _ in _SIZES}
    chosen = {name: size for name, size in sizes.items() if size is not None}
    options = PlateOptions(labels=labels, **chosen)
    mechanism = read_mechanism(file, changes)
    with progress("sweeping") as tell:
        motion = mechanism.sweep(progress=tell, **given)
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
    """The bill of materials, and the result of the collision check."""
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


# ----------------------------------------------------------------------
# ``linkwork export robot``


@click.command("robot")
@file_argument
@_output_option("Robot file: .mjcf, .urdf or .sdf.")
@at_option
@configuration_option
@_common_options
def robot_command(
    file: str,
    output: str,
    at: tuple[str, ...],
    configuration: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Write the mechanism for a simulator of robots.

    MJCF (MuJoCo) has the real loops, SDF all joints; URDF has a tree whose
    joints follow the driven one, their polynomials and limits. All joint
    values are zero in the start position, --at.

    \b
      linkwork export fourbar.toml -o fourbar.mjcf
      linkwork export fourbar.toml -o fourbar.urdf --at 60
    """
    path = Path(output)
    suffix = check_robot_file(path)
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    start = mechanism.solve(input_values(mechanism, at), configuration=configuration)
    motion = None
    if suffix == ".urdf":
        with progress("sweeping") as tell:
            motion = mechanism.sweep(configuration=configuration, progress=tell)
    write_text(output, [robot_of(mechanism.model, start, motion, path)])
    print_written(output, as_json)


# ----------------------------------------------------------------------
# ``linkwork export pmks``, and the other formats that are texts


def _text_command(form: str) -> click.Command:
    @click.command(form)
    @file_argument
    @click.option(
        "-o", "--output", metavar="PATH", help="Write to this file instead of the terminal."
    )
    @at_option
    @configuration_option
    @_common_options
    def command(
        file: str,
        output: str | None,
        at: tuple[str, ...],
        configuration: str | None,
        changes: tuple[str, ...],
        as_json: bool,
    ) -> None:
        """Write the mechanism as a text of another program.

        pmks is a link of PMKS+, pylinkage JSON, pyslvs an expression of Pyslvs, in the
        start position, --at. What is left out is listed on the error stream.

        \b
          linkwork export pmks hoeken
          linkwork export pylinkage fourbar.toml -o fourbar.json
        """
        check_outputs(file, output)
        mechanism = read_mechanism(file, changes)
        made = exported(mechanism, form, input_values(mechanism, at), configuration=configuration)
        if output is not None:
            write_text(output, [made.text])
        if as_json:
            notes = [{"what": part.what, "places": list(part.places)} for part in made.left_out]
            print_json(
                {"text": made.text, "left_out": notes, "written": [output] if output else []}
            )
            return
        click.echo(made.text if output is None else f"Wrote {output}.\n", nl=False)
        lines = [line for part in made.left_out for line in wrapped(f"left out: {part}", "", "  ")]
        if lines:
            print_lines(lines, err=True)

    return command


# ----------------------------------------------------------------------
# ``linkwork export``


def _usual_command(kind: str) -> click.Command:
    """The command of a kind of file that has no options."""

    @click.command(kind, help=f"Write a {kind}.")
    @file_argument
    @_output_option("The file.")
    @_common_options
    def command(file: str, output: str, changes: tuple[str, ...], as_json: bool) -> None:
        is_book = output.lower().endswith(".xlsx")
        check_outputs(file, None if is_book else output, workbook=output if is_book else None)
        mechanism = read_mechanism(file, changes)
        with progress(f"writing the {kind}"):
            mechanism.write(output, kind)
        print_written(output, as_json)

    return command


_COMMANDS = {
    "program": program_command,
    "report": report_command,
    "plates": plates_command,
    "robot": robot_command,
    **{form: _text_command(form) for form in WRITERS},
}


class _Export(click.Group):
    """One command for each kind of file; the suffix of the file chooses it, or its name does."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(dict.fromkeys([*_COMMANDS, *writers()]))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name in _COMMANDS:
            return _COMMANDS[cmd_name]
        return _usual_command(cmd_name) if cmd_name in writers() else None

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        first = args[0] if args else "--help"
        if not first.startswith("-") and first not in self.list_commands(ctx):
            places = [k + 1 for k, word in enumerate(args) if word in ("-o", "--output")]
            if not places or places[-1] >= len(args):
                raise InputError(
                    "name the file, linkwork export FILE -o PATH, or the kind "
                    f"{choices('kinds', self.list_commands(ctx))}"
                )
            args = [kind_of(args[places[-1]]), *args]
        return super().parse_args(ctx, args)


@click.group("export", cls=_Export, subcommand_metavar="[KIND] FILE -o PATH")
@debug_option
def export_command() -> None:
    """Write a workbook, program, report, plates, robot or text.

    The suffix of the file chooses the kind, which can also be named;
    "linkwork export KIND --help" lists its options.

    \b
      linkwork export rapier.toml -o rapier.xlsx
      linkwork export rapier.toml -o rapier.c
      linkwork export rapier.toml -o plates.dxf
      linkwork export rapier.toml -o rapier.pdf
    """
