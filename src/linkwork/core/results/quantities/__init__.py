"""Quantities that can be asked for, one module each; ``registry`` finds them by name."""
