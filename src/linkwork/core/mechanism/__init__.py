"""Descriptions of mechanisms as plain immutable data, in one of three forms."""
