"""Dimensions that do a task best: least squares from many starts."""
