"""Why there is no position, and what would help."""
