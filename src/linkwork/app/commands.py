"""Commands of the app."""

from __future__ import annotations

import os
import threading
import webbrowser
from collections.abc import Callable, Mapping
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING

import click

from linkwork.app.live.opened_file import MechanismFile, new_file
from linkwork.app.live.server import LiveServer
from linkwork.app.live.session import Bench
from linkwork.app.pages.offline_page import embed_snippet, qr_png, qr_svg
from linkwork.app.web.web_app import MARK, pyodide_files, web_folder, web_page
from linkwork.core.api.making import loads
from linkwork.core.commands.options import (
    check_outputs,
    file_argument,
    mechanism_of,
    names_to_copy,
    set_option,
    text_of_source,
    text_to_copy,
    write_bytes,
)
from linkwork.core.commands.terminal import (
    debug_option,
    json_option,
    print_json,
    print_lines,
    print_written,
    progress,
    title_lines,
)
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import check_place, written_folder
from linkwork.core.textfile.link import is_link, link_of, text_of_link
from linkwork.core.textfile.reader import blank_sheet
from linkwork.core.textfile.writer import write_text

if TYPE_CHECKING:
    from linkwork.synthesis.solvers.result import Synthesis
    from linkwork.synthesis.suggesting import Suggesting
    from linkwork.synthesis.tasks.task import Task
from functools import partial

from linkwork.app.pages.animation import FilmOptions, animation, check_animation, solving_page
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.commands.options import (
    configuration_option,
    force_option,
    forces_of,
    read_mechanism,
)
from linkwork.core.commands.sweep import check_points
from linkwork.core.motion.iterating import moving_loops
from linkwork.core.results.motion import Motion

# ----------------------------------------------------------------------
# ``linkwork view``


def _opened(file: str) -> MechanismFile:
    """A file, or a text that is written when it is saved: a mechanism of the library or of a link,
    a task to begin with, or a blank sheet.
    """
    if is_link(file) and not os.path.exists(file):
        return _of_link(text_of_link(file))
    if Path(file).exists() or file not in names_to_copy():
        path = Path(file)
        named = path if path.suffix or path.exists() else path.with_suffix(".toml")
        return MechanismFile(named, blank_sheet(path.stem))
    path = Path(f"{file}.toml")
    if path.exists():
        raise InputError(
            f'there is a file "{path}" already: to open it, linkwork view {path}; to open the '
            "example, go to another folder"
        )
    return MechanismFile(path, text_to_copy(file))


def _of_link(text: str) -> MechanismFile:
    """The mechanism of a link under the first free name."""
    taken = (Path(f"linked{k}.toml") for k in count(2))
    path = next(path for path in chain([Path("linked.toml")], taken) if not path.exists())
    return MechanismFile(path, text)


def _solve_task(task: Task, *, progress: Callable[[float], None] | None = None) -> Synthesis:
    from linkwork.synthesis.solvers.solving import solve_task  # the first time a task is solved

    return solve_task(task, progress=progress)


def _suggesting() -> Suggesting:
    from linkwork.synthesis import suggesting  # the first time designs are suggested

    return suggesting


def _opened_lines(name: str, address: str) -> list[str]:
    return [
        *title_lines(f"{name} is open at"),
        f"  {address}",
        "Anyone who knows this address can edit the file. Stop with Ctrl-C.",
    ]


@click.command("view")
@click.argument("file", metavar="[FILE]", required=False)
@click.option(
    "--port",
    metavar="NUMBER",
    type=click.IntRange(0, 65535),
    default=0,
    help="Port of the page. Default: any free port.",
)
@click.option("--no-browser", is_flag=True, help="Print the address, but do not open a browser.")
@json_option
@debug_option
def view_command(file: str | None, port: int, no_browser: bool, as_json: bool) -> None:
    """Open the app: draw, edit and show a mechanism in a browser.

    It runs until Ctrl-C, and also designs mechanisms for tasks. Without FILE
    the page begins with the library, a blank sheet and tasks.

    \b
      linkwork view
      linkwork view rapier.toml   (a blank sheet, if there is no such file)
      linkwork view task.toml     (a task: its designs)
      linkwork view four-bar      (of the library: saved as four-bar.toml)
      linkwork view five-poses    (a task to begin with)
      linkwork view "LINK"        (saved as linked.toml)
      linkwork view rapier.toml --port 8123 --no-browser

    Only programs on this machine that know the printed address can open the
    page. At the end, unsaved changes are written to a file next to FILE.
    """
    if file == "-":
        raise InputError("standard input cannot be edited and saved: give the name of a file")
    opened = new_file() if file is None else _opened(file)
    with progress("opening"):
        bench = Bench(opened, loads, _solve_task, _suggesting, start=file is None)
    server = LiveServer(bench, port)

    def tell() -> None:
        if as_json:
            print_json({"file": None if file is None else opened.name, "address": server.address})
        else:
            print_lines(_opened_lines("The page" if file is None else opened.name, server.address))
        if not no_browser:
            threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()

    try:
        server.run(tell)
    finally:
        for kept in bench.keep_unsaved():
            print_lines([f"Unsaved changes were written to {kept}."])


# ----------------------------------------------------------------------
# ``linkwork web``


@click.command("web")
@click.argument("out", metavar="OUT")
@click.option("--single", is_flag=True, help="Write one HTML file, which needs no host.")
@click.option(
    "--pyodide",
    metavar="FOLDER",
    envvar="LINKWORK_PYODIDE",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Folder with the files of Pyodide and NumPy. Default: they are downloaded.",
)
@json_option
@debug_option
def web_command(out: str, single: bool, pyodide: Path | None, as_json: bool) -> None:
    """Write the app as static files: it solves in the browser alone.

    OUT is a folder for any web host, or one HTML file that opens from a disk,
    by mail, or in a frame. Nothing leaves the visitor's machine.

    \b
      linkwork web public
      linkwork web linkwork.html --single

    The files of Pyodide and NumPy are compared with known SHA-256 hashes.
    """
    if single:
        _check_single(out)
    else:
        _check_folder(Path(out))
    with progress("reading" if pyodide else "downloading") as tell:
        pyodide_set = pyodide_files(pyodide, tell)
    with progress("packing"):
        files = {out: web_page(pyodide_set)} if single else web_folder(pyodide_set)
    if single:
        write_bytes(out, files.values())
    else:
        _write_folder(Path(out), files)
    if pyodide_set.unofficial:
        listed = ", ".join(pyodide_set.unofficial)
        print_lines([f"For tests only: not the official files of {listed}."], err=True)
    size = sum(map(len, files.values()))
    print_written(out, as_json, f": {size / 1e6:.1f} MB; {_next_step(single)}")


def _next_step(single: bool) -> str:
    return "open it in a browser" if single else "copy it to any web host"


def _check_single(out: str) -> None:
    if Path(out).suffix.lower() not in (".html", ".htm"):
        raise InputError(f'cannot write "{out}": a page needs the suffix .html')
    check_outputs("-", out)


def _check_folder(out: Path) -> None:
    """Reject a folder in which files of somebody else would be replaced."""
    if out.suffix.lower() in (".html", ".htm"):
        raise InputError(f'"{out}" is to be a folder: for one HTML file, add --single')
    if not out.absolute().parent.is_dir():
        raise InputError(f'cannot write "{out}": there is no folder "{out.parent}"')
    if out.is_file():
        raise InputError(f'cannot write "{out}": it is a file; for one HTML file, add --single')
    check_place(out)
    if not out.exists():
        return
    page = out / "index.html"
    ours = page.is_file() and MARK in page.read_text("utf-8", "replace")
    if not ours and any(out.iterdir()):
        raise InputError(
            f'"{out}" contains files that linkwork web did not write: name an empty or new folder'
        )


def _write_folder(out: Path, files: Mapping[str, bytes]) -> None:
    """Write all files to a temporary folder first: if the disk is full, the old files stay."""
    with written_folder(out, last="index.html") as part:  # it names the other files
        for name, content in files.items():
            path = part / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)


# ----------------------------------------------------------------------
# ``linkwork link``


@click.command("link")
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
def link_command(
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
        result = {"link": made, "characters": len(made), "embed": snippet, "written": written}
        print_json(result | ({"text": text} if as_text else {}))
    elif as_text:
        click.echo(text, nl=False)
    else:
        # not wrapped: these are copied
        click.echo(made if snippet is None else snippet)
        for path in written:
            click.echo(f"Wrote {path}.")


def _check(file: str, app: str | None, qr: str | None, embed: bool) -> None:
    """Reject options that do not fit together, before anything is read."""
    for option, used in (("--qr", qr is not None), ("--embed", embed)):
        if used and app is None:
            raise InputError(
                f"{option} needs the address of a Linkwork app: add --app URL, as in "
                "--app https://example.org/linkwork/"
            )
    check_outputs(file, qr)
    if qr is not None and _suffix(qr) not in (".svg", ".png"):
        raise InputError(f'cannot write "{qr}": a QR code needs the suffix .svg or .png')


def _suffix(path: str) -> str:
    return Path(path).suffix.lower()


@click.command("animate")
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
def animate_command(
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
    check_points(mechanism)
    shown = forces_of(mechanism, forces)
    if sliders:
        motions = {"motion": mechanism.sweep(certify=not no_certificates)}
    else:
        motions = _motions(mechanism, every, configuration, certify=not no_certificates)
    if not any(motion.found.any() for motion in motions.values()):
        print_lines([f"Did not write {output}: there is no position to draw."], err=True)
        context.exit(1)
    solver = solving_page(mechanism, sliders, motions["motion"]) if sliders else None
    with progress("drawing") as tell:
        content = animation(
            motions,
            kind,
            options=options,
            equations=mechanism.equations().mathml(),
            loops=partial(moving_loops, mechanism.model),
            forces=shown,
            solver=solver,
            progress=tell,
        )
    write_bytes(output, [content])
    about = f": {_shown_text(motions, kind)}, {len(content) / 1000:.0f} kB"
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


def _shown_text(motions: dict[str, Motion], kind: str) -> str:
    rows = sum(int(motion.found.sum()) for motion in motions.values())
    if kind != "html":
        return "one cycle"
    circuits = f"{len(motions)} circuits, " if len(motions) > 1 else ""
    return f"{circuits}{rows} positions; open it in a browser"
