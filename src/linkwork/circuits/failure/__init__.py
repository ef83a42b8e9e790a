"""Explain failed positions and suggest remedies; loaded after a failure only."""
