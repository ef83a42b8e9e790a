"""From tasks to mechanisms that do them: all solutions, ranked, each with its defects."""
