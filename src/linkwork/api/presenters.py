"""Connects display methods of results to the functions that implement them."""

from __future__ import annotations

from linkwork import app as viewer
from linkwork.circuits.results import Circuits, Configurations
from linkwork.core import drawing, motion
from linkwork.core.foundation.containers import register_presenter
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.core.results.motion_table import motion_text, table_of
from linkwork.core.results.position import Position
from linkwork.design.tolerance_results import Sensitivity, Tolerance
from linkwork.forces import reactions as forces

__all__ = ["register_presenters"]


def register_presenters() -> None:
    """Register the function behind every display method; it is loaded at its first call."""
    register_presenter(Model.force_quantities, lambda: forces.force_quantities)
    register_presenter(Model.beside_switches, lambda: forces.beside_switches)
    register_presenter(Model.derivatives, lambda: motion.derivatives_of)
    register_presenter(Motion.__repr__, lambda: motion_text)
    register_presenter(Motion.table, lambda: table_of)
    register_presenter(Motion.plot, lambda: drawing.plot_motion)
    register_presenter(Circuits.plot, lambda: drawing.plot_circuits)
    register_presenter(Motion.animate, lambda: viewer.animate_motion)
    register_presenter(Motion.widget, lambda: viewer.motion_widget)
    register_presenter(Position._repr_html_, lambda: viewer.position_html)
    register_presenter(Motion._repr_html_, lambda: viewer.motion_html)
    register_presenter(Configurations._repr_html_, lambda: viewer.configurations_html)
    register_presenter(Sensitivity._repr_html_, lambda: viewer.sensitivity_html)
    register_presenter(Tolerance._repr_html_, lambda: viewer.tolerance_html)
    register_presenter(Circuits._repr_html_, lambda: viewer.circuits_html)
