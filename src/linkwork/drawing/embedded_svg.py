"""An SVG file as a part of a page, whose names and styles act on nothing else there."""

from __future__ import annotations

import re
from html import escape

__all__ = ["embedded_svg"]

_IDENTIFIER = re.compile(r'(\bid="|url\(#|href="#)')


def embedded_svg(picture: bytes, own: str, label: str) -> str:
    """The element of an SVG file.

    ``own``: a name that no other picture of the page has; ``label``: what it shows.
    """
    text = picture.decode()
    text = text[text.index("<svg") :].strip()
    # identifiers and the style sheet of one picture must not act on another
    text = _IDENTIFIER.sub(lambda match: f"{match[1]}{own}-", text)
    text = text.replace("*{", f"#{own} *{{", 1).replace("<svg ", f'<svg id="{own}" ', 1)
    return text.replace("<svg ", f'<svg role="img" aria-label="{escape(label)}" ', 1)
