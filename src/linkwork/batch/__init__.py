"""Many designs of one mechanism at once: what varies, and the coefficients of their equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.batch.designs import Designs, designs_of
    from linkwork.batch.family import Family, family_of
    from linkwork.batch.family_motion import FamilyMotion
    from linkwork.batch.limits import FamilyLimits
    from linkwork.batch.sampling import Plan, from_table, grid, latin_hypercube, random
    from linkwork.batch.study import Study, Summary, read_plan, run_study, summary_of
else:
    __getattr__ = loader(
        __name__,
        {
            "designs": ("Designs", "designs_of"),
            "family": ("Family", "family_of"),
            "family_motion": ("FamilyMotion",),
            "limits": ("FamilyLimits",),
            "sampling": ("Plan", "from_table", "grid", "latin_hypercube", "random"),
            "study": ("Study", "Summary", "read_plan", "run_study", "summary_of"),
        },
    )

__all__ = [
    "Designs",
    "Family",
    "FamilyLimits",
    "FamilyMotion",
    "Plan",
    "Study",
    "Summary",
    "designs_of",
    "family_of",
    "from_table",
    "grid",
    "latin_hypercube",
    "random",
    "read_plan",
    "run_study",
    "summary_of",
]
