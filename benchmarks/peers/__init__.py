"""Comparison of Linkwork with other software on the same tasks, with success and accuracy."""
