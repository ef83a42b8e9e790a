"""From a description to equations, proved positions and sweeps."""
