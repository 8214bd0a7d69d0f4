"""Runs that are wanted, each with a key: callers ask, what the store does not hold is computed, callers read the answers.

`task.py` has what is computed (`RunRequest`: a run), `runner.py` where, `store.py` what is kept, `execute.py`
all three together; `progress.py` what is said meanwhile.
"""
