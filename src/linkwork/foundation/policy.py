"""The policy at a change point, where two branches cross."""

from __future__ import annotations

from enum import Enum

from linkwork.foundation.errors import InputError, choices

__all__ = ["ChangePointPolicy"]


class ChangePointPolicy(Enum):
    """The branch on which a motion continues at a change point; only this choice decides it."""

    STOP = "stop"
    STRAIGHT = "straight"
    TURN = "turn"

    @classmethod
    def of(cls, name: str | ChangePointPolicy) -> ChangePointPolicy:
        """The policy of a name: ``stop``, ``straight`` (keep the tangent) or ``turn``.

        Raises
        ------
        InputError
            For any other name.
        """
        if isinstance(name, ChangePointPolicy):
            return name
        names = [policy.value for policy in cls]
        if name not in names:
            raise InputError(
                f'"{name}" is not a policy at a change point {choices("policies", names, name)}'
            )
        return cls(name)
