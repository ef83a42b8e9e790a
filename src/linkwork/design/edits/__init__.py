"""The numbers of a file: where they stand, their units, changes of units."""
