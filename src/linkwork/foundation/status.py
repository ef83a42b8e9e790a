"""The status of a computation: an enumeration whose values are sentences with a next step."""

from __future__ import annotations

from linkwork.foundation.coded_enum import CodedEnum

__all__ = ["CONVERGED", "Status"]


class Status(CodedEnum):
    """How a computation ended; the value is a sentence with a next step.

    Examples
    --------
    >>> import linkwork as lw
    >>> status = lw.example("four-bar").solve(at=60).status
    >>> status is lw.Status.CONVERGED, status.value
    (True, 'position found')
    """

    CONVERGED = "position found"
    SINGULAR_JACOBIAN = (
        "the Jacobian became singular during the iteration: start from another guess, "
        "or the mechanism is at a dead point or change point"
    )
    DIVERGED = "the iteration diverged to infinity: start from a guess nearer to the position"
    STEP_LIMIT = (
        "no position after the largest allowed number of iterations: "
        "start from a nearer guess or allow more iterations"
    )
    CANNOT_CLOSE = (
        "the loops cannot be closed near the guess: "
        "change a length, or start from another guess or input value"
    )
    OUT_OF_REACH = (
        "this branch does not reach the input value: "
        "the motion ends at the limit reported, ask for values before it"
    )
    OUT_OF_CIRCUIT = (
        "this circuit does not reach the input value on any of its branches: "
        "the motion reverses at the limits reported, ask for values between them"
    )
    CHANGE_POINT = (
        "the motion reaches a change point, where two branches cross, before this input value: "
        "ask for values before it, or start from a guess beyond it"
    )
    START_SINGULAR = (
        "the start is a dead point or change point, where the direction of motion is undetermined: "
        "start from a guess near it"
    )
    LOST = (
        "the branch could not be followed reliably up to this input value: "
        "ask for a value before the last one reached, or start from a guess beyond it"
    )
    DOES_NOT_FIT = (
        "a redundant link does not fit into the position of the others: "
        "change its length, or leave the link out"
    )
    NO_START = "no position was found at the guess, so there is no motion to follow: see the start"
    ROOT_NOT_PROVED = (
        "the residual is small, but no root is proved, it is a multiple root or none: "
        "start from another guess, or write the equation so that the root is simple"
    )

    @property
    def ok(self) -> bool:
        """Whether a position was found."""
        return self is Status.CONVERGED


#: The code of a position that was found.
CONVERGED = Status.CONVERGED.code
