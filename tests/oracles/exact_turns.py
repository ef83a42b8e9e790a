"""A full turn to sixty digits."""

from __future__ import annotations

from decimal import Decimal

__all__ = ["TURN"]

TURN = Decimal("6.28318530717958647692528676655900576839433879875021164194988918")
