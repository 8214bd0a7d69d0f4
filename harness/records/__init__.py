"""What a run leaves behind: one typed class for each kind of record, and the folder that is its own."""
