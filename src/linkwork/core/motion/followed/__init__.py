"""Positions at other input values than the guess's; loaded on demand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.motion.followed.to_value import (
        OutOfReach as OutOfReach,
        follow_to_value as follow_to_value,
    )
else:
    __getattr__ = loader(__name__)
