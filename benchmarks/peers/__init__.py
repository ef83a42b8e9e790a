"""Linkwork beside other software: the same work, in one run, with success and accuracy."""
