"""The folder of a synthesis: designs as mechanism files, their task, pictures, table and page."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from linkwork.api.mechanism import Mechanism
from linkwork.design.synthesis.designs_table import designs_table, front_of
from linkwork.design.synthesis.result import Synthesis, SynthesizedDesign
from linkwork.drawing import render
from linkwork.drawing.charts.front_chart import front_chart
from linkwork.drawing.inline_svg import FixedInks, inline_svg
from linkwork.foundation.errors import InputError
from linkwork.foundation.paths import as_path, unwritten
from linkwork.results.csv_text import csv_text
from linkwork.textfile.writer import save_bytes, save_text, write_text
from linkwork.viewer.designs_page import designs_page

__all__ = ["FolderOptions", "write_designs"]

_LONGEST = 800.0  # the longer side of a picture [CSS pixels]
_REFUSED = "refused"
_PICTURES = 24  # designs that a page shows
_OWN = re.compile(r"(.+-\d+\.(toml|svg)|task\.toml|designs\.csv|front\.svg|index\.html)")


@dataclass(frozen=True, kw_only=True)
class FolderOptions:
    """What a folder holds besides the delivered designs and their task.

    ``refused``: the refused designs too; ``draw``: a picture of each design; ``csv``, ``html``: a
    table and a page of all designs; ``fresh``: replaces the designs of an earlier synthesis.
    """

    refused: bool = False
    draw: bool = False
    csv: bool = False
    html: bool = False
    fresh: bool = False


def write_designs(
    found: Synthesis,
    folder: str | Path,
    options: FolderOptions,
    progress: Callable[[float], None] | None = None,
) -> dict[int, str]:
    """Write a synthesis into a folder; returns the files of designs by their place in the list.

    Raises
    ------
    InputError
        If the folder holds anything else, or cannot be written.
    """
    root = as_path(folder)
    prepare_folder(root, options)
    save_text(found.task.text, root / "task.toml")
    if found.task.curve is not None:
        # the task names the file of its curve
        save_text(found.task.curve.text, root / found.task.curve.file)
    files: dict[int, str] = {}
    chosen = [
        (k, design)
        for k, design in enumerate(found.designs)
        if design.delivered or (options.refused and design.kinds)
    ]
    for done, (k, design) in enumerate(chosen):
        path = root / _file_name(found, design)
        save_text(write_text(design.linkage), path)
        files[k] = str(path)
        if options.draw:
            scene = Mechanism(design.linkage).scene(design.first_input)
            save_text(inline_svg(scene, FixedInks(), longest=_LONGEST), path.with_suffix(".svg"))
        if progress is not None:
            progress((done + 1) / len(chosen))
    if options.csv:
        save_text(csv_text(designs_table(found, files)), root / "designs.csv")
    front = _front_picture(found) if options.draw or options.html else b""
    if options.draw and front:
        save_bytes(front, root / "front.svg")
    if options.html:
        shown = found.delivered[:_PICTURES]
        scenes = [Mechanism(design.linkage).scene(design.first_input) for design in shown]
        save_text(designs_page(found, scenes, files, front), root / "index.html")
    return files


def _front_picture(found: Synthesis) -> bytes:
    """The trade-off between goals as SVG; none if there is no front of two designs."""
    front = front_of(found)
    numbers = [design.number for design in found.delivered]
    if len(numbers) < 2 or not front:
        return b""
    return render(front_chart(found.task.name, front, numbers), "svg")


def prepare_folder(root: Path, options: FolderOptions) -> None:
    """Make the folder, or empty it of an earlier synthesis.

    Raises
    ------
    InputError
        If it holds files, and these are not to be replaced or are none of a synthesis.
    """
    try:
        there = [
            path
            for place in (root, root / _REFUSED)
            for path in (sorted(place.iterdir()) if place.is_dir() else ())
            if not (path.name == _REFUSED and path.is_dir())
        ]
        for path in there:
            if not (options.fresh and path.is_file() and _OWN.fullmatch(path.name)):
                raise InputError(
                    f'the folder "{root}" is not empty: it holds "{path.name}"; name a new '
                    "folder, or replace earlier designs with --fresh"
                )
        for path in there:
            path.unlink()
        root.mkdir(parents=True, exist_ok=True)
        if options.refused:
            (root / _REFUSED).mkdir(exist_ok=True)
    except OSError as error:
        raise unwritten(root, error) from None


def _file_name(found: Synthesis, design: SynthesizedDesign) -> str:
    """``pick-and-place-01.toml``; refused ones are in their own folder."""
    stem = re.sub(r"[^a-z0-9]+", "-", found.task.name.lower()).strip("-") or "design"
    name = f"{stem}-{design.number:02}.toml"
    return f"{_REFUSED}/{name}" if design.kinds else name
