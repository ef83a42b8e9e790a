"""Pictures of positions: a pose becomes a scene of primitives, which writers translate to files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.drawing.charts.chart import Chart as Chart
    from linkwork.drawing.charts.circuit_chart import circuit_chart as circuit_chart
    from linkwork.drawing.charts.matplotlib_plot import (
        plot_circuits as plot_circuits,
        plot_motion as plot_motion,
    )
    from linkwork.drawing.drawn_box import reach_of as reach_of
    from linkwork.drawing.matplotlib_writer import (
        figure as figure,
    )
    from linkwork.drawing.mechanism_scene import (
        SceneOptions as SceneOptions,
        scene_of as scene_of,
    )
    from linkwork.drawing.picture_file import (
        render as render,
        write as write,
    )
    from linkwork.drawing.scene import (
        Arc as Arc,
        Box as Box,
        Disc as Disc,
        Hatch as Hatch,
        Polygon as Polygon,
        Polyline as Polyline,
        Role as Role,
        Scene as Scene,
        Text as Text,
    )
    from linkwork.drawing.sheet import (
        Sheet as Sheet,
        configuration_sheet as configuration_sheet,
    )
    from linkwork.drawing.theme import (
        DARK as DARK,
        LIGHT as LIGHT,
        THEMES as THEMES,
        Style as Style,
        Theme as Theme,
        theme_named as theme_named,
    )
else:
    __getattr__ = loader(__name__)
