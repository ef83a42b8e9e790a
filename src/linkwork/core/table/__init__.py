"""Plain-array kernels: rows of phasor terms, and the loop table built from them."""
