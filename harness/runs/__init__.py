"""Many tasks, each with a key: callers list them, a campaign computes what the store does not hold, callers read the store.

`task.py` has what is computed, one run apart too, `runner.py` and `dask_pool.py` where, `store.py` what is kept, `campaign.py`
all three together; `parts.py` measurements in parts, `progress.py` what is said meanwhile.
"""
