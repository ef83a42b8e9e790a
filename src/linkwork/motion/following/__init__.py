"""A position at another input value than the guess's: loaded only when one is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.motion.following.to_value import OutOfReach, follow_to_value
else:
    __getattr__ = loader(__name__, {"to_value": ("OutOfReach", "follow_to_value")})

__all__ = ["OutOfReach", "follow_to_value"]
