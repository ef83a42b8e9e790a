"""Export of results to file formats of other programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.writers.plates.plate import PlateOptions as PlateOptions, PlateStack as PlateStack
    from linkwork.writers.report.findings import Template as Template
    from linkwork.writers.report.gathering import report as report
    from linkwork.writers.writing import (
        Writer as Writer,
        plates as plates,
        program as program,
        robot as robot,
        workbook as workbook,
        write as write,
    )
else:
    __getattr__ = loader(__name__)
