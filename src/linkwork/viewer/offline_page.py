"""An HTML file that shows a motion without a network, a server or Linkwork."""

from __future__ import annotations

import base64
import html
import json
import zlib
from importlib import metadata, resources

from linkwork.viewer.page_data import PageData, SolverData, SolvingPage

__all__ = ["offline_page", "page_json"]

_POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:"


def offline_page(page: PageData, solver: SolvingPage | None = None) -> str:
    """The HTML file; with a ``solver`` numbers of the mechanism can be changed in it.

    It contains its data as JSON, deflated if that is shorter, and the scripts and styles of
    ``static/``, which ``scripts/frontend build`` writes. It loads no other file.
    """
    static = resources.files("linkwork.viewer") / "static"
    script = (static / ("solving.js" if solver else "offline.js")).read_text(encoding="utf-8")
    style = (static / "linkwork.css").read_text(encoding="utf-8")
    data = _holder("linkwork-data", page_json(page))
    if solver is not None:
        style += (static / "solving.css").read_text(encoding="utf-8")
        data += _holder("linkwork-solver", page_json(solver.data))
        data += f"<script>{solver.script}</script>\n"
    title = html.escape(page.title)
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{_POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="generator" content="Linkwork {html.escape(metadata.version("linkwork"))}">
<title>{title}</title>
<link rel="icon" href="data:,">
<style>{style}</style>
</head>
<body>
<main id="linkwork"><noscript>This page needs JavaScript to move.</noscript></main>
{data}<script>{script}</script>
</body>
</html>
"""


def _holder(name: str, text: str) -> str:
    """Data as an element of the page."""
    encoding, content = _shortest(text)
    return f'<script id="{name}" type="text/plain" data-encoding="{encoding}">{content}</script>\n'


def page_json(page: PageData | SolverData) -> str:
    """The data as JSON, including fields with empty default values."""
    return json.dumps(
        page, default=vars, ensure_ascii=False, separators=(",", ":"), allow_nan=False
    )


def _shortest(text: str) -> tuple[str, str]:
    """Deflated base64, or the JSON with ``<`` escaped, whichever is shorter."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    raw = text.encode()
    deflated = base64.b64encode(packer.compress(raw) + packer.flush()).decode()
    plain = text.replace("<", "\\u003c")
    return ("deflate-raw", deflated) if len(deflated) < len(plain.encode()) else ("json", plain)
