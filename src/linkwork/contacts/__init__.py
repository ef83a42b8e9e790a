"""Parts with laws: cams, curves, non-circular gears."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.contacts.cams import Cam as Cam, Segment as Segment
    from linkwork.contacts.curves import Curve as Curve, NoncircularGear as NoncircularGear
else:
    __getattr__ = loader(__name__)
