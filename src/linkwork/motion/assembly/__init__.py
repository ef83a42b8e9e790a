"""Every way to put a mechanism together at one input."""
