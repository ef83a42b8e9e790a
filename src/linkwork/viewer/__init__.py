"""Motions as pages that move: one offline HTML file, and the data that its front end reads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.viewer.offline_page import offline_page
    from linkwork.viewer.page_building import page_data
    from linkwork.viewer.page_data import PageData
else:
    __getattr__ = loader(
        __name__,
        {
            "offline_page": ("offline_page",),
            "page_building": ("page_data"),
            "page_data": ("PageData",),
        },
    )

__all__ = ["PageData", "offline_page", "page_data"]
