"""Linkwork: planar mechanisms solved from their loop-closure equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork import api
from linkwork.foundation.lazy import loader
from linkwork.foundation.presenting import register_when_needed

register_when_needed(lambda: api.register_presenters())

if TYPE_CHECKING:
    from linkwork.api import (
        Mechanism as Mechanism,
        example as example,
        example_text as example_text,
        examples as examples,
        linkage as linkage,
        load as load,
        loads as loads,
        loops as loops,
        plain_equations as plain_equations,
    )
    from linkwork.api.foreign import Imported as Imported, imported as imported
    from linkwork.api.path_atlas import NearPath as NearPath, PathAtlas as PathAtlas
    from linkwork.api.synthesis import Synthesis as Synthesis, Task as Task
    from linkwork.batch.family import (
        Family as Family,
    )
    from linkwork.batch.family_motion import (
        FamilyMotion as FamilyMotion,
    )
    from linkwork.batch.limits import (
        FamilyLimits as FamilyLimits,
    )
    from linkwork.design.defects.defect_messages import (
        Defect as Defect,
    )
    from linkwork.design.defects.judged_design import (
        JudgedDesign as JudgedDesign,
    )
    from linkwork.design.defects.verdicts import (
        DefectKind as DefectKind,
    )
    from linkwork.design.improvement.improved_design import (
        ImprovedDesign as ImprovedDesign,
    )
    from linkwork.design.synthesis.result import (
        Dyad as Dyad,
        SynthesizedDesign as SynthesizedDesign,
    )
    from linkwork.drawing.scene import (
        Scene as Scene,
    )
    from linkwork.drawing.scene_options import (
        SceneOptions as SceneOptions,
    )
    from linkwork.equations.writing import (
        EquationSheet as EquationSheet,
    )
    from linkwork.exchange.drawn import Exported as Exported
    from linkwork.exchange.source import LeftOut as LeftOut
    from linkwork.export.plates.options import PlateOptions as PlateOptions
    from linkwork.export.plates.plate import PlateStack as PlateStack
    from linkwork.foundation.angles import AngleUnit as AngleUnit
    from linkwork.foundation.certification import Certification as Certification
    from linkwork.foundation.circuit_end import CircuitEnd as CircuitEnd
    from linkwork.foundation.completeness import Completeness as Completeness
    from linkwork.foundation.errors import (
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
    from linkwork.foundation.newton_trouble import NewtonTrouble as NewtonTrouble
    from linkwork.foundation.status import Status as Status
    from linkwork.mechanism.driven_input import Input as Input
    from linkwork.mechanism.friction import Friction as Friction
    from linkwork.mechanism.input_law import LawSegment as LawSegment
    from linkwork.mechanism.mass import Gravity as Gravity, Mass as Mass
    from linkwork.mechanism.motor import Motor as Motor
    from linkwork.mechanism.part.belt import Belt as Belt
    from linkwork.mechanism.part.cam import Cam as Cam, Segment as Segment
    from linkwork.mechanism.part.curve import Curve as Curve
    from linkwork.mechanism.part.cylinder import Cylinder as Cylinder
    from linkwork.mechanism.part.gear import Gear as Gear
    from linkwork.mechanism.part.load import Load as Load
    from linkwork.mechanism.part.noncircular_gear import NoncircularGear as NoncircularGear
    from linkwork.mechanism.part.rack import Rack as Rack
    from linkwork.mechanism.part.rolling import Rolling as Rolling
    from linkwork.mechanism.part.slider import Slider as Slider
    from linkwork.mechanism.part.slot import Slot as Slot
    from linkwork.mechanism.part.spring import Spring as Spring
    from linkwork.mechanism.part.weld import Weld as Weld
    from linkwork.mechanism.question import Question as Question
    from linkwork.mechanism.stop import Stop as Stop
    from linkwork.numerics.newton import NewtonOptions as NewtonOptions
    from linkwork.results.check import (
        BlockSummary as BlockSummary,
        CheckReport as CheckReport,
    )
    from linkwork.results.circuits import (
        Branch as Branch,
        Circuit as Circuit,
        Circuits as Circuits,
    )
    from linkwork.results.classification import (
        AssurGroup as AssurGroup,
        Classification as Classification,
        Inversion as Inversion,
        LoopType as LoopType,
    )
    from linkwork.results.configurations import (
        Configurations as Configurations,
        PathCount as PathCount,
    )
    from linkwork.results.equilibrium import Equilibrium as Equilibrium
    from linkwork.results.failure import (
        Failure as Failure,
        Remedy as Remedy,
    )
    from linkwork.results.force import Force as Force
    from linkwork.results.iterates import (
        Iterate as Iterate,
        Iterates as Iterates,
    )
    from linkwork.results.machine_design import (
        Counterweight as Counterweight,
        Counterweights as Counterweights,
        Flywheel as Flywheel,
        Harmonics as Harmonics,
        InflectionCircle as InflectionCircle,
        MotorCheck as MotorCheck,
    )
    from linkwork.results.motion import (
        Limit as Limit,
        LimitKind as LimitKind,
        Motion as Motion,
        OutputLimit as OutputLimit,
    )
    from linkwork.results.nearest_assembly import (
        NearestAssembly as NearestAssembly,
    )
    from linkwork.results.position import (
        Certificate as Certificate,
        NewtonStep as NewtonStep,
        NewtonTrail as NewtonTrail,
        Position as Position,
    )
    from linkwork.results.reactions import ForceStatus as ForceStatus, Reactions as Reactions
    from linkwork.results.sensitivity import (
        Sensitivity as Sensitivity,
        SensitivityStatus as SensitivityStatus,
    )
    from linkwork.results.series import Series as Series
    from linkwork.results.stall import Stall as Stall
    from linkwork.results.table import Table as Table
    from linkwork.results.tolerance import (
        Contribution as Contribution,
        Sampled as Sampled,
        Tolerance as Tolerance,
    )
    from linkwork.viewer.animation import (
        FilmOptions as FilmOptions,
    )
else:
    __getattr__ = loader(__name__)
