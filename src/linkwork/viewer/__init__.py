"""Mechanisms in a browser: offline pages, films, widgets and the live page."""

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
    from linkwork.viewer.notebook_html import mechanism_html
    from linkwork.viewer.offline_page import offline_page
    from linkwork.viewer.page_building import drawn_page, motion_page
    from linkwork.viewer.page_data import PageData
    from linkwork.viewer.widget import motions_widget
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
            "notebook_html": ("mechanism_html",),
            "offline_page": ("offline_page",),
            "page_building": ("drawn_page", "motion_page"),
            "page_data": ("PageData",),
            "widget": ("motions_widget",),
        },
    )

__all__ = [
    "ANIMATION_FORMATS",
    "FilmOptions",
    "PageData",
    "animation",
    "check_animation",
    "drawn_page",
    "mechanism_html",
    "motion_page",
    "motions_widget",
    "offline_page",
]
