"""Charts as plain data, made from results alone, and their translation by Matplotlib."""
