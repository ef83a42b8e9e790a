"""Linkwork: planar mechanisms solved from their loop-closure equations.

The wings are public packages: ``lw.circuits``, ``lw.forces``, ``lw.families``, ``lw.design``,
``lw.synthesis``, ``lw.writers``, ``lw.readers``, ``lw.app``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork import (
        app as app,
        circuits as circuits,
        contacts as contacts,
        design as design,
        families as families,
        forces as forces,
        readers as readers,
        synthesis as synthesis,
        writers as writers,
    )
    from linkwork.contacts.cams import Cam as Cam, Segment as Segment
    from linkwork.contacts.curves import Curve as Curve, NoncircularGear as NoncircularGear
    from linkwork.core.api.making import (
        example as example,
        linkage as linkage,
        load as load,
        loads as loads,
        loops as loops,
        plain_equations as plain_equations,
    )
    from linkwork.core.api.mechanism import Mechanism as Mechanism
    from linkwork.core.drawing.annotations import SceneOptions as SceneOptions
    from linkwork.core.foundation.errors import (
        ExpressionError as ExpressionError,
        InputError as InputError,
        LinkworkError as LinkworkError,
        MechanismError as MechanismError,
        MechanismFileError as MechanismFileError,
        MissingPackageError as MissingPackageError,
        NotConvergedError as NotConvergedError,
        Problem as Problem,
        UnknownNameError as UnknownNameError,
    )
    from linkwork.core.foundation.statuses import (
        Certification as Certification,
        CircuitEnd as CircuitEnd,
        Completeness as Completeness,
        NewtonTrouble as NewtonTrouble,
        Status as Status,
    )
    from linkwork.core.foundation.units import AngleUnit as AngleUnit
    from linkwork.core.mechanism.description import Question as Question
    from linkwork.core.mechanism.inputs import (
        Input as Input,
        LawSegment as LawSegment,
        Motor as Motor,
    )
    from linkwork.core.mechanism.machine import (
        Friction as Friction,
        Gravity as Gravity,
        Mass as Mass,
        Stop as Stop,
    )
    from linkwork.core.mechanism.part.gears import Belt as Belt, Gear as Gear, Rack as Rack
    from linkwork.core.mechanism.part.guides import (
        Cylinder as Cylinder,
        Slider as Slider,
        Slot as Slot,
    )
    from linkwork.core.mechanism.part.rolling import Rolling as Rolling
    from linkwork.core.mechanism.part.springs import Load as Load, Spring as Spring, Weld as Weld
    from linkwork.core.numerics.newton import NewtonOptions as NewtonOptions
    from linkwork.core.results.motion import Motion as Motion
    from linkwork.core.results.position import Position as Position
    from linkwork.core.textfile.reader import example_text as example_text, examples as examples
    from linkwork.synthesis.task_objects import Task as Task
else:
    __getattr__ = loader(__name__)
