"""Homotopies: all isolated solutions of polynomial systems, and how many there can be."""
