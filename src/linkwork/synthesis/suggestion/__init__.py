"""Designs for a task that its search has not found: of the atlas, improved, or given."""
