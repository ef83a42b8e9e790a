"""Results as columns and labelled sentences, for terminals and reports."""
