"""Linkwork: planar mechanisms solved from their loop-closure equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork import api
from linkwork.core.foundation.containers import register_when_needed
from linkwork.core.foundation.loading import loader

register_when_needed(lambda: api.register_presenters())

if TYPE_CHECKING:
    from linkwork.api.foreign import Imported as Imported, imported as imported
    from linkwork.api.making import (
        example as example,
        linkage as linkage,
        load as load,
        loads as loads,
        loops as loops,
        plain_equations as plain_equations,
    )
    from linkwork.api.mechanism import Mechanism as Mechanism
    from linkwork.api.path_atlas import NearPath as NearPath, PathAtlas as PathAtlas
    from linkwork.api.synthesis import Synthesis as Synthesis, Task as Task
    from linkwork.app.pages.animation import FilmOptions as FilmOptions
    from linkwork.circuits.results import (
        Branch as Branch,
        Circuit as Circuit,
        Circuits as Circuits,
        Configurations as Configurations,
        PathCount as PathCount,
    )
    from linkwork.contacts.cams import Cam as Cam, Segment as Segment
    from linkwork.contacts.curves import Curve as Curve, NoncircularGear as NoncircularGear
    from linkwork.core.drawing.annotations import SceneOptions as SceneOptions
    from linkwork.core.drawing.scene import Scene as Scene
    from linkwork.core.equations.writing import EquationSheet as EquationSheet
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
    from linkwork.core.mechanism.part.springs import Load as Load, Spring as Spring
    from linkwork.core.mechanism.part.weld import Weld as Weld
    from linkwork.core.numerics.newton import NewtonOptions as NewtonOptions
    from linkwork.core.results.check import (
        AssurGroup as AssurGroup,
        BlockSummary as BlockSummary,
        CheckReport as CheckReport,
        Classification as Classification,
        Inversion as Inversion,
        LoopType as LoopType,
    )
    from linkwork.core.results.failure import Failure as Failure, Remedy as Remedy
    from linkwork.core.results.limit import (
        Limit as Limit,
        LimitKind as LimitKind,
        OutputLimit as OutputLimit,
    )
    from linkwork.core.results.motion import Motion as Motion
    from linkwork.core.results.nearest_assembly import NearestAssembly as NearestAssembly
    from linkwork.core.results.position import (
        Certificate as Certificate,
        Iterate as Iterate,
        Iterates as Iterates,
        NewtonStep as NewtonStep,
        NewtonTrail as NewtonTrail,
        Position as Position,
    )
    from linkwork.core.results.series import Series as Series
    from linkwork.core.results.tables import Table as Table
    from linkwork.core.textfile.reader import example_text as example_text, examples as examples
    from linkwork.design.results import (
        Counterweight as Counterweight,
        Counterweights as Counterweights,
        Flywheel as Flywheel,
        Harmonics as Harmonics,
        InflectionCircle as InflectionCircle,
        MotorCheck as MotorCheck,
    )
    from linkwork.design.tolerance_results import (
        Contribution as Contribution,
        Sampled as Sampled,
        Sensitivity as Sensitivity,
        SensitivityStatus as SensitivityStatus,
        Tolerance as Tolerance,
    )
    from linkwork.families.design_sweep import FamilyLimits as FamilyLimits
    from linkwork.families.family import Family as Family
    from linkwork.families.family_motion import FamilyMotion as FamilyMotion
    from linkwork.forces.results import (
        Equilibrium as Equilibrium,
        Force as Force,
        ForceStatus as ForceStatus,
        Reactions as Reactions,
    )
    from linkwork.forces.stall import Stall as Stall
    from linkwork.readers.assembly import Exported as Exported, LeftOut as LeftOut
    from linkwork.synthesis.defects.verdicts import (
        Defect as Defect,
        DefectKind as DefectKind,
        JudgedDesign as JudgedDesign,
    )
    from linkwork.synthesis.improvement.proved_design import ImprovedDesign as ImprovedDesign
    from linkwork.synthesis.solvers.result import (
        Dyad as Dyad,
        SynthesizedDesign as SynthesizedDesign,
    )
    from linkwork.writers.plates.plate import PlateOptions as PlateOptions, PlateStack as PlateStack
else:
    __getattr__ = loader(__name__)
