"""The drawn line of a contour, and the spoke that shows the angle of its link."""

from __future__ import annotations

import numpy as np

from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Polyline, Role, xy
from linkwork.foundation.arrays import ComplexArray
from linkwork.mechanism.figures import Contour

__all__ = ["contour_line", "contour_mark"]

_MOST = 400  # approximate number of drawn points: about a hundredth of the size apart


def contour_line(pose: Pose, contour: Contour) -> ComplexArray:
    """The drawn points of an outline or curve at the current position."""
    points = pose.placed(contour)
    last = len(points) - 1
    shown = np.unique([*range(0, last, max(1, round(last / _MOST))), last])
    # A closed outline may repeat its first point at the end.
    again = contour.closed and abs(points[last] - points[0]) <= 1e-9 * float(np.ptp(points.real))
    found: ComplexArray = points[shown[:-1] if again else shown]
    return found


def contour_mark(pose: Pose, contour: Contour, tone: int, measures: Measures) -> Polyline:
    """A spoke that shows the rotation of a body with a round outline."""
    way = np.exp(1j * pose.angle(contour.link))
    centre = pose.points[contour.center]
    reach = 0.7 * float(np.abs(np.array(contour.points)).min())
    ends = (xy(centre + min(measures.pin, 0.5 * reach) * way), xy(centre + reach * way))
    return Polyline(role=Role.MARK, of=contour.link, tone=tone, points=ends)
