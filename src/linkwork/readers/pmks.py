"""The code of a PMKS+ link: settings, joints, links and forces between dots, and a check sum.

Whole numbers have the digits 0-9, A-Z, a-z, _ and -; a leading 0 is the sign minus. Decimal numbers
are counted in thousandths. After ``transcoding/string-transcoder.ts`` and ``checksum.ts`` of
github.com/PMKS-Web/PMKSWeb; the last letter is the length of the code before it, modulo 62.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import Any
from urllib.parse import unquote

from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND
from linkwork.readers.assembly import Assembly, Drawn, JointRow, Source, add_joints, drive_joint

_CHECKS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
_DIGITS = _CHECKS + "_-"
_PER_UNIT = 1000
_UNITS = {"0": "in", "1": "cm", "2": "m"}
_SLIDES, _DRIVEN, _FIXED, _WELDED = 1, 2, 4, 8  # flags of a joint
_CODE = re.compile(r"[\w-]{1,2}\.[\w,-]+\.[\w,-]+\.\w{0,4}\.", re.ASCII)
_DIGEST = re.compile(r"\*[0-9A-Za-z]{6}$")
_MOST = 12  # digits of a number


def is_code(text: str) -> bool:
    """Whether a text begins like a code."""
    return _CODE.match(text) is not None


@dataclass(frozen=True, kw_only=True)
class _Joint:
    id: str
    name: str
    flags: int
    at: complex
    angle: float
    slot: tuple[str, str, str] | None


@dataclass(frozen=True, kw_only=True)
class _Link:
    id: str
    name: str
    joints: tuple[str, ...]


def read_code(source: Source, code: str) -> Assembly:
    """Read a code."""
    # newer links add a digest of the text, older ones have the length alone
    body = _DIGEST.sub("", code)
    if not body or body[-1] != _CHECKS[(len(body) - 1) % len(_CHECKS)]:
        source.refuse("its check sum is wrong: the link is cut or changed, copy it again")
    sections = body[:-1].split(".")
    reader = _Code(source, sections[4:])
    joints = list(map(reader.joint, reader.section("joints")))
    links = [link for link in map(reader.link, reader.section("links")) if link is not None]
    for force in reader.section("forces"):
        source.leave_out(f"force {force[1:].partition(',')[0][:40]}", "force")
    if len(reader.left) > 1:
        source.leave_out("the end of the link", "locks, colours and designs of synthesis")
    speed = reader.number(sections[2].split(",")[0], "the input speed")
    # the last digit holds the first flags
    clockwise = _DIGITS.index(sections[0][-1]) & 1
    turning = f"{-speed if clockwise else speed} rpm" if speed else None
    return _pmks_code_assembled(source, _UNITS.get(sections[3][:1], "unit"), joints, links, turning)


class _Code:
    """The sections of a code after the settings."""

    def __init__(self, source: Source, left: list[str]) -> None:
        self.source, self.left = source, left

    def section(self, what: str) -> list[str]:
        """The records up to the next empty one."""
        # the oldest links end with their forces
        if "" not in self.left:
            if what == "forces":
                section, self.left = self.left, []
                return section
            self.source.refuse(f"the link ends before its {what}")
        end = self.left.index("")
        section, self.left = self.left[:end], self.left[end + 1 :]
        return section

    def number(self, digits: str, what: str) -> int:
        """A whole number."""
        if not digits or len(digits) > _MOST or not all(digit in _DIGITS for digit in digits):
            self.source.refuse(f'{what} is "{digits[:40]}", which is no number of PMKS+')
        size = 0
        for digit in digits:
            size = size * len(_DIGITS) + _DIGITS.index(digit)
        return -size if digits[0] == "0" else size

    def joint(self, record: str) -> _Joint:
        words = record.split(",")
        if len(words) < 5 or words[0][:1] not in set(_DIGITS) or len(words[0]) < 2:
            self.source.refuse(f'joint "{record[:40]}" needs flags, name, x, y and angle')
        x, y, turn = (
            self.number(word, f"a number of joint {words[1][:40]}") for word in words[2:5]
        )
        return _Joint(
            id=words[0][1:],
            name=words[1],
            flags=_DIGITS.index(words[0][0]),
            at=complex(x / _PER_UNIT, y / _PER_UNIT),
            angle=turn / _PER_UNIT,
            slot=(words[5], words[6], words[7]) if len(words) > 7 and all(words[5:8]) else None,
        )

    def link(self, record: str) -> _Link | None:
        """A link; ``None`` for a part of a welded one."""
        words = record.split(",")
        if len(words) < 8 or len(words[0]) < 3:
            self.source.refuse(f'link "{record[:40]}" needs a name, masses and joints')
        entries = words[7:]
        joints = tuple(entries[: entries.index("")] if "" in entries else entries)
        name = words[1]
        if any(self.number(word, f"a mass of link {name[:40]}") for word in words[2:4]):
            self.source.leave_out(f"link {name[:40]}", "mass: the link does not state its unit")
        # the welded link lists all joints itself
        if words[0][0] in "Namg4567":
            return None
        return _Link(id=words[0][2:], name=name, joints=joints)


def _pmks_code_assembled(
    source: Source, unit: str, joints: list[_Joint], links: list[_Link], speed: str | None
) -> Assembly:
    assembly = Assembly(source)
    assembly.length = unit
    known = {joint.id: joint for joint in joints}
    carried: dict[str, list[_Link]] = {}
    for link in links:
        for joint_id in link.joints:
            if joint_id not in known:
                source.refuse(f'link "{link.name[:40]}" has an unknown joint "{joint_id[:40]}"')
            carried.setdefault(joint_id, []).append(link)
    # a block joins a slide to the pin at the same place
    # in older links a block joins a slide to its pin
    blocks = {link.id for link in links if any(known[j].flags & _SLIDES for j in link.joints)}
    blocks = {link.id for link in links if link.id in blocks and len(link.joints) == 2}
    names = {link.id: assembly.add_link(link.name) for link in links if link.id not in blocks}
    points: dict[str, str] = {}
    driven: list[tuple[str, list[str]]] = []
    for joint in joints:
        joined = [names[link.id] for link in carried.get(joint.id, ()) if link.id in names]
        if joint.flags & _SLIDES and not joined:
            continue
        fixed = bool(joint.flags & _FIXED) and not joint.flags & _SLIDES
        points[joint.id] = assembly.add_point(joint.name, joint.at, fixed)
        for name in joined:
            assembly.put_on(name, points[joint.id])
        if joint.flags & _DRIVEN and not joint.flags & _SLIDES:
            pinned = [GROUND, *joined] if fixed else joined
            driven.append((f"joint {joint.name[:40]}", pinned))
        if joint.flags & _WELDED and not joint.flags & _SLIDES and len(joined) > 1:
            source.leave_out(f"joint {joint.name[:40]}", "weld: its links turn against each other")
    for joint in joints:
        if joint.flags & _SLIDES:
            _add_slide(assembly, joint, known, carried, names, points)
    for place, pinned in driven:
        drive_joint(assembly, place, pinned, speed)
    return assembly


def _add_slide(
    assembly: Assembly,
    joint: _Joint,
    known: dict[str, _Joint],
    carried: dict[str, list[_Link]],
    names: dict[str, str],
    points: dict[str, str],
) -> None:
    """A slide on ground or in the slot of a link: of a point, or of the pin of its block."""
    source, place = assembly.source, f"joint {joint.name[:40]}"
    pin = joint
    for link in carried.get(joint.id, ()):
        if link.id not in names:
            pin = next((known[j] for j in link.joints if j != joint.id), joint)
    if pin.id not in points:
        source.leave_out(place, "slide without a pin")
        return
    point = points[pin.id]
    on, line = GROUND, None
    if joint.slot is not None:
        carrier, first, second = joint.slot
        if carrier not in names or first not in points or second not in points:
            source.leave_out(place, "slot on a link that is not there")
            return
        on, line = names[carrier], (points[first], points[second])
    if point in assembly.carries(on):
        source.leave_out(place, "slide of a point that is fixed on the link with the slot")
        return
    links = [link for link in assembly.carriers(point) if link != GROUND]
    if line is None:
        along = complex(math.cos(joint.angle), math.sin(joint.angle))
        line = assembly.guide(on, point, along)
    # a weld between block and pin: the link does not turn
    if pin.flags & _WELDED and pin is not joint and len(links) == 1:
        assembly.add_slider(f"s_{point}", links[0], point, on, line)
    else:
        assembly.add_slot(f"s_{point}", point, on, line)
    if pin is joint:
        source.leave_out(place, "whether the slide turns: read as a pin in a slot")
    if joint.flags & _DRIVEN:
        source.leave_out(place, "the input: a driven slide, whose range the link does not state")


def _digits(number: int) -> str:
    size, text = abs(number), ""
    while size or not text:
        size, digit = divmod(size, len(_DIGITS))
        text = _DIGITS[digit] + text
    return f"0{text}" if number < 0 else text


def _decimal(number: float) -> str:
    if not abs(number) < 1e15:
        raise InputError(f"{number:g} is too large for a link of PMKS+")
    return _digits(round(number * _PER_UNIT))


def code_of(drawn: Drawn) -> str:
    """The code of a linkage; coordinates are rounded to thousandths, names to plain letters.

    Raises
    ------
    InputError
        If the linkage has slides on moving links or sliders of several links.
    """
    driven = drawn.driven_pins()
    joints: list[tuple[Any, ...]] = []
    blocks: list[tuple[str, str]] = []
    ids: dict[str, str] = {}
    unit = {name: digit for digit, name in _UNITS.items()}.get(drawn.linkage.length)
    if unit is None:
        drawn.leave_out(
            drawn.linkage.length, "unit of length: links have in, cm and m; cm is written"
        )
    for row in drawn.joints():
        if row.kind != "R" and row.links[0] != GROUND:
            raise InputError(
                f'"{row.place}" slides on "{row.links[0]}": links of PMKS+ are written with slides '
                "on ground only"
            )
        x, y = _decimal(row.at.real), _decimal(row.at.imag)
        if row.kind != "P":
            number = ids[row.name] = str(len(ids) + 1)
            fixed = GROUND in row.links and row.kind == "R"
            # the slide, not its pin, is on ground
            flags = _FIXED * fixed + _DRIVEN * (row.name in driven)
            joints.append((flags, number, _allowed_name(row.name), x, y, "0"))
        if row.kind != "R":
            pin = ids[row.name]
            blocks.append((f"S{pin}", pin))
            joints.append((_SLIDES + _FIXED, f"S{pin}", f"S{pin}", x, y, _decimal(row.angle)))
            if row.kind == "P" and _is_alone(drawn, row):
                joints = [
                    (flags | _WELDED * (number == pin), number, *rest)
                    for flags, number, *rest in joints
                ]
    links = {n: points for n, points in drawn.linkage.links.items() if n != GROUND}
    parts = [
        "".join(f"{_DIGITS[flags]}{','.join(rest)}." for flags, *rest in joints),
        "".join(
            f"YR{k},{_allowed_name(name)},0,0,0,0,c5cae9,{','.join(ids[p] for p in members)},,."
            for k, (name, members) in enumerate(links.items(), 1)
        ),
        "".join(f"YPB{slide},B{slide},0,0,0,0,c5cae9,{pin},{slide},,." for slide, pin in blocks),
    ]
    if driven:
        drawn.leave_out("the link", "speed of the input: 10 rpm is written")
    code = f"0O.SS.A,0.{unit or '1'}010.{parts[0]}.{parts[1]}{parts[2]}..N"
    return code + _CHECKS[len(code) % len(_CHECKS)]


def _is_alone(drawn: Drawn, row: JointRow) -> bool:
    """Whether only the sliding link has the pin, which is then welded to the block.

    Raises
    ------
    InputError
        If other links turn on a pin of a sliding link with further points.
    """
    link = row.links[1]
    carriers = [name for name, points in drawn.linkage.links.items() if row.name in points]
    if carriers == [link]:
        return True
    if len(drawn.linkage.links.get(link, ())) != 1:
        raise InputError(
            f'"{row.place}": links turn on the pin {row.name} of "{link}", which slides without '
            "turning and has other points: links of PMKS+ cannot say this"
        )
    drawn.leave_out(link, "the sliding block, which only guides its pin")
    return False


def _allowed_name(name: str) -> str:
    return re.sub(r"[^\w-]", "_", name, flags=re.ASCII)


# ----------------------------------------------------------------------
# PMKS and PMKS+: saved texts and links; nothing is read from the network.
#
# Three kinds, after github.com/DesignEngrLab/PMKS and github.com/PMKS-Web/PMKSWeb:
#
# * lines of joints, ``ground,input,R,0,0``, one a line or between ``|`` after ``mech=``;
# * the first links of PMKS+, ``?j=A,1.4,0.485,AB,R,t,0,0.1,t,…``;
# * its present links, with a check sum.


TITLE, SUFFIXES = "PMKS or PMKS+ link or text", (".pmks",)
_APP = "https://app.pmksplus.com/?"
_LINKS = r"(?P<links>[^\s,|]+(?:[\s,]+[^\s,|]+)*?)[\s,]+(?P<kind>R|P|RP|G)[\s,]+"
_SIZE = r"[-+.\d][^\s,]*"
_BEGIN = re.compile(rf"{_LINKS}[-+.\d]", re.IGNORECASE)
#: Links, type, place, angle and flags; a link may be called R or P, numbers follow the type.
_ROW = re.compile(
    rf"{_LINKS}(?P<x>{_SIZE})[\s,]+(?P<y>{_SIZE})(?:[\s,]+(?P<angle>{_SIZE}))?"
    r"(?:[\s,]+(?P<flags>[^\s,]+))?(?:[\s,]+(?P<rest>[^\s,]+).*)?",
    re.IGNORECASE,
)
_HOSTS = re.compile(r"https?://\S*pmks", re.IGNORECASE)


def matches(head: str) -> bool:
    """Whether a text begins like this format."""
    text = head.strip()
    return bool(_HOSTS.match(text) or _BEGIN.match(text) or text.startswith("pmks2:"))


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
        row = row.strip(" \t,")
        if not row:
            continue
        match = _ROW.fullmatch(row)
        if match is None:
            source.refuse("is not a joint: links, type (R, P, RP), x and y", line)
        kind, place = match["kind"].upper(), f"line {line}"
        if match["rest"]:
            source.leave_out(place, f'"{match["rest"][:40]}" after the flags')
        at = source.point(match["x"], match["y"], "a coordinate", line)
        turn = source.number(match["angle"] or "0", "the angle", line)
        if kind == "G":
            source.leave_out(place, "gear joint")
            continue
        rows.append(
            JointRow(
                place=place,
                kind=kind,
                at=at,
                links=tuple(
                    GROUND if name.lower() == GROUND else name
                    for name in re.split(r"[\s,]+", match["links"])
                ),
                angle=math.radians(turn),
                input=re.fullmatch("...t", match["flags"] or "") is not None,
                name=f"P{len(rows) + 1}",
            )
        )
    if not any(row.input for row in rows):
        # before flags existed, the driven link was the one of this name
        driven = [k for k, row in enumerate(rows) if {GROUND, "input"} == set(row.links)]
        for k in driven[:1]:
            rows[k] = replace(rows[k], input=True)
    return _pmks_assembled(source, rows)


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
                at=source.point(x, y, f"a coordinate of {place}"),
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
    assembly = _pmks_assembled(source, rows)
    assembly.length = settings[-1] if settings[-1] in ("m", "cm", "in") else assembly.length
    return assembly


def _pmks_assembled(source: Source, rows: list[JointRow]) -> Assembly:
    assembly = Assembly(source)
    # neither form states it
    assembly.length = "unit"
    if not any(row.input for row in rows):
        source.leave_out("the file", "the input: none is marked")
    add_joints(assembly, rows)
    return assembly


def write(drawn: Drawn) -> str:
    """Write a link of PMKS+, with coordinates in thousandths of the unit of length."""
    return f"{_APP}{code_of(drawn)}\n"
