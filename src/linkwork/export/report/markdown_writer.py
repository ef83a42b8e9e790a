"""A report as Markdown with its pictures in a folder next to it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from urllib.parse import quote

from linkwork.export.report.document import (
    Block,
    Document,
    Equation,
    Facts,
    Figure,
    Listing,
    Note,
    Paragraph,
    Table,
    printed,
)
from linkwork.export.report.figure_files import figure_files

__all__ = ["markdown_files"]

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
    lines = [f"# {_plain(document.title)}", ""]
    if document.byline:
        lines += [" · ".join(_plain(text) for _, text in document.byline), ""]
    for number, section in enumerate(document.sections, 1):
        lines += [f"## {number} {_plain(section.title)}", ""]
        for block in section.blocks:
            lines += [*_block(block, folder), ""]
    return ("\n".join(lines).rstrip() + "\n").encode(), pictures


def _block(block: Block, folder: str) -> Iterator[str]:
    match block:
        case Paragraph():
            yield _plain(block.text)
        case Note():
            yield f"**{_plain(block.text)}**"
        case Facts():
            for label, text in block.pairs:
                yield f"- {_plain(label)}: {_plain(text)}" if label else f"  - {_plain(text)}"
        case Equation():
            yield f"$$ {block.latex} \\tag{{{block.number}}} $$"
        case Table():
            yield f"Table {block.number}. {_plain(block.caption)}"
            yield ""
            yield _row([_plain(column.header) for column in block.columns])
            yield _row(["---" if c.align == "left" else "---:" for c in block.columns])
            for cells in zip(*map(printed, block.columns), strict=True):
                yield _row(list(map(_plain, cells)))
        case Figure():
            caption = f"Figure {block.number}. {_plain(block.caption)}"
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


def _plain(text: str) -> str:
    """Text without signs of the markup."""
    return _MARKUP.sub(r"\\\1", text.replace("\n", " "))
