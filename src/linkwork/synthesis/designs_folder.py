"""A page of the designs of a synthesis: counts, pictures, and a table that sorts."""

from __future__ import annotations

import cmath
import html
import os
import re
import unicodedata
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.drawing.annotations import PositionMark, SceneOptions
from linkwork.core.drawing.matplotlib_writer import render
from linkwork.core.drawing.scene import Scene
from linkwork.core.drawing.vector_files import FixedInks, Inks, embedded_svg, inline_svg
from linkwork.core.foundation.files import OwnFiles, as_path, save_bytes, save_text
from linkwork.core.results.listing import rounded_down
from linkwork.core.results.tables import csv_text
from linkwork.core.textfile.writer import TextEdits, write_text
from linkwork.synthesis.defects.verdicts import JudgedDesign
from linkwork.synthesis.solvers.result import Synthesis, designs_table, front_of, goal_misses
from linkwork.synthesis.solvers.solving import advice_of, remarks_on
from linkwork.synthesis.tasks.task import Task
from linkwork.writers.charts.lines import front_chart

_LONGEST_PAGE = 300.0  # the longer side of a picture [CSS pixels]
_CLASS = "linkwork-designs"
_MOST_ROWS = 2000


def designs_page(
    synthesis: Synthesis, scenes: Sequence[Scene], files: Mapping[int, str], front: bytes = b""
) -> str:
    """A page that works offline: counts, pictures of the best designs, all verdicts.

    Parameters
    ----------
    synthesis : Synthesis
    scenes : sequence of Scene
        Pictures of the first delivered designs.
    files : Mapping[int, str]
        The files of designs by their place in the list.
    front : bytes
        An SVG file of the trade-off between goals, if there is one.
    """
    inks = Inks()
    style, script = (
        Path(__file__).with_name(f"designs_page{kind}").read_text(encoding="utf-8")
        for kind in (".css", ".js")
    )
    pictures = [
        f"<figure>{inline_svg(scene, inks, longest=_LONGEST_PAGE)}"
        f"<figcaption>{html.escape(_caption(synthesis, design))}</figcaption></figure>"
        for scene, design in zip(scenes, synthesis.delivered, strict=False)
    ]
    title = html.escape(synthesis.task.name)
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        f"<style>{style}{inks.rules(_CLASS)}</style></head>"
        f'<body class="{_CLASS}"><h1>{title}</h1><dl>{"".join(_facts(synthesis))}</dl>'
        f"{_front(front)}"
        f'<h2>Delivered</h2><div class="pictures">{"".join(pictures)}</div>'
        f'<h2>All designs</h2><div class="wide"><table><thead><tr>{_head(synthesis)}</tr></thead>'
        f"<tbody>{''.join(_design_rows(synthesis, files))}</tbody></table></div>"
        f"<script>{script}</script></body></html>\n"
    )


def _front(picture: bytes) -> str:
    if not picture:
        return ""
    shown = embedded_svg(picture, "trade-off", "The misses of the goals against each other")
    return f'<h2>Front</h2><figure class="front">{shown}</figure>'


def synthesis_facts(synthesis: Synthesis) -> Iterator[tuple[str, str]]:
    """How many solutions and designs there are, and whether these are all."""
    if synthesis.starts:
        yield "starts", str(synthesis.starts)
        if not (synthesis.task.improvement and synthesis.task.improvement.front):
            yield "fits", f"{synthesis.real}, different ones"
    else:
        yield "complex", f"{synthesis.complex} solution{'' if synthesis.complex == 1 else 's'}"
        yield "real", str(synthesis.real)
        yield "proved", str(synthesis.proved)
    if synthesis.triples:
        yield "triples", str(synthesis.triples)
    yield "completeness", synthesis.message
    if synthesis.interrupted:
        yield "interrupted", "the designs are the best ones so far"
    driven = len(synthesis.designs)
    yield "mechanisms", str(synthesis.linkages)
    each = "one for each link that can be driven"
    if synthesis.starts:
        each = f"driven at {synthesis.designs[0].driven}" if synthesis.designs else "none found"
    yield "designs", f"{driven}, {each}"
    for kind, count in synthesis.defects.items():
        yield kind.value, f"{count}"
    yield "without defects", str(synthesis.sound)
    yield "delivered", str(len(synthesis.delivered))


def _facts(synthesis: Synthesis) -> Iterator[str]:
    pairs = [*synthesis_facts(synthesis), *(("remark", text) for text in remarks_on(synthesis))]
    if advice := advice_of(synthesis):
        pairs.append(("advice", advice))
    if len(synthesis.designs) > _MOST_ROWS:
        pairs.append(("table", f"the first {_MOST_ROWS} designs; designs.csv holds all"))
    for name, text in pairs:
        yield f"<dt>{html.escape(name)}</dt><dd>{html.escape(text)}</dd>"


def _caption(synthesis: Synthesis, design: JudgedDesign) -> str:
    task = synthesis.task
    return (
        f"{design.number}: {design.mechanism} driven at {design.driven}, "
        f"transmission angle {rounded_down(design.transmission, 4):g}{task.angle.sign} or more, "
        f"longest link {design.size:.4g} {task.length}"
    )


def _head(result: Synthesis) -> str:
    task, unit = result.task, f"[{result.error_unit}]" if result.error_unit else ""
    names = (
        "design", "mechanism", "drive", f"transmission [{task.angle.value}]",
        f"size [{task.length}]", f"error {unit}".strip(), "score",
        *(f"miss of {name}" for name in goal_misses(result.designs)), "defect",
    )  # fmt: skip
    return "".join(f"<th><button>{html.escape(name)}</button></th>" for name in names)


def _design_rows(synthesis: Synthesis, files: Mapping[int, str]) -> Iterator[str]:
    goals = goal_misses(synthesis.designs)
    for k, design in enumerate(synthesis.designs[:_MOST_ROWS]):
        defect = design.defects[0].message if design.kinds else ""
        number = str(k + 1)
        if k in files:
            name = os.path.basename(files[k])
            link = f"refused/{name}" if design.kinds else name
            number = f'<a href="{html.escape(link)}">{number}</a>'
        numbers = [rounded_down(design.transmission, 5), design.size, design.error, design.score]
        numbers += [misses[k] for misses in goals.values()]
        cells = [
            f'<td data-key="{k + 1}">{number}</td>',
            f"<td>{design.mechanism}</td><td>{design.driven}</td>",
            *(f'<td data-key="{value}">{_number(value)}</td>' for value in numbers),
            f"<td>{html.escape(defect)}</td>",
        ]
        style = ' class="refused"' if design.kinds else ""
        yield f"<tr{style}>{''.join(cells)}</tr>"


def _number(value: float) -> str:
    return f"{value:.5g}" if value == value else "–"


# ----------------------------------------------------------------------
# The task of a folder of designs, with copies of the files that it names.


REFUSED = "refused"
# names of files of a synthesis
_OWN = re.compile(
    r".+-\d+\.(toml|svg)|task\.toml|designs\.csv|front\.svg|index\.html|refused|\.linkwork.*",
    re.IGNORECASE,  # on file systems that ignore case both names are one file
)


@dataclass(frozen=True, kw_only=True)
class TaskCopy:
    """A task that is at home in the folder of its designs.

    ``files``: the texts of the task's file and of those that it names, by their places in the
    folder; ``sources``: the files that it names themselves.
    """

    files: Mapping[str, str]
    sources: Collection[Path]


def task_copy(task: Task) -> TaskCopy:
    """The copy of a task for a folder of its designs.

    Files that lie in the folder of the task keep their places. Others, and those with names of
    designs, lie in a folder named like the key that names them: ``curve/foot.csv``.
    """
    files = {"task.toml": task.text}
    sources: list[Path] = []
    edits = TextEdits(task.text)
    for key, name, text in _named_files(task):
        place = Path(name)
        sources.append(((task.folder or Path()) / place).resolve())
        if place.is_absolute() or ".." in place.parts or _OWN.fullmatch(place.parts[0]):
            place = Path(key[0], place.name)
            if place.as_posix() in files:
                place = Path(key[0], *place.parts)
            edits.put(key, place.as_posix())
            files["task.toml"] = edits.text
        files[place.as_posix()] = text
    return TaskCopy(files=files, sources=sources)


def _named_files(task: Task) -> Iterator[tuple[tuple[str, ...], str, str]]:
    """The files that a task names: their keys, names and texts."""
    if task.curve is not None:
        yield ("curve", "file"), task.curve.file, task.curve.text
    if task.mechanism_text is not None:
        yield ("mechanism",), task.mechanisms[0], task.mechanism_text


# ----------------------------------------------------------------------
# The folder of a synthesis: designs as mechanism files, their task, pictures, table and page.


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
