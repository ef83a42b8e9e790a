"""Explain failed positions and suggest remedies; loaded after a failure only."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.circuits.failure.failing import (
        another_root as another_root,
        beyond_reach as beyond_reach,
        no_position as no_position,
        root_not_proved as root_not_proved,
        without_circuit as without_circuit,
        without_start as without_start,
    )
else:
    __getattr__ = loader(__name__)
