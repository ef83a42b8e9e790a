"""QR codes of links: their size, and what is said where there is none."""

from __future__ import annotations

import re
import struct
import sys

import pytest

import linkwork as lw
from linkwork.app.pages.offline_page import qr_png, qr_svg

LINK = "https://example.org/" + lw.example("four-bar").link()


def _modules(version: int) -> int:
    """Modules of a side with the quiet zone: ISO/IEC 18004."""
    return 17 + 4 * version + 2 * 4


def test_the_smallest_code_that_holds_the_link_is_drawn() -> None:
    # 11-L holds 321 bytes, 10-L only 271: ISO/IEC 18004, table 7
    assert 271 < len(LINK + "x" * 10) <= 321
    found = re.search(r'width="(\d+)" height="(\d+)"', qr_svg(LINK + "x" * 10))
    assert found is not None
    assert found.groups() == (str(4 * _modules(11)),) * 2
    width, height = struct.unpack(">II", qr_png(LINK + "x" * 10)[16:24])
    assert width == height == 8 * _modules(11)


def test_equal_links_give_equal_pictures() -> None:
    assert qr_svg(LINK) == qr_svg(LINK)
    assert qr_png(LINK) == qr_png(LINK)


def test_the_longest_link_fits_and_one_character_more_is_refused() -> None:
    assert qr_svg("a" * 2953)
    with pytest.raises(lw.InputError) as refused:
        qr_svg("a" * 2954)
    assert str(refused.value) == (
        "a QR code holds at most 2,953 characters, this link has 2,954: hand on the link itself, "
        "or shorten the comments and names of the mechanism"
    )


def test_without_segno_its_install_command_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "segno", None)
    with pytest.raises(lw.MissingPackageError) as missing:
        qr_svg(LINK)
    assert str(missing.value) == 'QR codes need segno: pip install "linkwork[qr]"'
