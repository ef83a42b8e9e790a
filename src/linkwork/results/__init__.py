"""What came out: positions and motions as plain immutable data, with their evidence."""
