"""Linkwork: planar mechanisms solved from their loop-closure equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader
from linkwork.foundation.showing import shown_by

shown_by("Motion.plot", "linkwork.drawing.charts.matplotlib_plot", "plot_motion")
shown_by("Motion.animate", "linkwork.viewer.animation", "animate_motion")
shown_by("Motion.widget", "linkwork.viewer.widget", "motion_widget")
shown_by("Position.html", "linkwork.viewer.notebook_html", "position_html")
shown_by("Motion.html", "linkwork.viewer.notebook_html", "motion_html")
shown_by("Configurations.html", "linkwork.viewer.notebook_html", "configurations_html")
shown_by("Circuits.html", "linkwork.viewer.notebook_html", "circuits_html")
shown_by("Circuits.plot", "linkwork.drawing.charts.matplotlib_plot", "plot_circuits")

if TYPE_CHECKING:
    from linkwork.api import (
        Mechanism,
        example,
        example_text,
        examples,
        linkage,
        load,
        loads,
        loops,
        plain_equations,
    )
    from linkwork.foundation.angles import AngleUnit
    from linkwork.foundation.certification import Certification
    from linkwork.foundation.circuit_end import CircuitEnd
    from linkwork.foundation.completeness import Completeness
    from linkwork.foundation.errors import (
        ExpressionError,
        InputError,
        LinkworkError,
        MechanismError,
        MechanismFileError,
        MissingPackageError,
        NotConvergedError,
        Problem,
        UnknownNameError,
    )
    from linkwork.foundation.newton_trouble import NewtonTrouble
    from linkwork.foundation.status import Status
    from linkwork.mechanism.driven_input import Input
    from linkwork.mechanism.part.belt import Belt
    from linkwork.mechanism.part.cam import Cam, Segment
    from linkwork.mechanism.part.curve import Curve
    from linkwork.mechanism.part.cylinder import Cylinder
    from linkwork.mechanism.part.gear import Gear
    from linkwork.mechanism.part.rack import Rack
    from linkwork.mechanism.part.rolling import Rolling
    from linkwork.mechanism.part.slider import Slider
    from linkwork.mechanism.part.slot import Slot
    from linkwork.mechanism.part.spring import Spring
    from linkwork.mechanism.part.weld import Weld
    from linkwork.numerics.newton import NewtonOptions
    from linkwork.results.check import CheckReport
    from linkwork.results.circuits import Branch, Circuit, Circuits
    from linkwork.results.classification import AssurGroup, Classification, Inversion, LoopType
    from linkwork.results.configurations import Configurations, PathCount
    from linkwork.results.failure import Failure, Remedy
    from linkwork.results.force import Force
    from linkwork.results.motion import Limit, LimitKind, Motion, OutputLimit, Series
    from linkwork.results.position import Certificate, Position
    from linkwork.results.table import Table
else:
    __getattr__ = loader(
        __name__,
        {
            "api": (
                "Mechanism",
                "example",
                "example_text",
                "examples",
                "linkage",
                "load",
                "loads",
                "loops",
                "plain_equations",
            ),
            "foundation.angles": ("AngleUnit",),
            "foundation.certification": ("Certification",),
            "foundation.circuit_end": ("CircuitEnd",),
            "foundation.completeness": ("Completeness",),
            "foundation.errors": (
                "ExpressionError",
                "InputError",
                "LinkworkError",
                "MechanismError",
                "MechanismFileError",
                "MissingPackageError",
                "NotConvergedError",
                "Problem",
                "UnknownNameError",
            ),
            "foundation.newton_trouble": ("NewtonTrouble",),
            "foundation.status": ("Status",),
            "mechanism.driven_input": ("Input",),
            "mechanism.part.belt": ("Belt",),
            "mechanism.part.cam": ("Cam", "Segment"),
            "mechanism.part.curve": ("Curve",),
            "mechanism.part.cylinder": ("Cylinder",),
            "mechanism.part.gear": ("Gear",),
            "mechanism.part.rack": ("Rack",),
            "mechanism.part.rolling": ("Rolling",),
            "mechanism.part.slider": ("Slider",),
            "mechanism.part.slot": ("Slot",),
            "mechanism.part.spring": ("Spring",),
            "mechanism.part.weld": ("Weld",),
            "numerics.newton": ("NewtonOptions",),
            "results.check": ("CheckReport",),
            "results.circuits": ("Branch", "Circuit", "Circuits"),
            "results.classification": (
                "AssurGroup",
                "Classification",
                "Inversion",
                "LoopType",
            ),
            "results.configurations": ("Configurations", "PathCount"),
            "results.failure": ("Failure", "Remedy"),
            "results.force": ("Force",),
            "results.motion": ("Limit", "LimitKind", "Motion", "OutputLimit", "Series"),
            "results.position": ("Certificate", "Position"),
            "results.table": ("Table",),
        },
    )

__all__ = [
    "AngleUnit",
    "AssurGroup",
    "Belt",
    "Branch",
    "Cam",
    "Certificate",
    "Certification",
    "CheckReport",
    "Circuit",
    "CircuitEnd",
    "Circuits",
    "Classification",
    "Completeness",
    "Configurations",
    "Curve",
    "Cylinder",
    "ExpressionError",
    "Failure",
    "Force",
    "Gear",
    "Input",
    "InputError",
    "Inversion",
    "Limit",
    "LimitKind",
    "LinkworkError",
    "LoopType",
    "Mechanism",
    "MechanismError",
    "MechanismFileError",
    "MissingPackageError",
    "Motion",
    "NewtonOptions",
    "NewtonTrouble",
    "NotConvergedError",
    "OutputLimit",
    "PathCount",
    "Position",
    "Problem",
    "Rack",
    "Remedy",
    "Rolling",
    "Segment",
    "Series",
    "Slider",
    "Slot",
    "Spring",
    "Status",
    "Table",
    "UnknownNameError",
    "Weld",
    "example",
    "example_text",
    "examples",
    "linkage",
    "load",
    "loads",
    "loops",
    "plain_equations",
]
