"""What a command asks: each question is read from a file, planned as runs, and reduced to tables and findings."""
