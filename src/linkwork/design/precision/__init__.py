"""All four-bars through precision points, and through points and poses."""
