"""A mechanism's solver as a program in another language."""
