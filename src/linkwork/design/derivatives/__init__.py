"""Solved rows, forces and dead points as functions of a mechanism's numbers, and derivatives."""
