"""PMKS and PMKS+: saved texts and links; nothing is read from the network.

Three kinds, after github.com/DesignEngrLab/PMKS and github.com/PMKS-Web/PMKSWeb:

* lines of joints, ``ground,input,R,0,0``, one a line or between ``|`` after ``mech=``;
* the first links of PMKS+, ``?j=A,1.4,0.485,AB,R,t,0,0.1,t,…``;
* its present links, with a check sum (:mod:`linkwork.exchange.pmks_code`).
"""

from __future__ import annotations

import math
import re
from urllib.parse import unquote

from linkwork.exchange.assembly import Assembly
from linkwork.exchange.drawn import Drawn
from linkwork.exchange.joint_rows import JointRow, add_joints
from linkwork.exchange.pmks_code import code_of, is_code, read_code
from linkwork.exchange.source import Source
from linkwork.foundation.names import GROUND

__all__ = ["SUFFIXES", "TITLE", "matches", "read", "write"]

TITLE, SUFFIXES = "PMKS or PMKS+ link or text", (".pmks",)
_APP = "https://app.pmksplus.com/?"
_ROW = re.compile(r"[^\s,|]+[\s,]+(?:[^\s,|]+[\s,]+)*?(?:R|P|RP|G)[\s,]+[-+.\d]", re.IGNORECASE)
_HOSTS = re.compile(r"https?://\S*pmks", re.IGNORECASE)


def matches(head: str) -> bool:
    """Whether a text begins like this format."""
    text = head.strip()
    return bool(_HOSTS.match(text) or _ROW.match(text) or text.startswith("pmks2:"))


def read(source: Source) -> Assembly:
    """Read a link or a text."""
    text = source.text().strip()
    query = text.partition("?")[2] if re.match(r"https?://", text) else text.removeprefix("?")
    query = query.partition("#")[0]
    if query.startswith("pmks2:"):
        source.refuse(
            "is a document of the newest PMKS+, which is not read yet: share a link that "
            "begins with https://app.pmksplus.com/? and has joints between points"
        )
    # a code may contain %-signs only for the letters of names
    if is_code(unquote(query)):
        return read_code(source, unquote(query))
    fields = dict(part.partition("=")[::2] for part in query.split("&") if "=" in part)
    if "j" in fields:
        return _first_links(source, {name: unquote(field) for name, field in fields.items()})
    if "mech" in fields:
        return _joint_lines(source, unquote(fields["mech"]).replace("|", "\n"))
    return _joint_lines(source, unquote(query).replace("|", "\n"))


def _joint_lines(source: Source, text: str) -> Assembly:
    """Rows of links, type, place, angle and flags."""
    rows: list[JointRow] = []
    for line, row in enumerate(text.splitlines(), 1):
        words = [word for word in re.split(r"[\s,]+", row.strip()) if word]
        if not words:
            continue
        # a link may be called R or P: numbers follow the type
        kinds = [k for k, word in enumerate(words) if k and word.upper() in ("R", "P", "RP", "G")]
        k = next((k for k in kinds if re.match(r"[-+.\d]", "".join(words[k + 1 : k + 2]))), None)
        if k is None:
            source.refuse("is not a joint: links, type (R, P, RP), x and y", line)
        if len(words) < k + 3:
            source.refuse("a joint needs x and y", line)
        x, y = (source.number(word, "a coordinate", line) for word in words[k + 1 : k + 3])
        rest = words[k + 3 :]
        turn = (
            source.number(rest.pop(0), "the angle", line) if rest and _is_number(rest[0]) else 0.0
        )
        flags = rest.pop(0) if rest else ""
        links = tuple(GROUND if name.lower() == GROUND else name for name in words[:k])
        place = f"line {line}"
        if rest:
            source.leave_out(place, f'"{rest[0][:40]}" after the flags')
        if words[k].upper() == "G":
            source.leave_out(place, "gear joint")
            continue
        drives = len(flags) == 4 and flags[3] == "t"
        rows.append(
            JointRow(
                place=place,
                kind=words[k].upper(),
                at=complex(x, y),
                links=links,
                angle=math.radians(turn),
                input=drives,
                name=f"P{len(rows) + 1}",
            )
        )
    if not any(row.input for row in rows):
        # before flags existed, the driven link was the one of this name
        driven = next(
            (k for k, row in enumerate(rows) if {GROUND, "input"} == set(row.links)), None
        )
        if driven is not None:
            own = rows[driven]
            rows[driven] = JointRow(**{**vars(own), "input": True})
    return _assembled(source, rows)


def _first_links(source: Source, fields: dict[str, str]) -> Assembly:
    """Joints of first links: name, x, y, links, type, ground, angle, friction, input."""
    rows = []
    for line, row in enumerate(fields["j"].strip("\n ,").split("\n"), 1):
        words = row.strip().strip(",").split(",")
        if len(words) < 9:
            source.refuse(f"joint {line} of the link has {len(words)} entries, it needs 9")
        name, x, y, links, kind, fixed, turn, _, drives = words[:9]
        place = f"joint {name[:40]}"
        on = tuple(filter(None, links.split("|")))
        kind = "RP" if kind == "P" else source.chosen(kind, {"R": "R", "RP": "RP"}, place)
        # the first links had no block: the joint itself slid on ground
        ground = (GROUND,) if fixed == "t" or kind == "RP" else ()
        rows.append(
            JointRow(
                place=place,
                kind=kind,
                at=complex(source.number(x, f"x of {place}"), source.number(y, f"y of {place}")),
                links=(*ground, *on),
                angle=math.radians(source.number(turn, f"angle of {place}")),
                input=drives == "t",
                name=name,
            )
        )
        if kind == "RP":
            source.leave_out(place, "whether the slide turns: read as a pin in a slot of ground")
    for key, what in (("l", "mass and shape of links"), ("f", "force"), ("pp", "path points")):
        for row in filter(None, fields.get(key, "").split("\n")):
            source.leave_out(f"link {row.partition(',')[0][:40]}", what)
    settings = fields.get("s", "").split(",")
    assembly = _assembled(source, rows)
    assembly.length = settings[-1] if settings[-1] in ("m", "cm", "in") else assembly.length
    return assembly


def _assembled(source: Source, rows: list[JointRow]) -> Assembly:
    assembly = Assembly(source)
    # neither form states it
    assembly.length = "unit"
    if not any(row.input for row in rows):
        source.leave_out("the file", "the input: none is marked")
    add_joints(assembly, rows)
    return assembly


def _is_number(word: str) -> bool:
    return re.fullmatch(r"[-+]?[\d.]+(?:[eE][-+]?\d+)?", word) is not None


def write(drawn: Drawn) -> str:
    """Write a link of PMKS+, with coordinates in thousandths of the unit of length."""
    return f"{_APP}{code_of(drawn)}\n"
