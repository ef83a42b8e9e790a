"""Pictures of positions: a pose becomes a scene of primitives, writers only translate it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.drawing.charts.chart import Chart
    from linkwork.drawing.charts.circuit_chart import circuit_chart
    from linkwork.drawing.drawn_box import reach_of
    from linkwork.drawing.matplotlib_writer import figure, render, write
    from linkwork.drawing.mechanism_scene import SceneOptions, scene_of
    from linkwork.drawing.scene import Arc, Box, Disc, Hatch, Polygon, Polyline, Role, Scene, Text
    from linkwork.drawing.sheet import Sheet, configuration_sheet
    from linkwork.drawing.theme import DARK, LIGHT, THEMES, Style, Theme, theme_named
else:
    __getattr__ = loader(
        __name__,
        {
            "charts.chart": ("Chart",),
            "charts.circuit_chart": ("circuit_chart",),
            "drawn_box": ("reach_of",),
            "matplotlib_writer": ("figure", "render", "write"),
            "mechanism_scene": ("SceneOptions", "scene_of"),
            "scene": (
                "Arc",
                "Box",
                "Disc",
                "Hatch",
                "Polygon",
                "Polyline",
                "Role",
                "Scene",
                "Text",
            ),
            "sheet": ("Sheet", "configuration_sheet"),
            "theme": ("DARK", "LIGHT", "THEMES", "Style", "Theme", "theme_named"),
        },
    )

__all__ = [
    "DARK",
    "LIGHT",
    "THEMES",
    "Arc",
    "Box",
    "Chart",
    "Disc",
    "Hatch",
    "Polygon",
    "Polyline",
    "Role",
    "Scene",
    "SceneOptions",
    "Sheet",
    "Style",
    "Text",
    "Theme",
    "circuit_chart",
    "configuration_sheet",
    "figure",
    "reach_of",
    "render",
    "scene_of",
    "theme_named",
    "write",
]
