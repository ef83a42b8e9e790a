"""The page of a task: its text, its edits, its designs."""
