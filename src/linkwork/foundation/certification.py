"""Whether a position is proved, or why not, as sentences."""

from __future__ import annotations

from linkwork.foundation.coded_enum import CodedEnum

__all__ = ["Certification"]


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
