"""Classify a mechanism: chain, type, Assur groups."""
