"""Results: positions, motions and lists as immutable data with their evidence."""
