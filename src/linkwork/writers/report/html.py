"""A report as one HTML file that works offline and prints well on A4."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from html import escape
from string import Template as StringTemplate
from urllib.parse import quote

from linkwork.core.drawing.picture_file import render
from linkwork.core.drawing.scene import Scene
from linkwork.core.drawing.svg import FixedInks, embedded_svg, inline_svg
from linkwork.core.results.listing.motion_listing import Column
from linkwork.writers.report.document import (
    Block,
    Document,
    Equation,
    Facts,
    Figure,
    Table,
    Text,
    figure_files,
    mathml_terms,
    printed,
    template_text,
)

_ONE_LINE = 30  # characters of a cell
_LONGEST = 620.0  # of a drawing [CSS pixels]


def html_bytes(document: Document, progress: Callable[[float], None]) -> bytes:
    """The document as the content of an HTML file."""
    parts = []
    for k, section in enumerate(document.sections, 1):
        blocks = map(_html_block, section.blocks)
        heading = f'<h2 id="section-{k}">{k} {escape(section.title)}</h2>'
        parts += [f"<section>{heading}", *blocks, "</section>"]
        progress(k / len(document.sections))
    byline = escape(document.author_line)
    contents = (
        f'<li><a href="#section-{k}">{escape(section.title)}</a></li>'
        for k, section in enumerate(document.sections, 1)
    )
    page = StringTemplate(template_text("report.html")).substitute(
        title=escape(document.title),
        style=template_text("report.css"),
        byline=f'<p class="byline">{byline}</p>\n' if byline else "",
        contents="".join(contents),
        sections="\n".join(parts),
    )
    return page.encode()


def _html_block(block: Block) -> str:
    match block:
        case Text():
            tag = {"paragraph": "p", "note": "h3", "listing": "pre"}[block.style]
            return f"<{tag}>{escape(block.text)}</{tag}>"
        case Facts():
            pairs = (f"<dt>{escape(a)}</dt><dd>{escape(b)}</dd>" for a, b in block.pairs)
            return f"<dl>{''.join(pairs)}</dl>"
        case Equation():
            terms = " ".join(mathml_terms(block.mathml))
            return f'<div class="equation"><span>{terms}</span><span>({block.number})</span></div>'
        case Table():
            return _table(block)
        case Figure():
            caption = f"Figure {block.number}. {escape(block.caption)}"
            return f"<figure>{_svg(block)}<figcaption>{caption}</figcaption></figure>"


def _table(table: Table) -> str:
    looks = [_look(column) for column in table.columns]

    def row(cells: Sequence[str], tag: str) -> str:
        shown = zip(cells, looks, strict=True)
        return f"<tr>{''.join(f'<{tag}{look}>{escape(c)}</{tag}>' for c, look in shown)}</tr>"

    head = row([column.header for column in table.columns], "th")
    rows = zip(*map(printed, table.columns), strict=True)
    body = "".join(row(cells, "td") for cells in rows)
    name = f"table-{table.number}"
    kind = "scroll short" if table.is_short else "scroll"
    return (
        f'<p class="caption" id="{name}">Table {table.number}. {escape(table.caption)}</p>'
        f'<div class="{kind}" tabindex="0" role="group" aria-labelledby="{name}"><table>'
        f"<thead>{head}</thead><tbody>{body}</tbody></table></div>"
    )


def _look(column: Column) -> str:
    """Numbers to the right, short words on one line, sentences broken."""
    if column.align != "left":
        return ' class="n"'
    return "" if max(map(len, column.cells), default=0) > _ONE_LINE else ' class="w"'


def _svg(figure: Figure) -> str:
    if isinstance(figure.picture, Scene):
        return inline_svg(figure.picture, FixedInks(), longest=_LONGEST)
    return embedded_svg(render(figure.picture, "svg"), f"figure-{figure.number}", figure.caption)


# ----------------------------------------------------------------------
# A report as Markdown with its pictures in a folder next to it.


_MARKUP = re.compile(r"([\\`*_{}\[\]<>#|~$])")


def markdown_files(
    document: Document, stem: str, progress: Callable[[float], None]
) -> tuple[bytes, dict[str, bytes]]:
    """The text, and the pictures by their paths; ``stem`` is the name of the report's file."""
    folder = f"{stem}-pictures"
    pictures = {
        f"{folder}/figure-{number}.png": content
        for number, content, _ in figure_files(document, "png", progress)
    }
    lines = [f"# {_text(document.title)}", ""]
    if document.author_line:
        lines += [_text(document.author_line), ""]
    for number, section in enumerate(document.sections, 1):
        lines += [f"## {number} {_text(section.title)}", ""]
        for block in section.blocks:
            lines += [*_markdown_lines(block, folder), ""]
    return ("\n".join(lines).rstrip() + "\n").encode(), pictures


def _markdown_lines(block: Block, folder: str) -> Iterator[str]:
    match block:
        case Text(style="paragraph"):
            yield _text(block.text)
        case Text(style="note"):
            yield f"**{_text(block.text)}**"
        case Text():
            fence = "`" * max(3, 1 + max(map(len, re.findall("`+", block.text)), default=0))
            yield f"{fence}toml"
            yield block.text.rstrip("\n")
            yield fence
        case Facts():
            for label, text in block.pairs:
                yield (f"- {_text(label)}: {_text(text)}" if label else f"  - {_text(text)}")
        case Equation():
            yield f"$$ {block.latex} \\tag{{{block.number}}} $$"
        case Table():
            yield f"Table {block.number}. {_text(block.caption)}"
            yield ""
            yield _row([_text(column.header) for column in block.columns])
            yield _row(["---" if c.align == "left" else "---:" for c in block.columns])
            for cells in zip(*map(printed, block.columns), strict=True):
                yield _row(list(map(_text, cells)))
        case Figure():
            caption = f"Figure {block.number}. {_text(block.caption)}"
            yield f"![{caption}]({quote(folder)}/figure-{block.number}.png)"
            yield ""
            yield caption


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _text(text: str) -> str:
    """Text without signs of the markup."""
    return _MARKUP.sub(r"\\\1", text.replace("\n", " "))
