"""How time grows: with rows, loops, dyads, and from a cold start."""
