"""Design: from a task to mechanisms that do it."""
