"""An HTML file that shows a motion without a network, a server or Linkwork."""

from __future__ import annotations

import base64
import html
import io
import json
import zlib
from html import escape
from importlib import metadata, resources
from typing import TYPE_CHECKING

from linkwork.app.pages.page_data import PageData, SolverData, SolvingPage
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.loading import installed_with

if TYPE_CHECKING:
    from segno import QRCode

_POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:"


def offline_page(page: PageData, solver: SolvingPage | None = None) -> str:
    """The HTML file; with a ``solver`` numbers of the mechanism can be changed in it.

    It contains its data as JSON, deflated if that is shorter, and the scripts and styles of
    ``static/``, which ``scripts/frontend build`` writes. It loads no other file.
    """
    static = resources.files("linkwork.app") / "static"
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


# ----------------------------------------------------------------------
# HTML that shows a linked mechanism inside another page.


def embed_snippet(link: str, title: str) -> str:
    """A frame for the source of a course page, as the editors of learning platforms accept it.

    The frame may run the app's scripts and save files; it can neither reach the page around it nor
    cookies, and reads only the link.

    Examples
    --------
    >>> print(embed_snippet("https://example.org/#lw1=A1k-BYOldgA", "Four-bar"))
    <iframe src="https://example.org/#lw1=A1k-BYOldgA" title="Four-bar" width="100%" height="640"
    loading="lazy" sandbox="allow-scripts allow-downloads"></iframe>
    """
    return (
        f'<iframe src="{escape(link)}" title="{escape(title)}" width="100%" height="640"\n'
        'loading="lazy" sandbox="allow-scripts allow-downloads"></iframe>'
    )


# ----------------------------------------------------------------------
# QR codes of links as SVG and PNG, encoded by segno.


_MOST = 2_953  # bytes of the largest QR code, of the lowest error correction
_SVG_SCALE, _PNG_SCALE = 4, 8  # pixels of a module


def qr_svg(link: str) -> str:
    """The QR code of a link as an SVG document, dark on white with its quiet zone.

    Raises
    ------
    InputError
        If the link is longer than the largest QR code.
    MissingPackageError
        If segno is not installed.
    """
    return _saved(link, "svg", _SVG_SCALE, xmldecl=False, nl=False).decode()


def qr_png(link: str) -> bytes:
    """The QR code of a link as a PNG file; raises like :func:`qr_svg`."""
    return _saved(link, "png", _PNG_SCALE)


def _saved(link: str, kind: str, scale: int, **options: bool) -> bytes:
    buffer = io.BytesIO()
    _code(link).save(buffer, kind=kind, scale=scale, dark="#000", light="#fff", **options)
    return buffer.getvalue()


def _code(link: str) -> QRCode:
    with installed_with("qr", "QR codes need segno"):
        import segno
    size = len(link.encode())
    if size > _MOST:
        raise InputError(
            f"a QR code holds at most {_MOST:,} characters, this link has {size:,}: hand on the "
            "link itself, or shorten the comments and names of the mechanism"
        )
    # the lowest correction gives the fewest modules; segno raises it as far as the size stays
    return segno.make_qr(link, error="l")
