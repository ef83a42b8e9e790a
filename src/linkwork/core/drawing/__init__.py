"""Pictures of positions: a pose becomes a scene of primitives, which writers translate to files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.drawing.annotations import (
        Force as Force,
        SceneOptions as SceneOptions,
        check_forces as check_forces,
    )
    from linkwork.core.drawing.matplotlib_writer import (
        check_picture as check_picture,
        figure as figure,
        render as render,
        write as write,
    )
    from linkwork.core.drawing.mechanism_scene import (
        Sheet as Sheet,
        configuration_sheet as configuration_sheet,
        reach_of as reach_of,
        scene_of as scene_of,
    )
    from linkwork.core.drawing.pose import no_points as no_points
    from linkwork.core.drawing.scene import (
        DARK as DARK,
        LIGHT as LIGHT,
        THEMES as THEMES,
        Arc as Arc,
        Box as Box,
        Disc as Disc,
        Hatch as Hatch,
        Polygon as Polygon,
        Polyline as Polyline,
        Role as Role,
        Scene as Scene,
        Style as Style,
        Text as Text,
        Theme as Theme,
        theme_named as theme_named,
    )
else:
    __getattr__ = loader(__name__)
