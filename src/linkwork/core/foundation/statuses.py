"""The statuses of positions, circuits and proofs."""

from __future__ import annotations

from enum import Enum
from typing import Self

import numpy as np

from linkwork.core.foundation.arrays import BoolArray, StatusArray
from linkwork.core.foundation.errors import InputError, choices
from linkwork.core.foundation.values import as_told

# ----------------------------------------------------------------------
# Enumerations whose members are stored in arrays by a small whole number.


class CodedEnum(Enum):
    """Members are sentences; codes number them in the order of the class."""

    code: int

    def __init__(self, sentence: str) -> None:
        self.code = len(type(self).__members__)

    @property
    def label(self) -> str:
        """The name as words, as in ``out of reach``."""
        return self.name.lower().replace("_", " ")

    @classmethod
    def of_code(cls, code: int) -> Self:
        """The member with this code."""
        return tuple(cls)[code]

    @classmethod
    def of_codes(cls, codes: StatusArray) -> tuple[Self, ...]:
        """The members with these codes (B,)."""
        members = tuple(cls)
        # most tables have one status
        if len(codes) and (codes == codes[0]).all():
            return (members[codes[0]],) * len(codes)
        return tuple(map(members.__getitem__, codes.tolist()))

    def where(self, members: tuple[Self, ...]) -> BoolArray:
        """Which of some members are this one, (B,)."""
        if members.count(self) == len(members):
            return np.ones(len(members), dtype=bool)
        return np.array([member is self for member in members], dtype=bool)


# ----------------------------------------------------------------------
# The status of a computation: an enumeration whose values are sentences with a next step.


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


# ----------------------------------------------------------------------
# Whether a position is proved, or why not, as sentences.


class Certification(CodedEnum):
    """Whether a position is proved, or why not; the value is a sentence.

    Examples
    --------
    >>> import linkwork as lw
    >>> position = lw.example("four-bar").solve(at=60, certify=False)
    >>> position.certificate.certification.value
    'certificates were switched off'
    """

    CERTIFIED = (
        "proved: a true position lies within the radius, no other near it, "
        "and the motion from the start stays on one branch"
    )
    NOT_ASKED = "certificates were switched off"
    NO_POSITION = "there is no position to certify"
    NO_BOUND = "no bounds of these equations are known, so there is no proof"
    POSITION_NOT_PROVED = (
        "too close to a singular position: rounding errors exceed the margin of the proof"
    )
    MOTION_NOT_PROVED = (
        "the position is proved, but not that the motion from the start stays on one branch"
    )
    BRANCH_CHOSEN = (
        "the position is proved; at a change point before it, the chosen policy decides the branch"
    )
    SUBSET_CERTIFIED = (
        "proved for the mechanism without its redundant links; these fit to rounding, without proof"
    )
    CONFIGURATION_CERTIFIED = "proved: a true position lies within the radius, and no other near it"
    PROOF_TOO_LONG = (
        "the position is proved; the proof that the motion from the start stays on one branch "
        "would take too many steps"
    )

    ENERGY_DRIFTS = (
        "the position is proved, but the energy of the motion has drifted by more than 1e-9 of its "
        "largest kinetic energy"
    )

    @property
    def certified(self) -> bool:
        """Whether everything that belongs to the position is proved."""
        return self in (Certification.CERTIFIED, Certification.CONFIGURATION_CERTIFIED)


# ----------------------------------------------------------------------
# The ways in which the curve of a circuit ends or closes, as sentences.


class CircuitEnd(Enum):
    """How the curve of a circuit ends; the value is a sentence.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.example("four-bar").circuits()[0].end.explanation
    'the motion returns to its start'
    """

    CLOSED = "closed: the motion returns to its start"
    INPUT_CONSTANT = "input at rest: the mechanism moves while its input is constant"
    CHANGE_POINT = "change point: the curve was followed up to change points, where curves cross"
    RUNS_TO_INFINITY = "runs to infinity: a length grows without bound"
    NEVER_CLOSES = "never closes: within the turns followed the motion does not return to its start"
    SINGULAR = "stopped: the curve was followed to a singular position of unknown kind"

    @property
    def explanation(self) -> str:
        """The sentence without the keyword."""
        return self.value.partition(": ")[2]

    @property
    def closed(self) -> bool:
        """Whether the circuit was followed as a whole."""
        return self is CircuitEnd.CLOSED


# ----------------------------------------------------------------------
# Whether a list of configurations is complete, as sentences, strongest first.


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


# ----------------------------------------------------------------------
# The four ways in which Newton-Raphson fails to find a root, as textbooks draw them.


class NewtonTrouble(Enum):
    """The way in which Newton-Raphson missed the intended root; the value is a sentence.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.NewtonTrouble.ANOTHER_ROOT.value.partition(":")[0]
    'the iteration passed the root nearest to the guess and found another root'
    """

    SINGULAR_DERIVATIVE = (
        "the derivative is singular at an iterate, where Newton-Raphson has no next step: "
        "start from a guess near it"
    )
    INFLECTION = (
        "the equations have an inflection near the root, so that every step overshoots further "
        "than the one before: start nearer to the root"
    )
    ANOTHER_ROOT = (
        "the iteration passed the root nearest to the guess and found another root: "
        "start nearer to the intended root"
    )
    LOCAL_EXTREMUM = (
        "the guess is near a local extremum of the equations, which do not reach zero there: "
        "start from the other side of the extremum"
    )


# ----------------------------------------------------------------------
# The policy at a change point, where two branches cross.


class ChangePointPolicy(Enum):
    """The branch on which a motion continues at a change point; only this choice decides it."""

    STOP = "stop"
    STRAIGHT = "straight"
    TURN = "turn"

    @classmethod
    def of(cls, name: object) -> ChangePointPolicy:
        """The policy of a name: ``stop``, ``straight`` (keep the tangent) or ``turn``.

        Raises
        ------
        InputError
            For any other name.
        """
        if isinstance(name, ChangePointPolicy):
            return name
        names = [policy.value for policy in cls]
        told = name if isinstance(name, str) else as_told(name)
        if told not in names:
            raise InputError(
                f'"{told}" is not a policy at a change point {choices("policies", names, told)}'
            )
        return cls(told)
