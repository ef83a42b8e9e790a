"""A page of the designs of a synthesis: counts, pictures, and a table that sorts."""

from __future__ import annotations

import html
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from linkwork.core.drawing.scene import Scene
from linkwork.core.drawing.svg import Inks, embedded_svg, inline_svg
from linkwork.core.results.listing.motion_listing import rounded_down
from linkwork.synthesis.defects.verdicts import JudgedDesign
from linkwork.synthesis.solvers.result import Synthesis, goal_misses
from linkwork.synthesis.solvers.solving import advice_of, remarks_on

_LONGEST = 300.0  # the longer side of a picture [CSS pixels]
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
        Path(__file__).with_suffix(kind).read_text(encoding="utf-8") for kind in (".css", ".js")
    )
    pictures = [
        f"<figure>{inline_svg(scene, inks, longest=_LONGEST)}"
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
