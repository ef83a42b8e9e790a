"""Formulas in text form: grammar, values, derivatives, LaTeX; without ``eval``."""
