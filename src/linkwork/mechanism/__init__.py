"""What is asked: a mechanism as plain immutable data, in one of three forms."""
