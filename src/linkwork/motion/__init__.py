"""Positions, whole cycles and rates of a mechanism."""
