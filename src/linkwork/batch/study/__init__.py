"""Studies: many designs of a mechanism from a plan, in a store that can be resumed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.batch.study.chunk_manifest import chunks_with_entry as chunks_with_entry
    from linkwork.batch.study.plan_file import (
        read_plan as read_plan,
        read_plan_bytes as read_plan_bytes,
        read_plan_text as read_plan_text,
    )
    from linkwork.batch.study.running import (
        Progress as Progress,
        run_study as run_study,
    )
    from linkwork.batch.study.study import Study as Study
    from linkwork.batch.study.summary import (
        OutputSummary as OutputSummary,
        Summary as Summary,
        summary_of as summary_of,
    )
    from linkwork.batch.study.verifying import (
        Verification as Verification,
        verify_store as verify_store,
    )
else:
    __getattr__ = loader(__name__)
