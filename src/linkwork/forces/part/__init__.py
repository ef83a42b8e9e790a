"""The reactions of parts, one module for each kind."""
