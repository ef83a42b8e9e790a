"""Dyads and linkages that carry a body through poses."""
