"""Statics and inverse dynamics: efforts of the inputs, and reactions of the joints."""
