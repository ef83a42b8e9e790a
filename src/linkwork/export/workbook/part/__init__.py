"""What workbooks have of the forces of each kind of part."""
