"""QR codes of links as SVG and PNG, encoded by segno."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

from linkwork.foundation.errors import InputError
from linkwork.foundation.optional_packages import installed_with

if TYPE_CHECKING:
    from segno import QRCode

__all__ = ["qr_png", "qr_svg"]

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
