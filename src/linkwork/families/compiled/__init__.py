"""Arithmetic for many mechanisms at once: straight-line programs over lanes of numbers."""
