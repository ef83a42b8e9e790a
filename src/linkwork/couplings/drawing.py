"""The symbol of a linear coupling: a dashed line between the parts that it couples."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.core.drawing.pose import Pose
from linkwork.core.drawing.scene import Measures, Polyline, Primitive, Role, xy
from linkwork.core.drawing.wheels import figure_symbols
from linkwork.couplings.coupling import CouplingLine


@figure_symbols.register
def coupling_symbols(line: CouplingLine, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The line between the middles."""
    middles = (xy((pose.points[a] + pose.points[b]) / 2.0) for a, b in line.spans)
    yield Polyline(role=Role.PITCH, of=line.name, points=tuple(middles))
