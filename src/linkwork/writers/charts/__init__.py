"""Charts as plain data computed from results, and their Matplotlib writer."""
