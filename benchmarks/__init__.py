"""Benchmarks: ratios of times in one run, with success and accuracy."""
