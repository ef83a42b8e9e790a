"""The march on a graphics card: one thread follows one mechanism."""
