"""A report as one HTML file that works offline and prints well on A4."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from html import escape
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
    Listing,
    Note,
    Paragraph,
    Section,
    Table,
    figure_files,
    mathml_terms,
    printed,
)

_ONE_LINE = 30  # characters of a cell
_LONGEST = 620.0  # of a drawing [CSS pixels]
_STYLE = """
@page{size:A4;margin:20mm 18mm}
*{box-sizing:border-box}
body{margin:0;background:#fff;color:#1a1a1a;font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,
"Noto Sans","DejaVu Sans",sans-serif}
main{max-width:800px;margin:0 auto;padding:24px 20px 60px}
h1{font-size:1.9em;line-height:1.2;margin:.6em 0 .2em;overflow-wrap:anywhere}
h2{font-size:1.3em;margin:1.8em 0 .5em;border-bottom:1px solid #c8c8c8;padding-bottom:.15em}
h3{font-size:1em;margin:1.2em 0 .4em}
p{margin:.5em 0;overflow-wrap:anywhere}
.byline{color:#555;margin:0 0 1em}
nav ol{columns:2;padding-left:1.6em;margin:.4em 0}
nav a{color:#0a5a9c}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.15em 1em;margin:.6em 0}
dt{color:#555}dd{margin:0;overflow-wrap:anywhere}
figure{margin:1.2em 0;break-inside:avoid}
figure svg{max-width:100%;height:auto;display:block;margin:0 auto}
figcaption,.caption{font-size:.88em;color:#333;margin:.9em 0 .3em}
.scroll{overflow-x:auto}
table{border-collapse:collapse;font-size:.88em;margin:.3em 0 1em;font-variant-numeric:tabular-nums}
th,td{padding:.12em .7em;text-align:left;vertical-align:top}
th:first-child,td:first-child{padding-left:.2em}
th.w,td.w{white-space:nowrap}
th.n,td.n{text-align:right;white-space:nowrap}
thead{border-top:1.5px solid #333;border-bottom:1px solid #777;display:table-header-group}
tbody{border-bottom:1.5px solid #333}
tr,.short{break-inside:avoid}
.equation{display:flex;gap:1em;align-items:baseline;margin:.45em 0 .45em 1.2em;break-inside:avoid}
.equation>span:first-child{flex:1;line-height:1.9;min-width:0}
.equation math{font-size:1.08em}
pre{font:12.5px/1.4 ui-monospace,Menlo,Consolas,"DejaVu Sans Mono",monospace;background:#f6f6f6;
border:1px solid #ddd;padding:10px;white-space:pre-wrap;overflow-wrap:anywhere}
h2,h3,.caption{break-after:avoid}
@media (max-width:520px){dl{grid-template-columns:1fr;gap:0}dd{margin:0 0 .4em}nav ol{columns:1}}
@media print{body{font-size:10.5pt}main{max-width:none;padding:0}nav{display:none}
.scroll{overflow:visible}pre{font-size:8pt}figure svg{max-height:104mm}}
"""


def html_bytes(document: Document, progress: Callable[[float], None]) -> bytes:
    """The document as the content of an HTML file."""
    figures = sum(isinstance(b, Figure) for s in document.sections for b in s.blocks)
    parts: list[str] = []
    for k, section in enumerate(document.sections, 1):
        parts += _section(section, k)
        done = sum(isinstance(b, Figure) for s in document.sections[:k] for b in s.blocks)
        progress(done / max(figures, 1))
    byline = " · ".join(escape(text) for _, text in document.byline)
    contents = "".join(
        f'<li><a href="#section-{k}">{escape(section.title)}</a></li>'
        for k, section in enumerate(document.sections, 1)
    )
    title = escape(document.title)
    page = (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        f'<meta name="generator" content="Linkwork"><title>{title}</title>'
        f"<style>{_STYLE}</style></head>\n<body><main><h1>{title}</h1>\n"
        + (f'<p class="byline">{byline}</p>\n' if byline else "")
        + f'<nav aria-label="Contents"><ol>{contents}</ol></nav>\n'
        + "\n".join(parts)
        + "\n</main></body></html>\n"
    )
    return page.encode()


def _section(section: Section, number: int) -> Iterator[str]:
    yield f'<section><h2 id="section-{number}">{number} {escape(section.title)}</h2>'
    yield from map(_html_writer_block, section.blocks)
    yield "</section>"


def _html_writer_block(block: Block) -> str:
    match block:
        case Paragraph():
            return f"<p>{escape(block.text)}</p>"
        case Note():
            return f"<h3>{escape(block.text)}</h3>"
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
        case Listing():
            return f"<pre>{escape(block.text)}</pre>"


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
        f"{folder}/figure-{figure.number}.png": figure.content
        for figure in figure_files(document, "png", progress)
    }
    lines = [f"# {_text(document.title)}", ""]
    if document.byline:
        lines += [" · ".join(_text(text) for _, text in document.byline), ""]
    for number, section in enumerate(document.sections, 1):
        lines += [f"## {number} {_text(section.title)}", ""]
        for block in section.blocks:
            lines += [*_text_writer_block(block, folder), ""]
    return ("\n".join(lines).rstrip() + "\n").encode(), pictures


def _text_writer_block(block: Block, folder: str) -> Iterator[str]:
    match block:
        case Paragraph():
            yield _text(block.text)
        case Note():
            yield f"**{_text(block.text)}**"
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
        case Listing():
            fence = "`" * max(3, 1 + max(map(len, re.findall("`+", block.text)), default=0))
            yield f"{fence}toml"
            yield block.text.rstrip("\n")
            yield fence


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _text(text: str) -> str:
    """Text without signs of the markup."""
    return _MARKUP.sub(r"\\\1", text.replace("\n", " "))
