"""Studies: very many designs of one mechanism by a plan, into a store that can be gone on with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.batch.study.plan_file import read_plan, read_plan_text
    from linkwork.batch.study.running import Progress, run_study
    from linkwork.batch.study.study import Study
    from linkwork.batch.study.summary import OutputSummary, Summary, summary_of
else:
    __getattr__ = loader(
        __name__,
        {
            "plan_file": ("read_plan", "read_plan_text"),
            "running": ("Progress", "run_study"),
            "study": ("Study",),
            "summary": ("OutputSummary", "Summary", "summary_of"),
        },
    )

__all__ = [
    "OutputSummary",
    "Progress",
    "Study",
    "Summary",
    "read_plan",
    "read_plan_text",
    "run_study",
    "summary_of",
]
