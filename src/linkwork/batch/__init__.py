"""Families: many designs of one mechanism at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.batch.compiling_ahead import compile_kernels as compile_kernels
    from linkwork.batch.designs import (
        Designs as Designs,
        designs_of as designs_of,
    )
    from linkwork.batch.family import (
        Family as Family,
        family_of as family_of,
    )
    from linkwork.batch.family_motion import FamilyMotion as FamilyMotion
    from linkwork.batch.limits import FamilyLimits as FamilyLimits
    from linkwork.batch.recorded_design import (
        RecordedDesign as RecordedDesign,
        record_design as record_design,
    )
    from linkwork.batch.sampling import (
        Plan as Plan,
        from_table as from_table,
        grid as grid,
        latin_hypercube as latin_hypercube,
        random as random,
    )
    from linkwork.batch.study import (
        Study as Study,
        Summary as Summary,
        Verification as Verification,
        read_plan as read_plan,
        run_study as run_study,
        summary_of as summary_of,
        verify_store as verify_store,
    )
else:
    __getattr__ = loader(__name__)
