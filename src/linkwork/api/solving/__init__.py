"""The solver in a page of a mechanism."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.api.solving.solver_page import solving_page as solving_page
else:  # kernels are loaded when a page with sliders is written
    __getattr__ = loader(__name__)
