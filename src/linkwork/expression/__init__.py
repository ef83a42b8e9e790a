"""Formulas as people type them: grammar, values, derivatives, LaTeX. Never ``eval``."""
