"""Many cases instead of one history: distributions compared, outcomes counted and scored, fragility fitted.

Pure functions of numbers and outcomes; `harness.comparison.scores` compares the histories of one case.
"""
