"""Whether a position is proved, or why not: sentences."""

from __future__ import annotations

from linkwork.foundation.coded_enum import CodedEnum

__all__ = ["Certification"]


class Certification(CodedEnum):
    """The certificate of one position in one word, with a sentence."""

    CERTIFIED = (
        "a true position is proved to lie within the radius, no other near it, "
        "and the motion from the start to it stays on one branch"
    )
    NOT_ASKED = "certificates were switched off"
    NO_POSITION = "there is no position to certify"
    NO_BOUND = "plain equations have no known bound of their curvature, so nothing is proved"
    POSITION_NOT_PROVED = (
        "too near to a singular position: rounding is larger than what the proof allows"
    )
    MOTION_NOT_PROVED = (
        "the position is proved, but not that the motion from the start to it stays on one branch"
    )
    BRANCH_CHOSEN = (
        "the position is proved; at a change point before it nothing but the chosen way of going "
        "on decides the branch"
    )
    SUBSET_CERTIFIED = (
        "proved for the mechanism without its redundant links; that these fit holds to rounding, "
        "not proved"
    )
    CONFIGURATION_CERTIFIED = (
        "a true position is proved to lie within the radius, and no other near it"
    )
    PROOF_TOO_LONG = (
        "the position is proved; that the motion from the start to it stays on one branch would "
        "take more steps of proof than are tried"
    )

    @property
    def certified(self) -> bool:
        """Whether everything that belongs to the position is proved."""
        return self in (Certification.CERTIFIED, Certification.CONFIGURATION_CERTIFIED)
