"""Mechanisms in a browser: offline pages and films, the data of the front end, the live page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.viewer.animation import (
        ANIMATION_FORMATS,
        FilmOptions,
        animation,
        check_animation,
    )
    from linkwork.viewer.offline_page import offline_page
    from linkwork.viewer.page_building import drawn_page, motion_page
    from linkwork.viewer.page_data import PageData
else:
    __getattr__ = loader(
        __name__,
        {
            "animation": (
                "ANIMATION_FORMATS",
                "FilmOptions",
                "animation",
                "check_animation",
            ),
            "offline_page": ("offline_page",),
            "page_building": ("drawn_page", "motion_page"),
            "page_data": ("PageData",),
        },
    )

__all__ = [
    "ANIMATION_FORMATS",
    "FilmOptions",
    "PageData",
    "animation",
    "check_animation",
    "drawn_page",
    "motion_page",
    "offline_page",
]
