"""The folder of a synthesis: designs as mechanism files, their task, pictures, table and page."""

from __future__ import annotations

import cmath
import re
import unicodedata
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from linkwork.api.mechanism import Mechanism
from linkwork.api.task_copy import OWN_FILES, REFUSED, task_copy
from linkwork.design.defects.judged_design import JudgedDesign
from linkwork.design.synthesis.designs_table import designs_table, front_of
from linkwork.design.synthesis.result import Synthesis
from linkwork.design.tasks.task import Task
from linkwork.drawing import SceneOptions, render
from linkwork.drawing.charts.front_chart import front_chart
from linkwork.drawing.inline_svg import FixedInks, inline_svg
from linkwork.drawing.position_marks import PositionMark
from linkwork.drawing.scene import Scene
from linkwork.foundation.errors import InputError
from linkwork.foundation.paths import as_path, unwritten
from linkwork.foundation.written_file import save_bytes, save_text
from linkwork.foundation.written_folder import check_place, written_folder
from linkwork.results.csv_text import csv_text
from linkwork.textfile.writer import write_text
from linkwork.viewer.designs_page import designs_page

__all__ = ["FolderOptions", "write_designs"]

_LONGEST = 800.0  # the longer side of a picture [CSS pixels]
_LONGEST_STEM = 160  # bytes of a name: file systems take 255, temporary files add some
_TABLE = "designs.csv"
_PICTURES = 24  # designs that a page shows


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

    An interruption (Ctrl-C) leaves a new folder with the designs that are written by then, and one
    of earlier designs as it was.

    Raises
    ------
    InputError
        If the folder holds anything else, or cannot be written.
    """
    root = as_path(folder)
    earlier = check_folder(root, options, found.task)
    chosen = [
        (k, design)
        for k, design in enumerate(found.designs)
        if design.delivered or (options.refused and design.kinds)
    ]
    names: dict[int, str] = {}
    interrupted = False
    with written_folder(root) as part:
        if options.refused:
            (part / REFUSED).mkdir()
        for done, (k, design) in enumerate(chosen):
            name = _file_name(found, design)
            try:
                if progress is not None:
                    progress(done / len(chosen))
                _write_design(design, part / name, options.draw)
            except KeyboardInterrupt:
                if earlier or not names:
                    raise
                interrupted = True
                for half in (part / name, (part / name).with_suffix(".svg")):
                    half.unlink(missing_ok=True)
                break
            names[k] = name
        _write_tables(found, part, options, names)
        new = {root / path.relative_to(part) for path in part.rglob("*")}
    if interrupted:
        told = f"after {len(names)} of {len(chosen)} designs were written in {root}"
        raise KeyboardInterrupt(told)
    for path in earlier:
        if path not in new:
            path.unlink(missing_ok=True)
    emptied = root / REFUSED
    if options.fresh and not options.refused and emptied.is_dir() and not any(emptied.iterdir()):
        emptied.rmdir()
    return {k: str(root / name) for k, name in names.items()}


def _write_design(design: JudgedDesign, path: Path, draw: bool) -> None:
    save_text(write_text(design.linkage), path)
    if draw:
        picture = inline_svg(_scene(design), FixedInks(), longest=_LONGEST)
        save_text(picture, path.with_suffix(".svg"))


def _write_tables(
    found: Synthesis, part: Path, options: FolderOptions, files: Mapping[int, str]
) -> None:
    """The task with the files that it names, the table, the front and the page."""
    copy = task_copy(found.task)
    save_text(copy.text, part / "task.toml")
    for place, text in copy.files.items():
        (part / place).parent.mkdir(parents=True, exist_ok=True)
        save_text(text, part / place)
    if options.csv:
        save_text(csv_text(designs_table(found, files)), part / _TABLE)
    front = _front_picture(found) if options.draw or options.html else b""
    if options.draw and front:
        save_bytes(front, part / "front.svg")
    if options.html:
        shown = found.delivered[:_PICTURES]
        scenes = [_scene(design) for design in shown]
        save_text(designs_page(found, scenes, files, front), part / "index.html")


def _scene(design: JudgedDesign) -> Scene:
    """A design at its first position, with the positions of its task."""
    marks = tuple(
        PositionMark(
            place=complex(*position.point),
            direction=None
            if position.angle is None
            else cmath.rect(1.0, design.task.in_radians(position.angle)),
        )
        for position in design.task.positions
    )
    options = SceneOptions(positions=marks)
    return Mechanism(design.linkage).scene(design.first_input, options=options)


def _front_picture(found: Synthesis) -> bytes:
    """The trade-off between goals as SVG; none if there is no front of two designs."""
    front = front_of(found)
    numbers = [design.number for design in found.delivered]
    if len(numbers) < 2 or not front:
        return b""
    return render(front_chart(found.task.name, front, numbers), "svg")


def check_folder(root: Path, options: FolderOptions, task: Task) -> list[Path]:
    """The files of an earlier synthesis that will be replaced.

    Raises
    ------
    InputError
        If the folder holds files, and these are not to be replaced or are none of a synthesis, or
        if it cannot be written.
    """
    copy_of_task = task_copy(task)
    copies = [root / place for place in copy_of_task.files]
    own_folders = {root, root / REFUSED}
    for copy in copies:
        own_folders |= {place for place in copy.parents if place.is_relative_to(root)}
    try:
        there = [
            path
            for place in sorted(own_folders)
            for path in (sorted(place.iterdir()) if place.exists() else ())
            if not (path in own_folders and path.is_dir())
        ]
    except OSError as error:
        raise unwritten(root, error) from None
    for path in there:
        if path.resolve() in copy_of_task.moved:
            raise InputError(
                f'the folder "{root}" holds "{path.name}", which the task names: name a new folder'
            )
        own = OWN_FILES.fullmatch(path.name) or path in copies
        if not (options.fresh and path.is_file() and own):
            raise InputError(
                f'the folder "{root}" is not empty: it holds "{path.name}"; name a new '
                "folder, or replace earlier designs: --fresh, in Python fresh=True"
            )
    check_place(root)
    return there


def _file_name(found: Synthesis, design: JudgedDesign) -> str:
    """``pick-and-place-01.toml``; refused ones are in their own folder."""
    # composed letters have one spelling in all file systems
    name = unicodedata.normalize("NFKC", found.task.name.lower())
    # vowel signs and accents belong to their letters
    kept = (c if c.isalnum() or unicodedata.category(c)[0] == "M" else "-" for c in name)
    stem = re.sub("-+", "-", "".join(kept)).encode()[:_LONGEST_STEM].decode(errors="ignore")
    stem = stem.strip("-") or "design"
    name = f"{stem}-{design.number:02}.toml"
    return f"{REFUSED}/{name}" if design.kinds else name
