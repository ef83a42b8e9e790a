"""``linkwork animate``"""

from __future__ import annotations

import click

from linkwork.api import Mechanism
from linkwork.cli import picture
from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import (
    configuration_option,
    debug_option,
    file_argument,
    force_option,
    forces_of,
    json_option,
    set_option,
)
from linkwork.cli.output_file import check_outputs, write_bytes
from linkwork.cli.terminal import print_lines, print_written, progress
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion
from linkwork.viewer import FilmOptions, animation, check_animation

__all__ = ["animate"]


@click.command
@file_argument
@click.option(
    "-o",
    "--output",
    metavar="PATH",
    required=True,
    help="Page (.html) or film (.gif, .mp4, .apng, .webp).",
)
@click.option("--all", "every", is_flag=True, help="Write a page with all circuits.")
@click.option(
    "--sliders",
    metavar="NAME",
    multiple=True,
    help='A number that can be changed in the page, as "O2 A" (repeatable).',
)
@click.option(
    "--fps", type=float, default=25.0, show_default=True, help="Frames per second of a film."
)
@click.option("--rows", type=int, help="Number of positions in a film.")
@click.option("--no-certificates", is_flag=True, help="Skip the proofs (faster).")
@force_option
@configuration_option
@set_option
@json_option
@debug_option
@click.pass_context
def animate(
    context: click.Context,
    file: str,
    output: str,
    every: bool,
    sliders: tuple[str, ...],
    fps: float,
    rows: int | None,
    no_certificates: bool,
    forces: tuple[str, ...],
    configuration: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Write the motion as an animated page or a film.

    The page works offline in any browser. It plays the motion, follows the
    crank as you drag it, and shows plots and the certified numbers of every
    position.

    \b
      linkwork animate jansen.toml -o jansen.html --all
      linkwork animate jansen.toml -o jansen.gif --fps 20 --rows 60
      linkwork animate fourbar.toml -o crossed.mp4 --configuration crossed
      linkwork animate fourbar.toml -o page.html --sliders "O2 A" --sliders "A B"

    A page with sliders contains the solver of this mechanism: dragging a
    length solves and proves the whole cycle again, without a network.
    """
    options = FilmOptions(fps=fps, rows=rows)
    kind = check_animation(output, options)
    if every and kind != "html":
        raise InputError("--all needs a page: use the suffix .html")
    if every and configuration is not None:
        raise InputError("--all shows every circuit: leave out --configuration")
    if sliders and (kind != "html" or every or configuration is not None):
        raise InputError(
            "--sliders needs a page of the sketch's own branch: use the suffix .html, and leave "
            "out --all and --configuration"
        )
    if rows is not None and kind == "html":
        raise InputError("--rows is for films only: a page shows all rows")
    if forces and kind != "html":
        raise InputError("--force needs a page: use the suffix .html")
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    picture.check_points(mechanism)
    shown = forces_of(mechanism, forces)
    if sliders:
        motions = {"motion": mechanism.sweep(certify=not no_certificates)}
    else:
        motions = _motions(mechanism, every, configuration, certify=not no_certificates)
    if not any(motion.found.any() for motion in motions.values()):
        print_lines([f"Did not write {output}: there is no position to draw."], err=True)
        context.exit(1)
    solver = mechanism.solving_page(sliders, motions["motion"]) if sliders else None
    with progress("drawing") as tell:
        content = animation(
            motions,
            kind,
            options=options,
            equations=mechanism.equations().mathml(),
            loops=mechanism.moving_loops,
            forces=shown,
            solver=solver,
            progress=tell,
        )
    write_bytes(output, [content])
    about = f": {_told(motions, kind)}, {len(content) / 1000:.0f} kB"
    print_written(output, as_json, about)


def _motions(
    mechanism: Mechanism, every: bool, configuration: str | None, *, certify: bool
) -> dict[str, Motion]:
    if every:
        with progress("following circuits") as tell:
            return mechanism.cycles(certify=certify, progress=tell)
    with progress("sweeping") as tell:
        motion = mechanism.cycle(configuration=configuration, certify=certify, progress=tell)
    return {configuration or "motion": motion}


def _told(motions: dict[str, Motion], kind: str) -> str:
    rows = sum(int(motion.found.sum()) for motion in motions.values())
    if kind != "html":
        return "one cycle"
    circuits = f"{len(motions)} circuits, " if len(motions) > 1 else ""
    return f"{circuits}{rows} positions; open it in a browser"
