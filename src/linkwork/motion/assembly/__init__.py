"""All assembly configurations of a mechanism at one input."""
