"""Studies: many designs of a mechanism from a plan, in a store that can be resumed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.families.study.plan import (
        read_plan as read_plan,
        read_plan_bytes as read_plan_bytes,
        read_plan_text as read_plan_text,
    )
    from linkwork.families.study.running import Progress as Progress, run_study as run_study
    from linkwork.families.study.store import (
        OutputSummary as OutputSummary,
        Summary as Summary,
        Verification as Verification,
        chunks_with_record as chunks_with_record,
        summary_of as summary_of,
        verify_store as verify_store,
    )
    from linkwork.families.study.study import Study as Study
else:
    __getattr__ = loader(__name__)
