"""Proofs in explicit constants: that a solution exists near a position and is the only one."""
