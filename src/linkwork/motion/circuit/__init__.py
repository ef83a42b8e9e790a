"""Circuits and branches: all positions reachable without disassembly."""
