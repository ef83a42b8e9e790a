"""What kind of mechanism it is: chain, type, Assur groups."""
