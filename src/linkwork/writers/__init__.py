"""Export of results to file formats of other programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.writers.code.programs import write_program as write_program
    from linkwork.writers.plates.files import write_plates as write_plates
    from linkwork.writers.plates.plate import PlateOptions as PlateOptions, PlateStack as PlateStack
    from linkwork.writers.report.report import write_report as write_report
    from linkwork.writers.report.sections import Template as Template
    from linkwork.writers.robot.files import write_robot as write_robot
    from linkwork.writers.workbook.workbook import write_workbook as write_workbook
    from linkwork.writers.writing import write as write
else:
    __getattr__ = loader(__name__)
