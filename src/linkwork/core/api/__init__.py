"""Mechanisms as Python objects: make, read, solve and show them."""
