"""From tasks to mechanisms: all dyads and loops through precision positions, and their defects."""
