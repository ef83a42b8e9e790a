"""The text under edit: a mechanism, or a draft with its missing items."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from linkwork.app.live.file_state import Lack, Remedy
from linkwork.app.live.requests import (
    AddPart,
    MovePoint,
    RemoveLink,
    RemovePart,
    RemovePoint,
    SetGround,
    SetInput,
)
from linkwork.app.pages.offline_page import still_page
from linkwork.app.pages.page_data import PageData
from linkwork.circuits.failure.remedies import nearest_assembly
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.drawing.labels import Kept
from linkwork.core.foundation.errors import InputError, MechanismError, Problem, key_text
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.linkage import Draft, Linkage
from linkwork.core.mechanism.part.gears import ArmPair
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.mechanism.skeleton import Skeleton
from linkwork.core.results.quantity import Units
from linkwork.core.textfile.reader import read_draft

#: Builds a mechanism from a text and its name for messages; raises ``MechanismFileError``.
Read = Callable[[str, str], Mechanism]


@dataclass(frozen=True, kw_only=True)
class Subject:
    """A text with its mechanism, or, without one, its draft and the problems.

    ``readable``: whether edits other than of the whole text are possible.
    """

    text: str
    solvable: Mechanism | None = None
    draft: Draft | None = None
    problems: tuple[Problem, ...] = ()
    readable: bool = True

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism.

        Raises
        ------
        InputError
            If the text is a draft.
        """
        if self.solvable is None:
            problem = self.problems[0].message if self.problems else "the draft is empty"
            raise InputError(f"this draft is not a mechanism yet: {problem}")
        return self.solvable

    @property
    def description(self) -> Description:
        """What the text describes."""
        if self.solvable is not None:
            return self.solvable.description
        assert self.draft is not None
        return self.draft

    def places(self) -> dict[str, tuple[float, float]]:
        """The points at the assembled start; empty if it cannot be assembled."""
        position = None if self.solvable is None else self.solvable.solve()
        return dict(position.points) if position is not None and position.status.ok else {}

    def page(
        self, size: float, kept: Kept | None = None, *, certify: bool = True
    ) -> PageData | None:
        """The drawing at the start, or as sketched if it cannot be assembled; ``None`` without a
        sketch.

        ``size``: the least length by which symbols are sized. ``kept``: places of names and arrows.
        ``certify``: prove the position.
        """
        if self.solvable is not None:
            position = self.solvable.solve(certify=certify)
            if position.status.ok and position.points:
                title, units = position.mechanism, position.units
                drawn = position.skeleton, position.points
                return still_page(*drawn, units=units, title=title, size=size, kept=kept)
        if not isinstance(self.description, Draft):
            return None
        draft = self.description.drawable
        places = {name: draft.sketched(name) for name in draft.points}
        outlines = dict(pair for part in draft.parts for pair in part.sketched_outlines(draft))
        return still_page(
            Skeleton.of_linkage(draft, outlines),
            {name: (place.real, place.imag) for name, place in places.items()},
            units=Units(angle=draft.angle, length=draft.length),
            title=draft.name,
            size=size,
            kept=kept,
        )


def read_subject(text: str, name: str, read: Read, *, whatever: bool = False) -> Subject:
    """Read a text.

    Parameters
    ----------
    text, name : str
        The text, and its name for messages.
    read : callable
        Builds a solvable mechanism from a text.
    whatever : bool
        Accept a text that is not even a draft, so that it can be corrected.

    Raises
    ------
    MechanismError
        If the text is neither a mechanism nor a draft.
    """
    try:
        return Subject(text=text, solvable=read(text, name))
    except MechanismError as error:
        problem = error
    try:
        file = read_draft(text, name)
    except MechanismError as error:
        if not whatever:
            raise problem from None
        return Subject(text=text, draft=Draft(), problems=error.problems, readable=False)
    return Subject(text=text, draft=file.draft, problems=file.problems or problem.problems)


# ----------------------------------------------------------------------
# What a draft lacks to be a mechanism, each with the thing concerned and its remedies.


_MOST = 12  # lacks that are listed
_MOST_DRIVES = 4  # links offered as inputs


def missing_items(subject: Subject) -> tuple[Lack, ...]:
    """What keeps a text from being a mechanism, in the order in which it is best mended."""
    if subject.draft is None:
        return ()
    draft = subject.draft.drawable
    if not subject.readable:
        return tuple(
            _of_problem(problem, draft, subject.draft) for problem in subject.problems[:_MOST]
        )
    if not any(map(len, draft.links.values())):
        text = "Draw the first link: drag from one of its ends to the other."
        return (Lack(message=text, key="", line=None, kind="", name="", remedies=()),)
    missing = [*_without_ground(draft)]
    for problem in subject.problems:
        if missing and problem.key[:1] == ("links",) and len(problem.key) == 1:
            continue  # ground is missing
        if problem.key == ("links", GROUND):
            continue
        missing.append(_of_problem(problem, draft, subject.draft))
    return tuple(missing[:_MOST])


def _without_ground(draft: Draft) -> Iterator[Lack]:
    if draft.links[GROUND]:
        return
    yield Lack(
        message="Nothing is fixed to the ground.",
        key="",
        line=None,
        kind="",
        name="",
        remedies=tuple(_fixings(draft)),
    )


def _fixings(draft: Draft) -> Iterator[Remedy]:
    """The free ends of links, to be fixed to the ground."""
    if ends := _free_ends(draft):
        yield Remedy(label=f"Fix {_listed(ends)}", edits=(SetGround(points=ends),))


def _free_ends(draft: Draft) -> tuple[str, ...]:
    """Points of one link only, at which the link can still be joined to ground."""
    carriers = draft.carriers()
    held = {point for part in draft.parts for point in _guided(part)}
    ends = []
    for link, points in draft.links.items():
        free = [point for point in points if len(carriers[point]) < 2 and point not in held]
        # a link held at two points elsewhere needs no third
        if link != GROUND and len(points) - len(free) < 2:
            ends += free if len(points) <= 2 else free[:1]
    for part in draft.parts:
        ends += [point for point in part.body if len(carriers[point]) < 2 and point not in held]
    return tuple(dict.fromkeys(ends))


def _guided(part: object) -> Iterator[str]:
    guided = getattr(part, "guided", None)
    if guided is not None:
        yield guided[1]
    yield from getattr(part, "points", None) or ()


def _of_problem(problem: Problem, draft: Draft, whole: Draft) -> Lack:
    kind, name = _thing(problem, whole)
    remedies = tuple(_remedies(problem, draft, kind, name))
    if name not in {"point": draft.points, "link": whole.links}.get(kind, (name,)):
        kind = name = ""  # the page does not show it
    key = key_text(problem.key) if kind == "" or problem.key[0] not in ("points", "links") else name
    return Lack(
        message=problem.message,
        key=key,
        line=problem.line,
        kind=kind,
        name=name,
        remedies=remedies,
    )


def _thing(problem: Problem, draft: Draft) -> tuple[str, str]:
    """The kind and name of the thing with a problem: point, link or part."""
    match problem.key:
        case ("points", str(name), *_):
            return "point", name
        case ("links", str(name), *_):
            return "link", name
        case (str(table), int(row), *_) if table in PARTS:
            parts = getattr(draft, table)
            return ("part", parts[row].label) if row < len(parts) else ("", "")
    return "", ""


def _remedies(problem: Problem, draft: Draft, kind: str, name: str) -> Iterator[Remedy]:
    carriers = draft.carriers()
    if kind == "point" and name in _free_ends(draft):  # of a cylinder
        yield Remedy(label=f"Fix {name}", edits=(SetGround(points=(name,)),))
    if kind == "point" and not carriers.get(name):
        yield Remedy(label=f"Remove {name}", edits=(RemovePoint(name=name),))
    if kind == "link" and len(draft.links.get(name, ())) < 2:
        yield Remedy(label=f"Remove {name}", edits=(RemoveLink(name=name),))
    if kind == "part":
        edit = RemovePart(name=name, whole=True)
        yield Remedy(label=f"Remove {name}", edits=(edit,))
    if problem.key[:1] == ("input",) and len(problem.key) <= 2:
        yield from _fixings(draft)
        for drive, one in _drives(draft):
            driven = SetInput(number=len(draft.inputs), drive=drive, name=one)
            yield Remedy(label=f"Drive {one}", edits=(driven,))
        for wheel in _planetary_wheels(draft):
            weld = AddPart(table="welds", typed={"links": (GROUND, wheel)})
            yield Remedy(label=f"Hold {wheel}", edits=(weld,))


def _drives(draft: Draft) -> list[tuple[str, str]]:
    """Links and sliders that can be driven: those on ground that are driven by nothing yet."""
    driven = {which.drives for which in draft.inputs}
    ground = set(draft.links[GROUND])
    carriers = draft.carriers()
    cranks = [
        ("link", link)
        for link, points in draft.links.items()
        if link != GROUND
        and len(ground & set(points)) == 1
        and (len(points) > 1 or link in draft.turning_on_one_point)
    ]
    sliding = [(p.drive, p.label) for p in draft.parts if p.drive and p.label]
    # a crank is short, and moves other links
    alone = {link for _, link in cranks if all(len(carriers[p]) < 2 for p in draft.links[link])}
    cranks.sort(key=lambda pair: (pair[1] in alone, _span(draft, pair[1])))
    return [pair for pair in (*cranks, *sliding) if pair not in driven][:_MOST_DRIVES]


def _planetary_wheels(draft: Draft) -> Iterator[str]:
    """Wheels about a fixed point in pairs with a moving arm: one of them is usually held."""
    held = {link for weld in draft.welds for link in weld.links}
    driven = {which.link for which in draft.inputs}
    wheels = {
        wheel: None
        for pair in draft.of(ArmPair)
        if pair.arm != GROUND
        for wheel, center in zip(pair.wheels, pair.centers, strict=True)
        if center in draft.links[GROUND] and wheel != GROUND
    }
    yield from (wheel for wheel in wheels if wheel not in held | driven)


def _span(draft: Draft, link: str) -> float:
    """The distance of a link's first two points: cranks are short; wheels come last."""
    if len(draft.links[link]) < 2:
        return math.inf
    first, second = draft.links[link][:2]
    return abs(draft.sketched(second) - draft.sketched(first))


def _listed(names: tuple[str, ...]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


# ----------------------------------------------------------------------
# Alternative starts of a sketch: an input value at which the loops close, and the points there.


_LOOKED_AT = 24  # rows at which closure is tried
_CLOSED = 1e-9  # relative to the gap at the start: closed


def closing_input(mechanism: Mechanism) -> Mapping[str, float]:
    """The value of a single input at which a mechanism closes that is open at its start.

    Some rows of the table are tried, those next to the start first. Empty if none closes,
    or if the start is not that of a sketch.
    """
    description = mechanism.description
    if not isinstance(description, Linkage) or len(description.inputs) != 1:
        return {}
    start = nearest_assembly(mechanism.model)
    ((name, here),) = start.input.items()
    rows = description.rows(description.inputs[0])
    some = rows[:: max(1, len(rows) // _LOOKED_AT)].tolist()
    for value in sorted(some, key=lambda value: abs(value - here)):
        if nearest_assembly(mechanism.model, {name: value}).gap <= _CLOSED * start.gap:
            return {name: value}
    return {}


def sketch_at(mechanism: Mechanism, at: Mapping[str, float]) -> tuple[MovePoint, ...]:
    """Edits that move the points of a sketch to their assembled positions at given input values.

    Raises
    ------
    InputError
        If equations define the points, or values do not match the inputs.
    """
    description = mechanism.description
    if not isinstance(description, Linkage):
        raise InputError("only the points of a sketch can be moved")
    fixed = description.links[GROUND]
    return tuple(
        MovePoint(point=name, x=x, y=y)
        for name, (x, y) in nearest_assembly(mechanism.model, at).points.items()
        if name in description.points and name not in fixed
    )
