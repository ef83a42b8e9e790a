"""Pages that show motions, films and notebook widgets."""
