"""Two answers beside each other: scores, statistics, and why they differ; no engine is known here."""
