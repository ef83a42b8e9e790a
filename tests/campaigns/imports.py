"""Damaged and hostile files of other programs: each is refused with a message, or is a linkage."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from functools import cache

import numpy as np

from linkwork.core.textfile.reader import read_text
from linkwork.core.textfile.writer import write_text
from linkwork.readers.importing import FORMATS, read_foreign
from tests.campaigns.fuzzing.odd import NAMES, NUMBERS, pick
from tests.campaigns.fuzzing.texts import changed_bytes
from tests.campaigns.fuzzing.witness import Witness
from tests.readers.samples import GEOGEBRA, SAMPLES, packed

__all__ = ["import_campaign"]

_TOKEN = re.compile(rb'"[^"\n]*"|[-+]?\d[\d.eE+-]*|[^\W\d]\w*|[^\s\w]|\n')
_DEEP = 30_000
_PIECE = 4000  # bytes in which a token is looked for
_TIMES = (1, 1, 1, 1, 2, 2, 3)


def import_campaign(part: int, count: int) -> tuple[Counter[str], list[str]]:
    """Counts and false claims of so many files, the formats in turn."""
    counts: Counter[str] = Counter()
    false: list[str] = []
    for number in range(part * count, (part + 1) * count):
        rng = np.random.default_rng([22, number])
        form = list(FORMATS)[number % len(FORMATS)]
        witness = Witness()
        name, data = _changed(rng, form)
        wanted = pick(rng, list(FORMATS)) if rng.random() < 0.05 else form
        _read(witness, data, name, None if rng.random() < 0.2 else wanted)
        counts += witness.counts
        counts[f"files {form}"] += 1
        false += [f"{number}, {name}: {what}" for what in witness.false]
    return counts, false


def _read(witness: Witness, data: bytes, name: str, wanted: str | None) -> None:
    found = witness.call("read", lambda: read_foreign(data, name, wanted))
    if found is None:
        return
    witness.counts["files read"] += 1
    if not str(found).strip():
        witness.false.append("no summary")
    witness.call("make", found.missing)
    text = witness.call("write", lambda: write_text(found.description))
    back = None if text is None else witness.call("read back", lambda: read_text(text))
    if back is not None and back.description != found.description:
        witness.false.append("another linkage is read back from its file")
    elif back is None:
        witness.false.append("its file is refused")


@cache
def _samples(form: str) -> tuple[tuple[str, bytes], ...]:
    module = FORMATS[form]
    heads = {name: data[:4000].decode("utf-8", "replace") for name, data in SAMPLES.items()}
    return tuple((name, SAMPLES[name]) for name, head in heads.items() if module.matches(head))


def _changed(rng: np.random.Generator, form: str) -> tuple[str, bytes]:
    """A sample of a format, changed one to four times."""
    name, data = pick(rng, _samples(form))
    if name.endswith(".ggb") and rng.random() < 0.7:
        # the text inside, packed again
        text = GEOGEBRA.encode()
        for _ in range(pick(rng, _TIMES)):
            text = pick(rng, _CHANGES)(rng, text)
        return name, packed(text.decode("utf-8", "replace"))
    for _ in range(pick(rng, _TIMES)):
        data = pick(rng, _CHANGES)(rng, data)
    return name, data


def _bytes(rng: np.random.Generator, data: bytes) -> bytes:
    return changed_bytes(rng, data.decode("latin-1"))


def _cut(rng: np.random.Generator, data: bytes) -> bytes:
    return data[: int(rng.integers(len(data) + 1))]


def _tokens(rng: np.random.Generator, data: bytes) -> list[re.Match[bytes]]:
    """The tokens of a piece of the file."""
    at = int(rng.integers(len(data) + 1)) if len(data) > _PIECE else 0
    return list(_TOKEN.finditer(data, at, at + _PIECE))


def _token(rng: np.random.Generator, data: bytes) -> bytes:
    """A token replaced, repeated, left out, or swapped with another."""
    found = _tokens(rng, data)
    if not found:
        return data
    one, other = pick(rng, found), pick(rng, found)
    new = pick(rng, [b"", one[0] * 2, other[0], b'"' + other[0] + b'"', b"null", b"[]", b"{}"])
    if rng.random() < 0.5:
        words = NUMBERS if one[0][:1].isdigit() or rng.random() < 0.6 else NAMES
        new = pick(rng, words).encode("utf-8", "replace")
    return data[: one.start()] + new + data[one.end() :]


def _number(rng: np.random.Generator, data: bytes) -> bytes:
    """A number at or beyond a limit."""
    found = [match for match in _tokens(rng, data) if match[0][:1] in b"0123456789-+"]
    if not found:
        return data
    one = pick(rng, found)
    return data[: one.start()] + pick(rng, NUMBERS).encode() + data[one.end() :]


def _lines(rng: np.random.Generator, data: bytes) -> bytes:
    """Lines repeated, left out, moved, many times."""
    rows = data.splitlines(keepends=True) or [b""]
    at, to = (int(rng.integers(len(rows))) for _ in range(2))
    match int(rng.integers(4)):
        case 0:
            rows[at:at] = rows[at : at + 1] * int(10 ** rng.uniform(0, 3))
        case 1:
            del rows[at : at + int(rng.integers(1, 4))]
        case 2:
            rows[at], rows[to] = rows[to], rows[at]
        case _:
            other = pick(rng, list(SAMPLES.values())).splitlines(keepends=True)
            rows[at:at] = other[: int(rng.integers(1, 5))]
    return b"".join(rows)


def _nested(rng: np.random.Generator, data: bytes) -> bytes:
    """Brackets or elements nested deeply."""
    deep = int(10 ** rng.uniform(1, np.log10(_DEEP)))
    pairs = [(b"[", b"]"), (b'{"a":', b"}"), (b"<body>", b"</body>"), (b"<a>", b"")]
    opened, closed = pick(rng, pairs)
    at = int(rng.integers(len(data) + 1))
    return data[:at] + opened * deep + b"1" + closed * deep + data[at:]


def _entities(rng: np.random.Generator, data: bytes) -> bytes:
    """Entities that expand, or that point to files and other machines."""
    bomb = b"".join(b'<!ENTITY e%d "%s">' % (k, b"&e%d;" % (k - 1) * 10) for k in range(1, 9))
    declared = pick(
        rng,
        [
            b'<!DOCTYPE a [<!ENTITY e0 "x">' + bomb + b"]>",
            b'<!DOCTYPE a [<!ENTITY e8 SYSTEM "file:///etc/passwd">]>',
            b'<!DOCTYPE a SYSTEM "http://example.org/a.dtd">',
            b'<!DOCTYPE a [<!ENTITY % e8 SYSTEM "file:///etc/hostname"> %e8;]>',
        ],
    )
    text = data.removeprefix(b'<?xml version="1.0" encoding="utf-8"?>\n')
    used = text.replace(b'"true"', b'"&e8;"', 1) if rng.random() < 0.5 else text
    return declared + used


def _encoded(rng: np.random.Generator, data: bytes) -> bytes:
    """Another encoding, stated or not."""
    text = data.decode("utf-8", "replace")
    encoding = pick(rng, ["utf-16", "utf-32", "latin-1", "utf-7", "cp037"])
    stated = b'<?xml version="1.0" encoding="' + pick(rng, [b"utf-7", b"x", b"utf-16"]) + b'"?>'
    return pick(rng, [text.encode(encoding, "replace"), stated + data, b"\xef\xbb\xbf" + data])


def _large(rng: np.random.Generator, data: bytes) -> bytes:
    """Much of the same, also packed."""
    piece = pick(rng, [b"A", b" ", b"\n", b"0\n", b'<a b="c"/>', b"J[R, P[0, 0], L[a]],", b"[1],"])
    many = piece * int(10 ** rng.uniform(2, 6))
    return packed(many.decode()) if rng.random() < 0.3 else data + many


Change = Callable[[np.random.Generator, bytes], bytes]
_CHANGES: tuple[Change, ...] = (
    *(_token, _number) * 4, *(_bytes, _lines) * 2, _cut, _nested, _entities, _encoded, _large,
)  # fmt: skip
