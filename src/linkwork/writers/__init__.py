"""Export of results to file formats of other programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.results.tables import csv_lines as csv_lines, csv_text as csv_text
    from linkwork.writers.charts.matplotlib_plot import (
        plot_circuits as plot_circuits,
        plot_motion as plot_motion,
    )
    from linkwork.writers.code.languages import code_of as code_of, language_of as language_of
    from linkwork.writers.plates.files import (
        check_plate_file as check_plate_file,
        plates_of as plates_of,
    )
    from linkwork.writers.plates.plate import PlateOptions as PlateOptions, PlateStack as PlateStack
    from linkwork.writers.plates.stack import stack_of as stack_of
    from linkwork.writers.report.findings import (
        Findings as Findings,
        Template as Template,
        template_of as template_of,
    )
    from linkwork.writers.report.gathering import report as report
    from linkwork.writers.report.motion_sections import (
        check_template as check_template,
        quantities_of as quantities_of,
    )
    from linkwork.writers.report.report import (
        check_report_file as check_report_file,
        report_of as report_of,
    )
    from linkwork.writers.robot.files import (
        check_robot_file as check_robot_file,
        robot_of as robot_of,
    )
    from linkwork.writers.workbook.workbook import (
        WrittenWorkbook as WrittenWorkbook,
        check_xlsxwriter as check_xlsxwriter,
        workbook_of as workbook_of,
    )
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
