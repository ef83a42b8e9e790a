"""Whether a list of configurations is complete, as sentences, strongest first."""

from __future__ import annotations

from enum import Enum

__all__ = ["Completeness"]


class Completeness(Enum):
    """Whether a list of configurations or circuits is complete; the value is a sentence.

    The members are ordered from the strongest statement to the weakest.

    Examples
    --------
    >>> import linkwork as lw
    >>> found = lw.example("four-bar").configurations(60).completeness
    >>> found is lw.Completeness.PROVED, found.complete
    (True, True)
    """

    PROVED = (
        "the list is proved complete: "
        "the number of certified solutions equals the largest possible number"
    )
    WITH_PROBABILITY_ONE = (
        "the list is complete with probability one: "
        "all solution paths from a random start are accounted for"
    )
    MULTIPLE = (
        "not proved: some solutions coincide, as they do at a dead point or change point; "
        "use a nearby input value"
    )
    NOT_PROVED = (
        "not proved: solution paths were lost, so configurations may be missing; "
        "use another input value"
    )
    CONTINUUM = (
        "not proved: the mechanism can still move at this input, there are infinitely many "
        "configurations; isolated ones are listed"
    )
    SAMPLED = "a sample: the conditions leave infinitely many solutions"
    NOT_LISTED = "not proved: configurations of plain equations cannot be listed"

    @property
    def complete(self) -> bool:
        """Whether nothing is missing, proved or with probability one."""
        return self in (Completeness.PROVED, Completeness.WITH_PROBABILITY_ONE)

    def and_then(self, other: Completeness) -> Completeness:
        """The completeness of two lists together: the weaker of the two."""
        order = tuple(Completeness)
        return max(self, other, key=order.index)
