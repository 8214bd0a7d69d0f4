"""A page for each kind of record, and what every page carries."""
