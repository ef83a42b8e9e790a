"""Build the data of a page that shows one pose, such as a draft that is not a mechanism yet."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.app.pages.packing import still_shape, unpressed
from linkwork.app.pages.page_building import FORMAT, MARGIN, themes
from linkwork.app.pages.page_data import MotionData, PackedColumn, PageData, PointData, RowEvidence
from linkwork.core.drawing.labels import Kept
from linkwork.core.drawing.mechanism_scene import scene_of_pose
from linkwork.core.drawing.pose import Pose, printed_name
from linkwork.core.drawing.scene import Scene
from linkwork.core.foundation.arrays import BoolArray
from linkwork.core.mechanism.skeleton import Skeleton
from linkwork.core.results.quantity import Units

_ROW: BoolArray = np.ones(1, dtype=bool)


def still_page(
    skeleton: Skeleton,
    points: Mapping[str, tuple[float, float]],
    *,
    units: Units,
    title: str = "",
    size: float = 0.0,
    kept: Kept | None = None,
) -> PageData:
    """The data of a page with one row and no columns.

    Parameters
    ----------
    skeleton : Skeleton
        Links, joints and other parts between the points.
    points : Mapping[str, (x, y)]
        The coordinates of all points [length].
    units : Units
        The units of lengths and angles.
    title : str
        The title of the page.
    size : float
        The least length by which symbols are sized [length].
    kept : dict, optional
        Places of names and arrows, see
        :func:`~linkwork.core.drawing.mechanism_scene.scene_of_pose`.
    """
    pose = Pose.still(skeleton, {name: complex(*place) for name, place in points.items()})
    scene = scene_of_pose(pose, size=size or 1.0, unit=units.length, title=title, kept=kept)
    view = scene.box.grown(MARGIN * scene.measures.size)
    light, dark = themes()
    return PageData(
        format=FORMAT,
        title=title,
        length_unit=units.length,
        derivative_unit="",
        input_unit="",
        view=view.edges,
        stroke=scene.measures.stroke,
        pin=scene.measures.pin,
        text=scene.measures.text,
        motions=(_still_motion(title, pose, scene),),
        light=light,
        dark=dark,
        forces=(),
        force_unit="",
        equations=(),
    )


def _still_motion(title: str, pose: Pose, scene: Scene) -> MotionData:
    fixed, none = set(pose.skeleton.fixed), _number(np.nan)
    return MotionData(
        name=title,
        summary="",
        rows=1,
        order=_number(0.0),
        closed=False,
        speed=0.0,
        backwards=False,
        columns=(),
        points=tuple(
            PointData(
                name=name,
                shown=printed_name(name),
                drawn=name not in fixed,
                x=_number(place.real),
                y=_number(place.imag),
                dx=none,
                dy=none,
                ddx=none,
                ddy=none,
            )
            for name, place in pose.points.items()
        ),
        turns=(),
        frames=(),
        parts=tuple(still_shape(shape, scene.measures.size) for shape in scene.primitives),
        vectors=(),
        driven=tuple(part.name for part in pose.skeleton.driven),
        evidence=_no_evidence(),
        limits=(),
    )


def _no_evidence() -> RowEvidence:
    zero, one, none = _number(0.0), _number(1.0), _number(np.nan)
    return RowEvidence(
        found=one,
        status=zero,
        status_texts=("",),
        certification=zero,
        certification_texts=("",),
        certified=zero,
        residual_log10=none,
        radius_log10=none,
        iterations=zero,
        branch=zero,
        branch_names=("",),
    )


def _number(value: float) -> PackedColumn:
    return unpressed(np.array([value]), _ROW)
