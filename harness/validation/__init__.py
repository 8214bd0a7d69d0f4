"""Models against measured tests: a table of experiments in, outcome scores out.

How a table looks, column by column, stands in `harness.validation.table.COLUMNS`; `rockcheck validate EXPERIMENTS` runs it.
"""
