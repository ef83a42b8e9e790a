"""Derivation of links and joints from loop equations."""
