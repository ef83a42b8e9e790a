"""Sections about forces and tolerances."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.drawing.charts.plotting import motion_plot
from linkwork.export.report.document import Block, Facts, Note, Paragraph
from linkwork.export.report.findings import Findings
from linkwork.export.report.mechanism_sections import tables
from linkwork.export.report.motion_sections import figures_of, ranges_of
from linkwork.export.report.template import Template
from linkwork.foundation.names import pretty
from linkwork.results.listing.force_listing import (
    finite_forces,
    force_fields,
    force_status_fields,
)
from linkwork.results.listing.tolerance_listing import (
    contribution_columns,
    tolerance_fields,
)
from linkwork.results.sensitivity import SensitivityStatus

__all__ = ["forces", "tolerances"]


def forces(found: Findings, template: Template) -> Iterator[Block]:
    """Efforts of the inputs and reactions of the joints."""
    acting = found.forces
    assert acting is not None
    assert found.motion is not None
    rest = "at rest" if found.motion.speed is None else "with the inertia of its masses"
    yield Paragraph(text=f"Forces of the mechanism {rest}, over the rows of its motion.")
    yield Facts(pairs=tuple(force_status_fields(acting)))
    listed = finite_forces(acting)
    if listed:
        yield from tables("Smallest and largest forces", ranges_of(found.motion, listed))
    yield Facts(pairs=tuple(force_fields(acting, found.stalls)))
    efforts = [name for name in acting.efforts if name in listed]
    if efforts:
        chart = motion_plot(found.motion, efforts)
        over = pretty(next(iter(found.motion.inputs)))
        what = "Effort" if len(efforts) == 1 else "Efforts"
        yield from figures_of(chart, f"{what} of the input over {over}.")


def tolerances(found: Findings, template: Template) -> Iterator[Block]:
    """What deviations and clearances do to every quantity asked for."""
    yield Paragraph(
        text="Worst case, root sum square and shares are of first order in the deviations and "
        "clearances of the file."
    )
    for each in found.tolerances:
        where = f" at {each.where}" if each.where else ""
        if each.status is not SensitivityStatus.FOUND:
            yield Facts(pairs=((each.of, each.status.value),))
            continue
        yield Note(text=f"{pretty(each.of)}{where}")
        yield Facts(pairs=tuple(tolerance_fields(each)))
        yield from tables(f"Contributions to {pretty(each.of)}{where}", contribution_columns(each))
