"""Tasks as a user writes them, in files or in Python, and what their wishes mean."""
