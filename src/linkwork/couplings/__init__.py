"""Linear couplings of lengths and angles: master and slave cylinder, rope and drum."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.couplings.coupling import LinearCoupling as LinearCoupling
else:
    __getattr__ = loader(__name__)
