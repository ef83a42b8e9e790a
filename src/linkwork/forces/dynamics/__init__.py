"""Forward dynamics: the motion under given loads, by reduction to one variable."""
