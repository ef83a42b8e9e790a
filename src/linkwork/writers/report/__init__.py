"""Reports: the results of a mechanism as a document for people, in four formats."""
