"""The text under edit: a mechanism, or a draft with what it lacks."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.drawing.label_placement import Kept
from linkwork.foundation.errors import InputError, MechanismError, Problem
from linkwork.mechanism.description import Description
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.skeleton import Skeleton
from linkwork.results.quantity import Units
from linkwork.textfile.reader import read_draft
from linkwork.viewer.live.solvable import Read, Solvable
from linkwork.viewer.page_data import PageData
from linkwork.viewer.still_page import still_page

__all__ = ["Subject", "read_subject"]


@dataclass(frozen=True, kw_only=True)
class Subject:
    """A text with its mechanism, or, without one, its draft and the problems.

    ``readable``: whether edits other than of the whole text are possible.
    """

    text: str
    solvable: Solvable | None = None
    draft: Draft | None = None
    problems: tuple[Problem, ...] = ()
    readable: bool = True

    @property
    def mechanism(self) -> Solvable:
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
                found = position.skeleton, position.points
                return still_page(*found, units=units, title=title, size=size, kept=kept)
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
