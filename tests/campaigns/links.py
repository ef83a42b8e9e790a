"""Damaged and forged links: each is refused with a message, or is the text that was packed."""

from __future__ import annotations

import base64
import tracemalloc
import zlib
from collections import Counter
from collections.abc import Callable
from functools import cache
from importlib import resources

import numpy as np

import linkwork as lw
from linkwork.core.textfile.link import LONGEST, fragment_of, is_link, text_of_link
from linkwork.core.textfile.toml_text import LARGEST
from tests.campaigns.fuzzing.odd import pick
from tests.campaigns.fuzzing.texts import changed_bytes, library_text
from tests.campaigns.fuzzing.witness import Witness

__all__ = ["forged", "link_campaign", "squeezed"]

_MOST_TIME = 0.5  # seconds of processor time to unpack a link
_MOST_MEMORY = 8 * LARGEST  # bytes to unpack a link
_LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"
_FOREIGN = "=+/.,;:!?&%#<>\"'()[]{} \t\n\r\0\x7f\u200b\u00e9\u0661\ud800\U0001f600"
_LARGEST_BOMB = 2e7  # bytes
_REPEATED = (b"\0", b"a", b"#", b"[[", b"\n", b"x = 1\n", b"\xff", "é".encode())


def squeezed(data: bytes) -> bytes:
    """Raw deflate of any bytes, with the dictionary of links."""
    words = resources.files("linkwork.core.textfile") / "link_words.txt"
    packer = zlib.compressobj(
        9, zlib.DEFLATED, -15, 9, zlib.Z_DEFAULT_STRATEGY, words.read_text("utf-8").encode()
    )
    return packer.compress(data) + packer.flush()


def forged(packed: bytes) -> str:
    """A fragment of any bytes whose check sum is right."""
    check = zlib.crc32(packed, zlib.crc32(b"1")).to_bytes(4, "big")
    return "#lw1=" + base64.urlsafe_b64encode(check + packed).decode().rstrip("=")


def link_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of so many links."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    for number in range(part * count, (part + 1) * count):
        rng = np.random.default_rng([19, number])
        witness = Witness()
        kind = str(rng.choice(list(_KINDS), p=[share for _, share in _KINDS.values()]))
        _KINDS[kind][0](rng, witness)
        counts += witness.counts
        counts[f"links {kind}"] += 1
        false += [f"{number}, {kind}: {what}" for what in witness.false]
    return counts, false


@cache
def _library_links() -> tuple[tuple[str, str], ...]:
    texts = map(lw.example_text, lw.examples())
    return tuple((text, fragment_of(text)) for text in texts)


def _read(link: str, witness: Witness) -> str | None:
    """The text of a link; the mechanism in it is read too."""
    text = witness.call("unpack", lambda: text_of_link(link), _MOST_TIME)
    witness.counts["links refused" if text is None else "links read"] += 1
    if text is None:
        return None
    if is_link(link):
        witness.call("load", lambda: lw.load(link))
    if text_of_link(fragment_of(text)) != text:
        witness.false.append("its text does not come back")
    return text


def _damaged(rng: np.random.Generator, witness: Witness) -> None:
    """A link of the library, changed on its way: refused, or the text that was packed."""
    packed, link = pick(rng, _library_links())
    if rng.random() < 0.5:
        link = "https://example.org/app/" + link
    for _ in range(int(rng.integers(1, 4))):
        link = pick(rng, _CHANGES)(rng, link)
    text = _read(link, witness)
    if text is None:
        return
    # another link of the library may have been put in its place
    if text != packed and all(text != other for other, _ in _library_links()):
        witness.false.append(f"another text is read from {link!r}")


def _spoiled(rng: np.random.Generator, witness: Witness) -> None:
    """Other compressed bytes with the right check sum: refused, or what zlib unpacks."""
    packed = bytearray(squeezed(pick(rng, _library_links())[0].encode()))
    for _ in range(int(rng.integers(1, 6))):
        at = int(rng.integers(len(packed)))
        match int(rng.integers(4)):
            case 0:
                packed[at] ^= 1 << int(rng.integers(8))
            case 1:
                del packed[at : at + int(rng.integers(1, 9))]
            case 2:
                packed[at:at] = rng.bytes(int(rng.integers(1, 9)))
            case _:
                packed[at:] = rng.bytes(len(packed) - at)
        packed = packed or bytearray(b"\0")
    text = _read(forged(bytes(packed)), witness)
    if text is not None and text.encode() != _slowly(bytes(packed)):
        witness.false.append("another text is read than zlib unpacks")


def _slowly(packed: bytes) -> bytes | None:
    """The same bytes, unpacked one by one; ``None`` if they do not end where the text ends."""
    words = resources.files("linkwork.core.textfile") / "link_words.txt"
    inflater = zlib.decompressobj(-15, words.read_text("utf-8").encode())
    found = b"".join(inflater.decompress(packed[k : k + 1]) for k in range(len(packed)))
    return found if inflater.eof and not inflater.unused_data else None


def _written(rng: np.random.Generator, witness: Witness) -> None:
    """A file that somebody has changed, packed well: its bytes, or refused as not text."""
    data = changed_bytes(rng, library_text(rng))
    text = _read(forged(squeezed(data)), witness)
    if text is None:
        try:
            is_text = b"\0" not in data and bool(data.decode("utf-8")) | (not data)
        except UnicodeDecodeError:
            is_text = False
        if is_text and len(data) <= LARGEST and len(forged(squeezed(data))) <= LONGEST:
            witness.false.append("a text is refused")
    elif text.encode() != data:
        witness.false.append("another text is read")


def _random(rng: np.random.Generator, witness: Witness) -> None:
    """Random characters are no link."""
    letters = pick(rng, (_LETTERS, _LETTERS + _FOREIGN, _FOREIGN))
    count = int(10 ** rng.uniform(0, 5.2))
    code = "".join(letters[k] for k in rng.integers(len(letters), size=count))
    head = pick(rng, ("#lw1=", "lw1=", "https://example.org/#lw1=", "#lw2=", "#", "", "http://"))
    if _read(head + code, witness) is not None:
        witness.false.append("random characters are read")


def _bomb(rng: np.random.Generator, witness: Witness) -> None:
    """Few characters that would unpack to many: refused early."""
    piece = pick(rng, _REPEATED)
    count = int(10 ** rng.uniform(np.log10(LARGEST + 10), np.log10(_LARGEST_BOMB)))
    link = forged(squeezed(piece * (count // len(piece) + 1)))
    tracemalloc.start()
    text = witness.call("unpack", lambda: text_of_link(link), _MOST_TIME)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    witness.counts["links refused" if text is None else "links read"] += 1
    if text is not None or peak > _MOST_MEMORY:
        witness.false.append(f"{count} bytes are unpacked with {peak} bytes of memory")


Change = Callable[[np.random.Generator, str], str]


def _at(rng: np.random.Generator, link: str) -> int:
    return int(rng.integers(len(link) + 1))


def _replaced(rng: np.random.Generator, link: str) -> str:
    at = _at(rng, link)
    return link[:at] + pick(rng, tuple(_LETTERS + _FOREIGN)) + link[at + 1 :]


def _inserted(rng: np.random.Generator, link: str) -> str:
    at = _at(rng, link)
    return link[:at] + pick(rng, tuple(_LETTERS + _FOREIGN)) + link[at:]


def _swapped(rng: np.random.Generator, link: str) -> str:
    a, b = sorted((_at(rng, link), _at(rng, link)))
    if b >= len(link) or a == b:
        return link
    return link[:a] + link[b] + link[a + 1 : b] + link[a] + link[b + 1 :]


def _cut(rng: np.random.Generator, link: str) -> str:
    at = _at(rng, link)
    return link[:at] if rng.random() < 0.7 else link[at:]


def _without(rng: np.random.Generator, link: str) -> str:
    at = _at(rng, link)
    return link[:at] + link[at + int(rng.integers(1, 9)) :]


def _last_letter(rng: np.random.Generator, link: str) -> str:
    return link[:-1] + pick(rng, tuple(_LETTERS))


def _joined(rng: np.random.Generator, link: str) -> str:
    at = _at(rng, link)
    return link[:at] + pick(rng, _library_links())[1][int(rng.integers(6)) :]


def _padded(rng: np.random.Generator, link: str) -> str:
    return link + pick(rng, ("=", "==", "A", "AA", "AAAA", " ", "\n", ".", "&x=1", "%3D"))


def _other_case(_: np.random.Generator, link: str) -> str:
    return link.swapcase()


def _other_version(rng: np.random.Generator, link: str) -> str:
    return link.replace(
        "lw1=", pick(rng, ("lw0=", "lw2=", "lw01=", "lw=", "lw-1=", "lw¹=", "LW1="))
    )


_CHANGES: tuple[Change, ...] = (
    _replaced,
    _inserted,
    _swapped,
    _cut,
    _without,
    _last_letter,
    _joined,
    _padded,
    _other_case,
    _other_version,
)

#: What is tried, and its share.
_KINDS: dict[str, tuple[Callable[[np.random.Generator, Witness], None], float]] = {
    "damaged": (_damaged, 0.5),
    "forged with other bytes": (_spoiled, 0.2),
    "forged with another file": (_written, 0.2),
    "of random characters": (_random, 0.08),
    "forged as bombs": (_bomb, 0.02),
}
