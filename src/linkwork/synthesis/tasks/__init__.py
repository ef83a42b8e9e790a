"""Tasks as a user writes them, in files or in Python, and the numbers of their requirements."""
