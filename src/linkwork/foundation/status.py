"""How a computation ended: one enumeration whose values are sentences with a next step."""

from __future__ import annotations

from enum import Enum

from linkwork.foundation.arrays import StatusArray

__all__ = ["CONVERGED", "Status"]


class Status(Enum):
    """The exit of a solver is its status; it is never re-derived afterwards."""

    CONVERGED = "position found"
    SINGULAR_JACOBIAN = (
        "the Jacobian became singular during the iteration: start from another guess, "
        "or the mechanism is at a dead point or change point"
    )
    DIVERGED = "the iteration ran away to infinity: start from a guess nearer to the position"
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
        "the motion turns back at the limits reported, ask for values between them"
    )
    CHANGE_POINT = (
        "the motion reaches a change point, where two branches cross, before this input value: "
        "ask for values before it, or start from a guess beyond it"
    )
    START_SINGULAR = (
        "the start itself is a dead point or change point, where the motion has no direction: "
        "start from a guess beside it"
    )
    LOST = (
        "the branch could not be followed with safety up to this input value: "
        "ask for a value before the last one reached, or start from a guess beyond it"
    )
    DOES_NOT_FIT = (
        "a redundant link does not fit into the position of the others: "
        "change its length, or leave the link out"
    )
    NO_START = "no position was found at the guess, so there is no motion to follow: see the start"

    @property
    def ok(self) -> bool:
        """Whether a position was found."""
        return self is Status.CONVERGED

    @property
    def code(self) -> int:
        """A small whole number, for arrays of statuses."""
        return _CODES[self]

    @classmethod
    def of_code(cls, code: int) -> Status:
        """The status with this code."""
        return _MEMBERS[code]

    @classmethod
    def of_codes(cls, codes: StatusArray) -> tuple[Status, ...]:
        """Those with these codes (B,)."""
        return tuple(map(_MEMBERS.__getitem__, codes.tolist()))


_MEMBERS = tuple(Status)
_CODES = {status: code for code, status in enumerate(_MEMBERS)}
#: The code of a position that was found.
CONVERGED = Status.CONVERGED.code
