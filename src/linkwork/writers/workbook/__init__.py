"""A motion as an Excel workbook whose formulas solve the cycle."""
