"""Loops of four links that hold a coupler or drive an output: their limits, places and travel."""
