"""Mechanisms in a browser: what a page shows, and the live page that edits."""
