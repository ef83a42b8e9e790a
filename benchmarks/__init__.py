"""Measurements: time as ratios in one run, with success and accuracy beside it."""
