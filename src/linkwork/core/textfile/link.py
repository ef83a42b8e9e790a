"""A mechanism file packed into the fragment of a URL, and read back to the same text."""

from __future__ import annotations

import base64
import os
import re
import zlib
from functools import cache
from pathlib import Path
from typing import NoReturn

from linkwork.core.foundation.errors import InputError, MechanismFileError, Problem
from linkwork.core.foundation.values import as_told
from linkwork.core.textfile.toml_text import LARGEST, bytes_of, text_of

#: Most characters of a fragment: an argument of a command may have 131,072 bytes on Linux.
LONGEST = 100_000
_VERSION = b"1"
_WHERE = "the link"
_CHECK = 4  # bytes of the check sum before the compressed text
_CODE = re.compile(r"#?lw([0-9]+)=")
_ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://")
_FOREIGN = re.compile(r"[^A-Za-z0-9_-]")
_APP = re.compile(r"(?:https?://[^/?#\"<>\\\s\0-\x1f\x7f]+|file://)[^#\"<>\\\s\0-\x1f\x7f]*")


def fragment_of(text: str) -> str:
    """The text of a mechanism file as the fragment of a URL, with its ``#``.

    The fragment is ``#lw1=``, then in base64url without padding: the CRC-32 of what follows, and
    the UTF-8 text compressed by raw deflate (RFC 1951) with the dictionary ``link_words.txt``. The
    digit is the version of this format: a change of the dictionary is another version.

    Raises
    ------
    InputError
        If the text is too long, contains NUL or is not valid Unicode.

    Examples
    --------
    >>> fragment_of("[points]")[:5], text_of_link(fragment_of("[points]"))
    ('#lw1=', '[points]')
    """
    try:
        data = text.encode("utf-8")
    except UnicodeEncodeError:
        raise InputError("a link cannot hold this text: it contains a lone surrogate") from None
    if b"\0" in data:
        raise InputError("a link cannot hold this text: it contains a NUL character")
    if len(data) > LARGEST:
        raise InputError(
            f"a link cannot hold {len(data):,} bytes: at most {LARGEST:,} are read; send the file"
        )
    packer = zlib.compressobj(9, zlib.DEFLATED, -15, 9, zlib.Z_DEFAULT_STRATEGY, _words())
    packed = packer.compress(data) + packer.flush()
    code = base64.urlsafe_b64encode(_check_sum(packed) + packed).decode().rstrip("=")
    fragment = f"#lw{_VERSION.decode()}={code}"
    if len(fragment) > LONGEST:
        raise InputError(
            f"the link would have {len(fragment):,} characters, at most {LONGEST:,} are read: "
            "send the file"
        )
    return fragment


def link_of(text: str, app: str | None = None) -> str:
    """The text of a mechanism file as a link to an app; without ``app`` the fragment alone.

    Raises
    ------
    InputError
        Like :func:`fragment_of`; or if ``app`` is not the address of a page.
    """
    return ("" if app is None else _address(app)) + fragment_of(text)


def is_link(given: str) -> bool:
    """Whether a text is a link or a fragment, rather than a path; not whether it can be read.

    Examples
    --------
    >>> is_link("https://example.org/#lw1=A1k-BYOldgA"), is_link("four-bar.toml")
    (True, False)
    """
    given = given.lstrip()
    return bool(
        _ADDRESS.match(given) or _CODE.match(given) or _CODE.match(given, given.find("#") + 1)
    )


def text_of_link(link: str) -> str:
    """The text of the mechanism file in a link or fragment, with or without its ``#``.

    Parameters
    ----------
    link : str
        The part before the ``#`` is not read; white space around the link is ignored.

    Raises
    ------
    MechanismFileError
        If the link has no mechanism, is of another version, too long, incomplete or damaged.
    """
    after = link.strip().rpartition("#")[2]
    found = _CODE.match(after)
    if found is None:
        _refuse(
            "has no mechanism: a link of Linkwork ends in #lw1= and the packed mechanism; "
            "nothing is read from the network"
        )
    if found[1] != _VERSION.decode():
        _refuse(
            f"is of version {found[1][:9]}, this version of Linkwork reads version "
            f"{_VERSION.decode()}: update Linkwork"
        )
    if len(after) >= LONGEST:
        _refuse(f"has {len(after) + 1:,} characters: at most {LONGEST:,} are read")
    return _unpacked(_bytes(after[found.end() :]))


def source_text(given: str) -> tuple[str, str]:
    """The text of a file, or of a link if there is no file of this name; and its name for messages.

    Raises
    ------
    MechanismFileError
        If there is neither, or it cannot be read.
    """
    # os.path.exists: for Path.exists a long name is an error
    if is_link(given) and not os.path.exists(given):
        return text_of_link(given), _WHERE
    return text_of(bytes_of(Path(given), given), given), given


def _address(app: object) -> str:
    if isinstance(app, str) and _APP.fullmatch(app):
        return app
    shown = f'"{app[:80]}"' if isinstance(app, str) else as_told(app)
    raise InputError(
        f"{shown} is not the address of an app: give its whole URL without #, as in "
        "https://example.org/linkwork/"
    )


def _refuse(message: str) -> NoReturn:
    raise MechanismFileError([Problem(key=(), message=message)], _WHERE)


@cache
def _words() -> bytes:
    """The dictionary: what mechanism files often contain, the most frequent last."""
    # as text: line ends may differ on disk
    return Path(__file__).with_name("link_words.txt").read_text(encoding="utf-8").encode()


def _check_sum(packed: bytes) -> bytes:
    return zlib.crc32(packed, zlib.crc32(_VERSION)).to_bytes(_CHECK, "big")


def _bytes(code: str) -> bytes:
    """The compressed text, complete and unchanged."""
    if foreign := _FOREIGN.search(code):
        _refuse(
            f"has the character {foreign[0]!a} at place {foreign.start() + 1} of its code, "
            "which has only letters, digits, - and _: copy the whole link again"
        )
    # one letter more than whole bytes need cannot come from an encoder
    data = b"" if len(code) % 4 == 1 else base64.urlsafe_b64decode(code + "=" * (-len(code) % 4))
    check, packed = data[:_CHECK], data[_CHECK:]
    # a second spelling of the same bytes: the last letter has bits that are not used
    spelled = base64.urlsafe_b64encode(data).decode().rstrip("=")
    if spelled != code or check != _check_sum(packed):
        _refuse("is incomplete or was changed on its way: copy the whole link again")
    return packed


def _unpacked(packed: bytes) -> str:
    """The text of the file; inflating stops at the largest size of a file."""
    inflater = zlib.decompressobj(-15, _words())
    try:
        data = inflater.decompress(packed, LARGEST + 1)
        if len(data) > LARGEST:
            _refuse(f"unpacks to more than {LARGEST / 1e6:.0f} MB: more is not read")
        text = data.decode("utf-8")
    except (zlib.error, UnicodeDecodeError):
        text = "\0"
    if "\0" in text or not inflater.eof or inflater.unused_data:
        _refuse("is damaged: its code is not that of a mechanism file")
    return text
