"""Results: positions, motions and lists as immutable data with their evidence."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.results.check import (
        AssurGroup as AssurGroup,
        BlockSummary as BlockSummary,
        CheckReport as CheckReport,
        Classification as Classification,
        Inversion as Inversion,
        LoopType as LoopType,
    )
    from linkwork.core.results.failure import (
        Failure as Failure,
        Limit as Limit,
        LimitKind as LimitKind,
        OutputLimit as OutputLimit,
        Remedy as Remedy,
    )
    from linkwork.core.results.position import (
        Certificate as Certificate,
        Iterate as Iterate,
        Iterates as Iterates,
        NearestAssembly as NearestAssembly,
        NewtonStep as NewtonStep,
        NewtonTrail as NewtonTrail,
    )
    from linkwork.core.results.tables import Series as Series, Table as Table
else:
    __getattr__ = loader(__name__)
