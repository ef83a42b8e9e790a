"""Numerical methods that know no mechanism: Newton-Raphson, decomposition, tracking."""
