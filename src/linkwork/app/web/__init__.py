"""The live page for a browser alone: front end, engine, Python and NumPy in static files."""
