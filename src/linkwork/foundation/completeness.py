"""Whether a list of configurations is complete: sentences, best first."""

from __future__ import annotations

from enum import Enum

__all__ = ["Completeness"]


class Completeness(Enum):
    """How sure it is that no configuration is missing."""

    PROVED = (
        "every configuration is listed, and that is proved: "
        "as many solutions were certified as can exist at most"
    )
    WITH_PROBABILITY_ONE = (
        "every configuration is listed, with probability one: "
        "all solution paths from a random start are accounted for"
    )
    MULTIPLE = (
        "not proved: some solutions coincide, as they do at a dead point or change point; "
        "ask for an input value beside it"
    )
    NOT_PROVED = (
        "not proved: solution paths were lost, so configurations may be missing; "
        "ask for another input value"
    )
    CONTINUUM = (
        "not proved: the mechanism can still move at this input, there are infinitely many "
        "configurations; isolated ones are listed"
    )
    NOT_LISTED = "not proved: these equations have no list of configurations"

    @property
    def complete(self) -> bool:
        """Whether nothing is missing, proved or with probability one."""
        return self in (Completeness.PROVED, Completeness.WITH_PROBABILITY_ONE)

    def and_then(self, other: Completeness) -> Completeness:
        """The grade of two lists together: the worse of the two."""
        order = tuple(Completeness)
        return max(self, other, key=order.index)
