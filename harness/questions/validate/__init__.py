"""Models against measured tests: a table of experiments in, outcome scores out.

Its columns stand in `harness.questions.validate.scenes.COLUMNS`; `rockcheck validate EXPERIMENTS` runs it.
"""
