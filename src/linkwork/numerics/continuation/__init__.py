"""Continuation: branches along inputs, curves beyond dead points, change points and folds."""
