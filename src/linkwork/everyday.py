"""The former name of :mod:`linkwork.api`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork import api
from linkwork.foundation.deprecation import former_module

if TYPE_CHECKING:
    from linkwork.api import *  # noqa: F403  (whatever is public there)
else:
    __getattr__ = former_module(__name__, api, removed_in="0.4")
