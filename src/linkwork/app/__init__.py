"""Mechanisms in a browser: offline pages, films, widgets and the live page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.app.pages.animation import (
        ANIMATION_FORMATS as ANIMATION_FORMATS,
        FilmOptions as FilmOptions,
        animate as animate,
        animate_motion as animate_motion,
        animation as animation,
        check_animation as check_animation,
    )
    from linkwork.app.pages.notebook import (
        circuits_html as circuits_html,
        configurations_html as configurations_html,
        mechanism_html as mechanism_html,
        motion_html as motion_html,
        motion_widget as motion_widget,
        motions_widget as motions_widget,
        position_html as position_html,
        sensitivity_html as sensitivity_html,
        tolerance_html as tolerance_html,
        widget as widget,
    )
    from linkwork.app.pages.offline_page import offline_page as offline_page
    from linkwork.app.pages.page_building import (
        drawn_page as drawn_page,
        motion_page as motion_page,
    )
    from linkwork.app.pages.page_data import PageData as PageData
else:
    __getattr__ = loader(__name__)
