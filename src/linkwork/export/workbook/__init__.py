"""A motion as an Excel workbook whose cells solve it again."""
