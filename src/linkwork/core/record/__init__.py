"""Arithmetic that is recorded once and printed in a language."""
