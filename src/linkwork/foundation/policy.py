"""The policy at a change point, where two branches cross."""

from __future__ import annotations

from enum import Enum

from linkwork.foundation.errors import InputError, choices
from linkwork.foundation.plain_numbers import as_told

__all__ = ["ChangePointPolicy"]


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
