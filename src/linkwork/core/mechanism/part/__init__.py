"""Parts of a mechanism: one module for each, with its fields, keys, checks and figures."""
