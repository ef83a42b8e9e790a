"""Families: many designs of one mechanism at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.families.building import Designs as Designs, designs_of as designs_of
    from linkwork.families.design_sweep import FamilyLimits as FamilyLimits
    from linkwork.families.family import Family as Family, compile_kernels as compile_kernels
    from linkwork.families.family_motion import FamilyMotion as FamilyMotion
    from linkwork.families.sampling import (
        Plan as Plan,
        from_table as from_table,
        grid as grid,
        latin_hypercube as latin_hypercube,
        random as random,
    )
    from linkwork.families.study.plan import read_plan as read_plan
    from linkwork.families.study.running import run_study as run_study
    from linkwork.families.study.store import (
        Summary as Summary,
        Verification as Verification,
        summary_of as summary_of,
        verify_store as verify_store,
    )
    from linkwork.families.study.study import Study as Study
else:
    __getattr__ = loader(__name__)
