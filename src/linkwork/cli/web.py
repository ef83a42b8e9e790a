"""``linkwork web``"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import click

from linkwork.cli.options import debug_option, json_option
from linkwork.cli.output_file import check_outputs, write_bytes
from linkwork.cli.terminal import print_lines, print_written, progress
from linkwork.foundation.errors import InputError
from linkwork.foundation.written_folder import check_place, written_folder
from linkwork.viewer.web.pyodide_files import pyodide_files
from linkwork.viewer.web.web_app import MARK, web_folder, web_page

__all__ = ["web"]


@click.command
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
def web(out: str, single: bool, pyodide: Path | None, as_json: bool) -> None:
    """Write the live page as static files: it solves in the browser alone.

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
        found = pyodide_files(pyodide, tell)
    with progress("packing"):
        files = {out: web_page(found)} if single else web_folder(found)
    if single:
        write_bytes(out, files.values())
    else:
        _write_folder(Path(out), files)
    if found.unofficial:
        listed = ", ".join(found.unofficial)
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
    with written_folder(out, last="index.html") as part:  # it names the others
        for name, content in files.items():
            path = part / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
