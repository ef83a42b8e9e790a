"""Solution paths of a homotopy in the lanes of compiled code."""
