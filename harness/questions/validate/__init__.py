"""Models against measured tests: a table of experiments in, outcome scores out.

Its columns stand in `harness.questions.validate.table.COLUMNS`; `rockcheck validate EXPERIMENTS` runs it.
"""
