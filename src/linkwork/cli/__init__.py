"""The command line: the verbs of the library, typed in a terminal."""
