"""The functions that show results as text, tables, pictures and pages, for their methods."""

from __future__ import annotations

from linkwork import drawing, viewer
from linkwork.foundation.presenting import register_presenter
from linkwork.results.circuits import Circuits
from linkwork.results.configurations import Configurations
from linkwork.results.motion import Motion
from linkwork.results.motion_summary import motion_text
from linkwork.results.motion_table import table_of
from linkwork.results.position import Position

__all__ = ["register_presenters"]


def register_presenters() -> None:
    """Register a function for every method of a result that shows it; loaded when it is called."""
    register_presenter(Motion.__repr__, lambda: motion_text)
    register_presenter(Motion.table, lambda: table_of)
    register_presenter(Motion.plot, lambda: drawing.plot_motion)
    register_presenter(Circuits.plot, lambda: drawing.plot_circuits)
    register_presenter(Motion.animate, lambda: viewer.animate_motion)
    register_presenter(Motion.widget, lambda: viewer.motion_widget)
    register_presenter(Position._repr_html_, lambda: viewer.position_html)
    register_presenter(Motion._repr_html_, lambda: viewer.motion_html)
    register_presenter(Configurations._repr_html_, lambda: viewer.configurations_html)
    register_presenter(Circuits._repr_html_, lambda: viewer.circuits_html)
