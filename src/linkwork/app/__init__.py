"""Mechanisms in a browser: offline pages, films, widgets and the live page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.app.pages.animation import FilmOptions as FilmOptions
    from linkwork.app.pages.notebook import motions_widget as motions_widget
    from linkwork.app.pages.offline_page import offline_page as offline_page
    from linkwork.app.pages.page_building import motion_page as motion_page
    from linkwork.app.pages.page_data import PageData as PageData
else:
    __getattr__ = loader(__name__)
