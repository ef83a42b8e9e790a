"""The folder of a synthesis: designs as mechanism files, their task, pictures, table and page."""

from __future__ import annotations

import cmath
import re
import unicodedata
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.drawing.annotations import PositionMark, SceneOptions
from linkwork.core.drawing.picture_file import render
from linkwork.core.drawing.scene import Scene
from linkwork.core.drawing.svg import FixedInks, inline_svg
from linkwork.core.foundation.files import OwnFiles, as_path, save_bytes, save_text
from linkwork.core.results.tables import csv_text
from linkwork.core.textfile.writer import write_text
from linkwork.synthesis.defects.verdicts import JudgedDesign
from linkwork.synthesis.designs_page import designs_page
from linkwork.synthesis.solvers.result import Synthesis, designs_table, front_of
from linkwork.synthesis.task_copy import REFUSED, task_copy
from linkwork.synthesis.tasks.task import Task
from linkwork.writers.charts.circuits import front_chart

_LONGEST = 800.0  # the longer side of a picture [CSS pixels]
_LONGEST_STEM = 160  # bytes of a name: file systems take 255, temporary files add some
_TABLE, _FRONT, _PAGE = "designs.csv", "front.svg", "index.html"
_DESIGN = re.compile(r"[^/]+-\d+\.toml")  # one that is delivered
_PICTURES = 24  # designs that a page shows


@dataclass(frozen=True, kw_only=True)
class FolderOptions:
    """What a folder holds besides the delivered designs and their task.

    ``refused``: the refused designs too; ``draw``: a picture of each design; ``csv``, ``html``: a
    table and a page of all designs; ``force``: replaces the files of an earlier synthesis and keeps
    all others.
    """

    refused: bool = False
    draw: bool = False
    csv: bool = False
    html: bool = False
    force: bool = False


def write_designs(
    synthesis: Synthesis,
    folder: str | Path,
    options: FolderOptions,
    progress: Callable[[float], None] | None = None,
    earlier: Collection[str] | None = None,
) -> dict[int, str]:
    """Write a synthesis into a folder; returns the files of designs by their place in the list.

    ``earlier``: the result of a check before the work. An interruption (Ctrl-C) leaves a new folder
    with the designs that are written by then, and one of earlier designs as it was; so does a
    synthesis without a delivered design.

    Raises
    ------
    InputError
        If the folder holds files that are not to be replaced, or cannot be written.
    """
    root = as_path(folder)
    if earlier is None:
        earlier = check_folder(root, options, synthesis.task)
    if keeps_earlier(synthesis, earlier):
        return {}
    chosen = [
        (k, design)
        for k, design in enumerate(synthesis.designs)
        if design.delivered or (options.refused and design.kinds)
    ]
    names: dict[int, str] = {}
    interrupted = False
    with _designs_folder(options, synthesis.task).written(root, earlier) as part:
        if options.refused:
            (part / REFUSED).mkdir()
        for done, (k, design) in enumerate(chosen):
            name = f"{_stem(synthesis.task)}-{design.number:02}.toml"
            name = f"{REFUSED}/{name}" if design.kinds else name
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
        try:
            _write_tables(synthesis, part, options, names)
        except KeyboardInterrupt:
            if earlier or not names:
                raise
            interrupted = True
    if interrupted:
        progress_made = f"after {len(names)} of {len(chosen)} designs were written in {root}"
        raise KeyboardInterrupt(progress_made)
    return {k: str(root / name) for k, name in names.items()}


def _write_design(design: JudgedDesign, path: Path, draw: bool) -> None:
    save_text(write_text(design.linkage), path)
    if draw:
        picture = inline_svg(_scene(design), FixedInks(), longest=_LONGEST)
        save_text(picture, path.with_suffix(".svg"))


def _write_tables(
    synthesis: Synthesis, part: Path, options: FolderOptions, files: Mapping[int, str]
) -> None:
    """The task with the files that it names, the table, the front and the page."""
    for place, text in task_copy(synthesis.task).files.items():
        (part / place).parent.mkdir(parents=True, exist_ok=True)
        save_text(text, part / place)
    if options.csv:
        save_text(csv_text(designs_table(synthesis, files)), part / _TABLE)
    front = _front_picture(synthesis) if options.draw or options.html else b""
    if options.draw and front:
        save_bytes(front, part / _FRONT)
    if options.html:
        shown = synthesis.delivered[:_PICTURES]
        scenes = [_scene(design) for design in shown]
        save_text(designs_page(synthesis, scenes, files, front), part / _PAGE)


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


def _front_picture(synthesis: Synthesis) -> bytes:
    """The trade-off between goals as SVG; none if there is no front of two designs."""
    front = front_of(synthesis)
    numbers = [design.number for design in synthesis.delivered]
    if len(numbers) < 2 or not front:
        return b""
    return render(front_chart(synthesis.task.name, front, numbers), "svg")


def check_folder(root: Path, options: FolderOptions, task: Task) -> Collection[str]:
    """The files of an earlier synthesis that will be replaced, by their places in the folder.

    Raises
    ------
    InputError
        If the folder holds files that are not to be replaced, or cannot be written.
    """
    return _designs_folder(options, task).check(root, options.force)


def keeps_earlier(synthesis: Synthesis, earlier: Collection[str]) -> bool:
    """Whether a folder keeps its earlier designs because there are none to replace them."""
    return not synthesis.delivered and any(map(_DESIGN.fullmatch, earlier))


def _designs_folder(options: FolderOptions, task: Task) -> OwnFiles:
    design = rf"({REFUSED}/)?{re.escape(_stem(task))}-\d+\.(toml|svg)"
    further = {_TABLE: options.csv, _FRONT: options.draw, _PAGE: options.html}
    named = [re.escape(name) for name, is_written in further.items() if is_written]
    return OwnFiles(
        run="synthesis",
        option="--force (in Python force=True)",
        # on file systems that ignore case both names are one file
        files=re.compile("|".join([design, *named]), re.IGNORECASE),
        folders=(".", REFUSED),
        read=task_copy(task).sources,
    )


def _stem(task: Task) -> str:
    """``pick-and-place``, of which ``pick-and-place-01.toml`` is a design."""
    # composed letters have one spelling in all file systems
    name = unicodedata.normalize("NFKC", task.name.lower())
    # vowel signs and accents belong to their letters
    kept = (c if c.isalnum() or unicodedata.category(c)[0] == "M" else "-" for c in name)
    stem = re.sub("-+", "-", "".join(kept)).encode()[:_LONGEST_STEM].decode(errors="ignore")
    return stem.strip("-") or "design"
