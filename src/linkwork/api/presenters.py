"""Connects display methods of results to the functions that implement them."""

from __future__ import annotations

from linkwork import drawing, forces, motion, viewer
from linkwork.foundation.presenting import register_presenter
from linkwork.motion.model import Model
from linkwork.results.circuits import Circuits
from linkwork.results.configurations import Configurations
from linkwork.results.motion import Motion
from linkwork.results.motion_summary import motion_text
from linkwork.results.motion_table import table_of
from linkwork.results.position import Position
from linkwork.results.sensitivity import Sensitivity
from linkwork.results.tolerance import Tolerance

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
