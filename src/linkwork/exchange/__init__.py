"""Mechanism files of other programs: read as linkages, with a list of what was left out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.exchange.formats import (
        FORMATS as FORMATS,
        WRITERS as WRITERS,
        read_foreign as read_foreign,
        write_foreign as write_foreign,
    )
    from linkwork.exchange.source import LeftOut as LeftOut
else:
    __getattr__ = loader(__name__)
