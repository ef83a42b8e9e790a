"""Loads are forces of the sheet Forces: they have no reactions of their own."""
