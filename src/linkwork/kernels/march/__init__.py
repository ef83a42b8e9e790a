"""One march along a path of inputs for many mechanisms: programs, loops over lanes, results."""
