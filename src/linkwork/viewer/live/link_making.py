"""The link of an edited file, with its QR code and its HTML for other pages."""

from __future__ import annotations

import sys

from linkwork.foundation.errors import InputError
from linkwork.textfile.link import link_of
from linkwork.viewer.embedding import embed_snippet
from linkwork.viewer.live.events import LinkMade
from linkwork.viewer.qr_code import qr_svg

__all__ = ["link_made"]


def link_made(text: str, title: str, app: str) -> LinkMade:
    """The text of a file as a link to an app; with ``app`` empty as a fragment only.

    Raises
    ------
    InputError
        If the text is too long for a link, or ``app`` is not the address of a page.
    """
    if not app:
        return LinkMade(link=link_of(text), embed="", qr="", note="")
    link = link_of(text, app)
    try:
        qr, note = qr_svg(link), ""
    except InputError as error:  # too long, or segno is missing; a page in a browser has none
        qr, note = "", "" if sys.platform == "emscripten" else str(error)
    return LinkMade(link=link, embed=embed_snippet(link, title), qr=qr, note=note)
