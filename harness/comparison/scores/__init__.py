"""Scores of two rotation histories, one family to a file; none knows an engine."""
