"""What a run leaves behind: its description as plain values, and the folder that is its own."""
