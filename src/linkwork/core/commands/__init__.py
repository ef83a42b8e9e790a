"""The command line: one command per task, with the words of the library."""
