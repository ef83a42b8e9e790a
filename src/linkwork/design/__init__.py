"""Questions of designers about a mechanism: which dimension matters, and by how much."""
