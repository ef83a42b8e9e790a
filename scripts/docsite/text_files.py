"""``llms.txt`` and the whole site as one text file, for readers without a browser."""

from __future__ import annotations

import json
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx

__all__ = ["write_index", "write_whole"]

_PAGES = "pages.json"  # titles and first sentences, in the order of the site
_HEAD = (
    "# Linkwork\n\n"
    "> Planar mechanisms, solved from their vector loop-closure equations, every position\n"
    "> with its proof: Python package, command line and page. `pip install linkwork`.\n\n"
    "The whole site as one text: [llms-full.txt](llms-full.txt).\n"
)


def write_index(app: Sphinx, error: Exception | None) -> None:
    """Write ``llms.txt``: every page with its first sentence, by the parts of the site."""
    if error is not None or app.builder.name != "html":
        return
    pages = [(name, *_told(app, name)) for name in _in_order(app)]
    (Path(app.doctreedir) / _PAGES).write_text(json.dumps(pages), encoding="utf-8")
    lines = [_HEAD]
    tops = set(app.env.toctree_includes.get("index", ()))
    for name, title, about in pages:
        if name in tops:
            lines.append(f"\n## {title}\n")
        if name != "index":
            lines.append(
                f"- [{title}]({name}.html): {about}" if about else f"- [{title}]({name}.html)"
            )
    (Path(app.outdir) / "llms.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_whole(texts: Path, doctrees: Path, out: Path) -> int:
    """Write ``llms-full.txt`` from the pages that Sphinx wrote as text; returns its size."""
    parts: list[str] = []
    for name, _title, _about in json.loads((doctrees / _PAGES).read_text(encoding="utf-8")):
        text = (texts / f"{name}.txt").read_text(encoding="utf-8")
        parts.append(f"<!-- {name}.html -->\n\n{text.strip()}\n")
    whole = "\n\n".join(parts)
    (out / "llms-full.txt").write_text(whole, encoding="utf-8")
    return len(whole)


def _in_order(app: Sphinx) -> list[str]:
    """The pages as a reader meets them."""
    ordered: list[str] = []

    def visit(name: str) -> None:
        if name not in ordered:
            ordered.append(name)
            for child in app.env.toctree_includes.get(name, ()):
                visit(child)

    visit("index")
    return ordered


def _told(app: Sphinx, name: str) -> tuple[str, str]:
    """The title of a page and its first sentence."""
    tree = app.env.get_doctree(name)
    title = app.env.titles[name].astext()
    for paragraph in tree.findall(nodes.paragraph):
        text = " ".join(paragraph.astext().split())
        if text and not isinstance(paragraph.parent, nodes.entry):
            return title, text.split(". ")[0].rstrip(".:") + "."
    return title, ""
