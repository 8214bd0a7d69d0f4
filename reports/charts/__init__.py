"""Charts that zoom and their still pictures."""
