"""Designs from outside the search of a task: from the atlas, improved, or the start of a task."""
