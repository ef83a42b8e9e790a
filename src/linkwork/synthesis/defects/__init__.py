"""Verdicts on designs: branch, circuit, order, driven range and requirements of the task."""
