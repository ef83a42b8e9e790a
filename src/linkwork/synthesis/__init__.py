"""Mechanisms for tasks, and better numbers for a mechanism."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.synthesis.atlas import NearPath as NearPath, PathAtlas as PathAtlas
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
    from linkwork.synthesis.task_objects import (
        Synthesis as Synthesis,
        Task as Task,
        improve as improve,
    )
else:
    __getattr__ = loader(__name__)
