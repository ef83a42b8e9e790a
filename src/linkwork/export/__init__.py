"""Export of results to file formats of other programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.export.code.code import (
        code_of as code_of,
        language_of as language_of,
    )
    from linkwork.export.plates.options import PlateOptions as PlateOptions
    from linkwork.export.plates.plate import PlateStack as PlateStack
    from linkwork.export.plates.plate_file import (
        check_plate_file as check_plate_file,
        plates_of as plates_of,
    )
    from linkwork.export.plates.stack import stack_of as stack_of
    from linkwork.export.report.findings import Findings as Findings
    from linkwork.export.report.motion_sections import (
        check_template as check_template,
        quantities_of as quantities_of,
    )
    from linkwork.export.report.report import (
        check_report_file as check_report_file,
        report_of as report_of,
    )
    from linkwork.export.report.template import (
        Template as Template,
        template_of as template_of,
    )
    from linkwork.export.robot.robot_file import (
        check_robot_file as check_robot_file,
        robot_of as robot_of,
    )
    from linkwork.export.workbook.workbook import (
        WrittenWorkbook as WrittenWorkbook,
        check_xlsxwriter as check_xlsxwriter,
        workbook_of as workbook_of,
    )
    from linkwork.results.csv_text import (
        csv_lines as csv_lines,
        csv_text as csv_text,
    )
else:
    __getattr__ = loader(__name__)
